//! From scratch over the window, two patches at once and a part of a step at a time.
//!
//! For a state that is lost while the samples are not. Two patches share the reading of every matrix; a
//! [`slice`](Rebuild::slice) is one half of one layer for both, so that whatever else the core has to do waits for some
//! milliseconds at most. Patches that complete in the meantime are taken as well.

use super::{
    Encoder, EncoderState, Logits, Patch, attention::Place, feed_forward, patch_embedding,
    token::Token,
};
use crate::stream::ring::SampleRing;
use crate::units::WINDOW_PATCHES;

/// Patches that are taken at once.
pub const TILE: usize = 2;

/// A run over the window that is under way.
///
/// The state is in use until it is done: a step in between would disturb both.
#[derive(Clone, Debug)]
pub struct Rebuild<const D: usize> {
    tokens: [Token<D>; TILE],
    places: [Place; TILE],
    /// What comes next for them: the embedding, the halves of the layers by turns, the head.
    part: usize,
    /// Whole patches in the ring, up to the newest, that have not begun.
    behind: usize,
}

impl<const D: usize> Rebuild<D> {
    /// Begins anew with the oldest patch of the ring; what the state held is forgotten.
    #[must_use]
    pub fn begin<const L: usize, const SPAN: usize>(
        state: &mut EncoderState<D, L, SPAN>,
        ring: &SampleRing,
    ) -> Self {
        state.reset();
        Self {
            tokens: [const { Token::EMPTY }; TILE],
            places: [Place::default(); TILE],
            part: 0,
            behind: ring.patches().count(),
        }
    }

    /// The ring has completed another patch.
    ///
    /// One that is dropped by the ring before its turn is left out.
    pub fn patch_completed(&mut self) {
        self.behind = (self.behind + 1).min(WINDOW_PATCHES);
    }

    /// Whether fewer than two patches are left to begin, and none is under way: what [`Rebuild::left`] tells is for
    /// [`Encoder::step`].
    #[must_use]
    pub const fn is_done(&self) -> bool {
        self.part == 0 && self.behind < TILE
    }

