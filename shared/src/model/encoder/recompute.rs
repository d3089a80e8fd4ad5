//! Full recompute of a state from the sample ring, two patches at once and a slice at a time.
//!
//! For a state that is lost while its samples are still in the ring: electrodes realigned, model
//! exchanged. Two patches share the reading of every weight. One [`slice`](Recompute::slice) is half
//! a layer for both, so that other tasks wait a few milliseconds at most. Patches that complete
//! during the recompute are included.

use super::{Encoder, EncoderState, cache::Slot, token::Token};
use crate::model::LookBackLogits;
use crate::stream::ring::SampleRing;
use crate::units::{Patch, WINDOW_PATCHES};

/// Patches computed at once.
pub const TILE: usize = 2;

/// A recompute in progress.
///
/// It owns the state until it is done: a step in between would spoil both.
#[derive(Clone, Debug)]
pub struct Recompute<const WIDTH: usize> {
    tokens: [Token<WIDTH>; TILE],
    slots: [Slot; TILE],
    /// The next part for these tokens: 0 the embedding, then two halves per layer, then the head.
    part: usize,
    /// Complete patches in the ring that have not been started, the newest ones.
    pending: usize,
}

impl<const WIDTH: usize> Recompute<WIDTH> {
    /// Starts with the oldest patch of the ring. The state is reset.
    #[must_use]
    pub fn start<const SLOTS: usize>(
        state: &mut EncoderState<WIDTH, SLOTS>,
        ring: &SampleRing,
    ) -> Self {
        state.reset();
        Self {
            tokens: [const { Token::EMPTY }; TILE],
            slots: [Slot::default(); TILE],
            part: 0,
            pending: ring.patches().count(),
        }
    }

    /// To be called when the ring has completed another patch.
    ///
    /// A patch that the ring overwrites before its turn is left out.
    pub fn patch_completed(&mut self) {
        self.pending = (self.pending + 1).min(WINDOW_PATCHES);
    }

    /// Whether no patch is in progress and fewer than two are pending. Those that
    /// [`Recompute::remaining`] gives are left for [`Encoder::step`].
    #[must_use]
    pub const fn is_done(&self) -> bool {
        self.part == 0 && self.pending < TILE
    }

