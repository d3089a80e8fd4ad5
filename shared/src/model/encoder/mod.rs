//! The student as it runs on the device: one patch in, scores of the six newest patches out.
//!
//! A pre-norm transformer whose attention is causal and local. What never changes is
//! [`Encoder`], which borrows the weights; what time changes is [`EncoderState`], a ring of
//! quantized keys and values per layer. One step costs one token's work. Because every patch
//! depends on `L (SPAN - 1) + 1` patches at most, and those fit in the window, running the newest
//! 60 patches through a fresh state gives the newest six outputs bit for bit.
//!
//! Per step, h being the residual stream in f32:
//!
//! 1. [`patch_embedding`]: `h = W_e x + b_e`, x the 80 companded inputs;
//! 2. each layer: [`attention`], `h += W_o attend(norm1(h)) + b_o`, then [`feed_forward`],
//!    `h += W_2 gelu(W_1 norm2(h) + b_1) + b_2`;
//! 3. [`look_back_head`]: `W_h norm(h) + b_h`, six rows of classes, the newest patch first.

pub mod any_shape;
pub mod attention;
pub mod feed_forward;
pub mod linear;
pub mod look_back_head;
pub mod norm;
pub mod patch_embedding;
pub mod probe;
pub mod rebuild;
pub mod token;

use crate::model::file::{Companding, LayerWeights, LinearWeights, Model, ModelError, NormWeights};
use crate::model::kernels;
use crate::pipeline::{Encode, LookBackLogits};
use crate::units::{CHANNELS, CleanSample, LOOK_BACK, PATCH, WINDOW_PATCHES};
use attention::{Memory, Place};
use probe::{Part, Probe};
use token::Token;

/// Attention heads of every model.
pub const HEADS: usize = 4;
/// Widest residual stream: a head of 32.
pub const MAX_WIDTH: usize = 128;
/// Narrowest residual stream.
pub const MIN_WIDTH: usize = 16;
/// Most layers.
pub const MAX_LAYERS: usize = 3;
/// Longest attention span, in patches: the most terms of a product of two codes.
pub const MAX_SPAN: usize = kernels::MAX_TERMS;

// Longest rows: the patch, and the second matrix of the feed-forward.
const _: () = assert!(PATCH * CHANNELS <= kernels::MAX_COLUMNS);
const _: () = assert!(2 * MAX_WIDTH <= kernels::MAX_COLUMNS);
const _: () = assert!(MAX_WIDTH / HEADS <= kernels::MAX_TERMS);
// The state of the usual student stays small: d = 64, two layers, 27 patches.
const _: () = assert!(size_of::<EncoderState<64, 2, 27>>() < 20 * 1024);

/// Ten samples, the oldest first.
pub type Patch = [CleanSample; PATCH];

/// Scores of the six newest patches, newest first.
///
/// Row `j` speaks of patch `p - j`. Logits, not normalised. From the model's number of classes on
/// every row holds 0, which means nothing: look only at the first `classes()`.
pub type Logits = LookBackLogits;

/// Patches that one patch's output depends on, itself included: `layers (span - 1) + 1`.
#[must_use]
pub const fn receptive_field(layers: usize, span: usize) -> usize {
    layers * (span - 1) + 1
}

/// The span of a student of so many layers that is meant for a device: whatever their number, it hears 2.7 s.
#[must_use]
pub const fn usual_span(layers: usize) -> usize {
    540 / PATCH / layers
}

/// The student: width `D`, `L` layers, attention over `SPAN` patches.
#[derive(Clone, Copy, Debug)]
pub struct Encoder<'m, const D: usize, const L: usize, const SPAN: usize> {
    embed: LinearWeights<'m>,
    layers: [LayerWeights<'m>; L],
    final_norm: NormWeights<'m>,
    head: LinearWeights<'m>,
    companding: Companding,
    classes: usize,
}

/// What the encoder remembers of one stream, and the patch that is on its way.
#[derive(Clone, Debug)]
pub struct EncoderState<const D: usize, const L: usize, const SPAN: usize> {
    remembered: Remembered<D, L, SPAN>,
    token: [Token<D>; 1],
}

/// The rings of all layers.
#[derive(Clone, Debug)]
struct Remembered<const D: usize, const L: usize, const SPAN: usize> {
    layers: [Memory<D, SPAN>; L],
    /// Slot of the next patch.
    next: usize,
    /// Patches remembered, at most `SPAN`.
    filled: usize,
}

impl<const D: usize, const L: usize, const SPAN: usize> Remembered<D, L, SPAN> {
    /// The place of the next patch, which is from now on one of those before.
    #[inline]
    fn place(&mut self) -> Place {
        let slot = self.next;
        self.next = (slot + 1) % SPAN;
        self.filled = (self.filled + 1).min(SPAN);
        Place {
            slot,
            filled: self.filled,
        }
    }
}

impl<const D: usize, const L: usize, const SPAN: usize> EncoderState<D, L, SPAN> {
    /// A state that remembers nothing.
    #[must_use]
    pub const fn fresh() -> Self {
        Self {
            remembered: Remembered {
                layers: [const { Memory::EMPTY }; L],
                next: 0,
                filled: 0,
            },
            token: [Token::EMPTY],
        }
    }