    /// The ring's newest patches that have not begun.
    pub fn left<'r>(&self, ring: &'r SampleRing) -> impl Iterator<Item = &'r Patch> + use<'r, D> {
        let whole = ring.patches().count();
        ring.patches().skip(whole.saturating_sub(self.behind))
    }

    /// Does the next part, if it is not [done](Rebuild::is_done). With the last part of two patches it gives their
    /// outputs, the older one's first.
    #[must_use]
    pub fn slice<const L: usize, const SPAN: usize>(
        &mut self,
        encoder: &Encoder<'_, D, L, SPAN>,
        state: &mut EncoderState<D, L, SPAN>,
        ring: &SampleRing,
    ) -> Option<[Logits; TILE]> {
        let tokens = &mut self.tokens;
        let part = self.part;
        let Some(half) = part.checked_sub(1) else {
            // One of those that are waited for may be just about to be overwritten.
            self.behind = self.behind.min(ring.patches().count());
            let mut patches = self.left(ring);
            let two = [patches.next()?, patches.next()?];
            patch_embedding::embed(&encoder.embed, encoder.companding, two, &mut self.tokens);
            self.places = core::array::from_fn(|_| state.remembered.place());
            self.behind -= TILE;
            self.part = 1;
            return None;
        };
        let Some(layer) = encoder.layers.get(half / 2) else {
            self.part = 0;
            return Some(encoder.scores(tokens));
        };
        if half.is_multiple_of(2) {
            state.remembered.layers[half / 2].attend(layer, self.places, tokens);
        } else {
            feed_forward::feed_forward(layer, tokens);
        }
        self.part = part + 1;
        None
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;

    use super::*;
    use crate::intent::Vocabulary;
    use crate::model::file::{
        Dimensions, Model,
        samples::{Noise, random_model},
    };
    use crate::units::{CHANNELS, PATCH};

    fn file() -> Vec<u8> {
        let dimensions = Dimensions {
            width: 16,
            layers: 2,
            span: 27,
            vocabulary: Vocabulary::Three,
        };
        random_model(dimensions, 3).to_bytes().unwrap()
    }

    /// A patch into the ring; the same patch back.
    fn push(ring: &mut SampleRing, noise: &mut Noise) -> Patch {
        let mut patch = Patch::default();
        for sample in &mut patch {
            *sample = [0; CHANNELS].map(|_| (noise.bits() % 129) as u8);
            ring.push(*sample);
        }
        patch
    }

    /// Streams `before` patches, then rebuilds another state while a patch completes every `slices` slices: the outputs of
    /// both, newest last, and how many slices it took.
    fn streamed_and_rebuilt(before: usize, slices: usize) -> (Vec<Logits>, Vec<Logits>, usize) {
        let bytes = file();
        let encoder = Encoder::<16, 2, 27>::new(&Model::parse(&bytes).unwrap()).unwrap();
        let [mut streaming, mut state] = [encoder.fresh(), encoder.fresh()];
        let (mut ring, mut noise) = (SampleRing::new(), Noise(5));
        let mut streamed = Vec::new();
        for _ in 0..before {
            let patch = push(&mut ring, &mut noise);
            streamed.push(encoder.step(&mut streaming, &patch));
        }
        let mut rebuild = Rebuild::begin(&mut state, &ring);
        let mut rebuilt = Vec::new();
        let mut done = 0;
        while !rebuild.is_done() {
            rebuilt.extend(
                rebuild
                    .slice(&encoder, &mut state, &ring)
                    .into_iter()
                    .flatten(),
            );
            done += 1;
            if done % slices == 0 {
                let patch = push(&mut ring, &mut noise);
                streamed.push(encoder.step(&mut streaming, &patch));
                rebuild.patch_completed();
            }
        }
        assert_eq!(rebuild.slice(&encoder, &mut state, &ring), None);
        let left: Vec<Patch> = rebuild.left(&ring).copied().collect();
        assert!(left.len() < TILE);
        rebuilt.extend(left.iter().map(|patch| encoder.step(&mut state, patch)));
        for _ in 0..5 {
            let patch = push(&mut ring, &mut noise);
            streamed.push(encoder.step(&mut streaming, &patch));
            rebuilt.push(encoder.step(&mut state, &patch));
        }
        (streamed, rebuilt, done)
    }

    /// Outputs that depend on nothing before the window.
    const WHOLE: usize = 5 + WINDOW_PATCHES - (super::super::receptive_field(2, 27) - 1);

    #[test]
    fn a_rebuilt_state_is_the_streamed_one_whatever_completes_meanwhile() {
        // A tile takes six slices: nothing completes, hardly ever, as on a board, nearly as fast as it is taken.
        for slices in [usize::MAX, 97, 40, 5] {
            for before in [60, 61, 75] {
                let (streamed, rebuilt, done) = streamed_and_rebuilt(before, slices);
                let newest = |outputs: &[Logits]| outputs[outputs.len() - WHOLE..].to_vec();
                assert_eq!(newest(&streamed), newest(&rebuilt), "{before}, {slices}");
                assert!(done >= 6 * WINDOW_PATCHES / TILE);
            }
        }
    }

    #[test]
    fn a_ring_that_is_not_full_is_rebuilt_from_its_first_patch() {
        for before in [0, 1, 2, 7] {
            let (streamed, rebuilt, _) = streamed_and_rebuilt(before, usize::MAX);
            assert_eq!(streamed, rebuilt);
        }
    }

    #[test]
    fn patches_that_the_ring_has_dropped_are_left_out() {
        let bytes = file();
        let encoder = Encoder::<16, 2, 27>::new(&Model::parse(&bytes).unwrap()).unwrap();
        let (mut ring, mut noise) = (SampleRing::new(), Noise(5));
        let mut state = encoder.fresh();
        let mut rebuild = Rebuild::begin(&mut state, &ring);
        for _ in 0..3 * WINDOW_PATCHES {
            push(&mut ring, &mut noise);
            rebuild.patch_completed();
        }
        assert_eq!(rebuild.left(&ring).count(), WINDOW_PATCHES);
        assert_eq!(ring.contiguous() as usize, 3 * WINDOW_PATCHES * PATCH);
    }
}