    /// The pending patches, the oldest first.
    pub fn remaining<'r>(
        &self,
        ring: &'r SampleRing,
    ) -> impl Iterator<Item = &'r Patch> + use<'r, WIDTH> {
        let complete = ring.patches().count();
        ring.patches().skip(complete.saturating_sub(self.pending))
    }

    /// Computes the next part, unless [done](Recompute::is_done). The last part of two patches gives
    /// their logits, the older patch's first.
    #[must_use]
    pub fn slice<const SLOTS: usize>(
        &mut self,
        encoder: &Encoder<'_, WIDTH, SLOTS>,
        state: &mut EncoderState<WIDTH, SLOTS>,
        ring: &SampleRing,
    ) -> Option<[LookBackLogits; TILE]> {
        let part = self.part;
        let Some(half) = part.checked_sub(1) else {
            // The ring may be overwriting the oldest pending patch.
            self.pending = self.pending.min(ring.patches().count());
            let mut patches = self.remaining(ring);
            let two = [patches.next()?, patches.next()?];
            encoder.embed(two, &mut self.tokens);
            let span = encoder.dimensions.span;
            self.slots = core::array::from_fn(|_| state.cache.advance(span));
            self.pending -= TILE;
            self.part = 1;
            return None;
        };
        let layer = half / 2;
        if layer == encoder.dimensions.layers {
            self.part = 0;
            return Some(encoder.logits(&mut self.tokens));
        }
        if half.is_multiple_of(2) {
            let mut attention = encoder.attention(layer, &mut state.cache);
            attention.apply(self.slots, &mut self.tokens);
        } else {
            encoder.feed_forward(layer, &mut self.tokens);
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
    use crate::model::dimensions::{Dimensions, receptive_field};
    use crate::model::file::{Model, random::random_model};
    use crate::model::noise::Noise;
    use crate::stream::ring::Origin;
    use crate::units::{CHANNELS, PATCH};

    type SmallEncoder<'m> = Encoder<'m, 16, 54>;

    fn file() -> Vec<u8> {
        let dimensions = Dimensions {
            width: 16,
            layers: 2,
            span: 27,
            vocabulary: Vocabulary::Three,
            other: false,
        };
        random_model(dimensions, 3).to_bytes().unwrap()
    }

    /// Pushes a patch of noise into the ring and returns it.
    fn push(ring: &mut SampleRing, noise: &mut Noise) -> Patch {
        let mut patch = Patch::default();
        for sample in &mut patch {
            *sample = [0; CHANNELS].map(|_| (noise.bits() % 129) as u8);
            ring.push(*sample, Origin::Received);
        }
        patch
    }

    /// Streams `before` patches, then recomputes a second state while a patch completes every `slices`
    /// slices: the logits of both, the newest last, and the number of slices.
    fn streamed_and_recomputed(
        before: usize,
        slices: usize,
    ) -> (Vec<LookBackLogits>, Vec<LookBackLogits>, usize) {
        let bytes = file();
        let encoder = SmallEncoder::new(&Model::parse(&bytes).unwrap()).unwrap();
        let [mut streaming, mut state] = [encoder.fresh(), encoder.fresh()];
        let (mut ring, mut noise) = (SampleRing::new(), Noise(5));
        let mut streamed = Vec::new();
        for _ in 0..before {
            let patch = push(&mut ring, &mut noise);
            streamed.push(encoder.step(&mut streaming, &patch));
        }
        let mut recompute = Recompute::start(&mut state, &ring);
        let mut recomputed = Vec::new();
        let mut done = 0;
        while !recompute.is_done() {
            recomputed.extend(
                recompute
                    .slice(&encoder, &mut state, &ring)
                    .into_iter()
                    .flatten(),
            );
            done += 1;
            if done % slices == 0 {
                let patch = push(&mut ring, &mut noise);
                streamed.push(encoder.step(&mut streaming, &patch));
                recompute.patch_completed();
            }
        }
        assert_eq!(recompute.slice(&encoder, &mut state, &ring), None);
        let remaining: Vec<Patch> = recompute.remaining(&ring).copied().collect();
        assert!(remaining.len() < TILE);
        recomputed.extend(
            remaining
                .iter()
                .map(|patch| encoder.step(&mut state, patch)),
        );
        for _ in 0..5 {
            let patch = push(&mut ring, &mut noise);
            streamed.push(encoder.step(&mut streaming, &patch));
            recomputed.push(encoder.step(&mut state, &patch));
        }
        (streamed, recomputed, done)
    }

    /// Outputs that depend on nothing before the window.
    const WHOLE: usize = 5 + WINDOW_PATCHES - (receptive_field(2, 27) - 1);

    #[test]
    fn a_recomputed_state_is_the_streamed_one_whatever_completes_meanwhile() {
        // Two patches take six slices. A patch completes never, rarely, as often as on a board, and
        // nearly as fast as it is computed.
        for slices in [usize::MAX, 97, 40, 5] {
            for before in [60, 61, 75] {
                let (streamed, recomputed, done) = streamed_and_recomputed(before, slices);
                let newest = |outputs: &[LookBackLogits]| outputs[outputs.len() - WHOLE..].to_vec();
                assert_eq!(newest(&streamed), newest(&recomputed), "{before}, {slices}");
                assert!(done >= 6 * WINDOW_PATCHES / TILE);
            }
        }
    }

    #[test]
    fn a_ring_that_is_not_full_is_recomputed_from_its_first_patch() {
        for before in [0, 1, 2, 7] {
            let (streamed, recomputed, _) = streamed_and_recomputed(before, usize::MAX);
            assert_eq!(streamed, recomputed);
        }
    }

    #[test]
    fn patches_that_the_ring_has_dropped_are_left_out() {
        let bytes = file();
        let encoder = SmallEncoder::new(&Model::parse(&bytes).unwrap()).unwrap();
        let (mut ring, mut noise) = (SampleRing::new(), Noise(5));
        let mut state = encoder.fresh();
        let mut recompute = Recompute::start(&mut state, &ring);
        for _ in 0..3 * WINDOW_PATCHES {
            push(&mut ring, &mut noise);
            recompute.patch_completed();
        }
        assert_eq!(recompute.remaining(&ring).count(), WINDOW_PATCHES);
        assert_eq!(ring.contiguous() as usize, 3 * WINDOW_PATCHES * PATCH);
    }
}