    /// Forgets everything, in place: what the rings still hold is never read again.
    pub const fn reset(&mut self) {
        self.remembered.next = 0;
        self.remembered.filled = 0;
    }
}

impl<'m, const D: usize, const L: usize, const SPAN: usize> Encoder<'m, D, L, SPAN> {
    const FITS: () = {
        assert!(D >= MIN_WIDTH && D <= MAX_WIDTH && D.is_multiple_of(8));
        assert!(L > 0 && L <= MAX_LAYERS && SPAN > 0 && SPAN <= MAX_SPAN);
        assert!(receptive_field(L, SPAN) + LOOK_BACK - 1 <= WINDOW_PATCHES);
    };

    /// The encoder of a model of just this shape.
    ///
    /// # Errors
    ///
    /// [`ModelError::Shape`] if the model has another width, depth or span.
    pub fn new(model: &Model<'m>) -> Result<Self, ModelError> {
        let () = Self::FITS;
        let dimensions = &model.header.dimensions;
        let (width, layers, span) = (dimensions.width, dimensions.layers, dimensions.span);
        if (width, layers, span) != (D, L, SPAN) {
            return Err(ModelError::Shape {
                expected: (D, L, SPAN),
                width,
                layers,
                span,
            });
        }
        Ok(Self {
            embed: model.weights.embed,
            layers: core::array::from_fn(|layer| model.weights.layers[layer]),
            final_norm: model.weights.final_norm,
            head: model.weights.head,
            companding: model.header.companding,
            classes: dimensions.vocabulary.classes(),
        })
    }

    /// Number of classes, 3 or 6.
    #[must_use]
    pub const fn classes(&self) -> usize {
        self.classes
    }

    /// A state for a new stream.
    #[must_use]
    pub const fn fresh(&self) -> EncoderState<D, L, SPAN> {
        EncoderState::fresh()
    }

    /// Takes the next patch and gives the scores of the six newest.
    ///
    /// Rows that speak of patches before the state was fresh mean nothing.
    #[must_use]
    pub fn step(&self, state: &mut EncoderState<D, L, SPAN>, patch: &Patch) -> Logits {
        self.step_probed(state, patch, &mut ())
    }

    /// As [`Encoder::step`], telling a probe at the end of every part.
    #[must_use]
    pub fn step_probed(
        &self,
        state: &mut EncoderState<D, L, SPAN>,
        patch: &Patch,
        probe: &mut impl Probe,
    ) -> Logits {
        let EncoderState { remembered, token } = state;
        let [logits] = self.tile(remembered, token, [patch], probe);
        logits
    }

    /// Takes `T` patches that follow one another, the oldest first, as so many steps would.
    #[inline]
    fn tile<const T: usize>(
        &self,
        remembered: &mut Remembered<D, L, SPAN>,
        tokens: &mut [Token<D>; T],
        patches: [&Patch; T],
        probe: &mut impl Probe,
    ) -> [Logits; T] {
        let places = core::array::from_fn(|_| remembered.place());
        patch_embedding::embed(&self.embed, self.companding, patches, tokens);
        probe.done(Part::Embed);
        for (layer, memory) in self.layers.iter().zip(&mut remembered.layers) {
            memory.attend(layer, places, tokens);
            probe.done(Part::Attention);
            feed_forward::feed_forward(layer, tokens);
            probe.done(Part::FeedForward);
        }
        let logits = self.scores(tokens);
        probe.done(Part::Head);
        logits
    }

    #[inline]
    fn scores<const T: usize>(&self, tokens: &mut [Token<D>; T]) -> [Logits; T] {
        look_back_head::scores(&self.final_norm, &self.head, tokens, self.classes)
    }
}

/// Patches that [`Encode::steps`] takes at once on a machine that has the memory: enough that the matrices' unpacking
/// hardly counts.
const TILE: usize = 4;

impl<const D: usize, const L: usize, const SPAN: usize> Encode for Encoder<'_, D, L, SPAN> {
    type State = EncoderState<D, L, SPAN>;

    fn classes(&self) -> usize {
        self.classes()
    }

    fn fresh(&self) -> Self::State {
        self.fresh()
    }

    fn reset(&self, state: &mut Self::State) {
        state.reset();
    }

    fn step(&self, state: &mut Self::State, patch: &Patch) -> Logits {
        self.step(state, patch)
    }

    fn steps(&self, state: &mut Self::State, patches: &[Patch], mut output: impl FnMut(Logits)) {
        let mut tokens = [const { Token::EMPTY }; TILE];
        let (tiles, rest) = patches.as_chunks::<TILE>();
        for tile in tiles {
            let logits = self.tile(&mut state.remembered, &mut tokens, tile.each_ref(), &mut ());
            logits.into_iter().for_each(&mut output);
        }
        for patch in rest {
            output(self.step(state, patch));
        }
    }
}

#[cfg(test)]
mod tests;
