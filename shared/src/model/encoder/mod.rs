//! The student as it runs on the device: one patch in, the logits of the six newest patches out.
//!
//! A pre-norm transformer with causal local attention. [`Encoder`] borrows the weights and never
//! changes; [`EncoderState`] holds a ring of quantized keys and values per layer (the KV cache). One
//! step computes one token. A patch's output depends on `L (span - 1) + 1` patches at most, and the
//! six newest outputs on no more than the window holds: a fresh state run over the newest 60
//! patches therefore gives the same six outputs, bit for bit.
//!
//! Per step, h being the residual stream in f32:
//!
//! 1. `patch_embedding`: `h = W_e x + b_e`, x the 80 companded inputs;
//! 2. each layer: `attention`, `h += W_o attend(norm1(h)) + b_o`, then `feed_forward`,
//!    `h += W_2 gelu(W_1 norm2(h) + b_1) + b_2`;
//! 3. `look_back_head`: `W_h norm(h) + b_h`, six rows of classes, the newest patch first.
//!
//! Dimensions are those of the model file, known at run time; the state's arrays have a fixed
//! capacity. What that costs against an encoder compiled for one shape: docs/decisions.md.

mod attention;
mod cache;
mod feed_forward;
mod linear;
mod look_back_head;
mod patch_embedding;
mod token;

use super::{Encode, LookBackLogits};
use crate::arithmetic::inverse_square_root;
use crate::calibration::{KeptHead, Refusal, Sums, solve_from};
use crate::model::dimensions::{Companding, Dimensions, HEADS, MAX_SLOTS, MAX_WIDTH};
use crate::model::file::{LinearWeights, Model, ModelError, Weights};
use crate::model::head::Head;
use crate::units::Patch;
use attention::Attention;
use cache::KvCache;
use feed_forward::feed_forward;
use token::Token;

/// A part of a step, for counting what each costs; norms and residual sums included.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum EncoderPart {
    /// The patch embedding.
    Embed,
    /// The attention of one layer.
    Attention,
    /// The feed-forward of one layer.
    FeedForward,
    /// The look-back head.
    Head,
}

/// Mark between the parts of a step, for counting what each part costs.
pub trait Probe {
    /// `part` has ended.
    fn done(&mut self, part: EncoderPart);
}

/// Counts nothing, and compiles to nothing.
impl Probe for () {
    #[inline(always)]
    fn done(&mut self, _: EncoderPart) {}
}

/// Widest model that a device runs.
const DEVICE_WIDTH: usize = 64;
/// Most cache slots of a model that a device runs: two layers of 27, or three of 18.
const DEVICE_SLOTS: usize = 54;

/// The encoder of a device: models up to width 64 with up to 54 cache slots (layers x span).
pub type DeviceEncoder<'m> = Encoder<'m, DEVICE_WIDTH, DEVICE_SLOTS>;
/// The state of [`DeviceEncoder`].
pub type DeviceState = EncoderState<DEVICE_WIDTH, DEVICE_SLOTS>;
/// An encoder with room for every model that [`Model::parse`] accepts.
pub type HostEncoder<'m> = Encoder<'m, MAX_WIDTH, MAX_SLOTS>;

// The nRF52832 has 64 KiB of RAM.
const _: () = assert!(size_of::<DeviceState>() < 20 * 1024);

/// The student, with the dimensions of its model. `WIDTH` and `SLOTS` are the capacity of its state.
#[derive(Clone, Copy, Debug)]
pub struct Encoder<'m, const WIDTH: usize, const SLOTS: usize> {
    weights: Weights<'m>,
    /// The model's own look-back head, whichever is used.
    own_head: LinearWeights<'m>,
    dimensions: Dimensions,
    companding: Companding,
    /// See [`Attention::score_scale`].
    score_scale: f32,
}

/// The KV cache of one stream, and scratch memory for the patch being computed.
#[derive(Clone, Debug)]
pub struct EncoderState<const WIDTH: usize, const SLOTS: usize> {
    cache: KvCache<WIDTH, SLOTS>,
    token: [Token<WIDTH>; 1],
}

impl<const WIDTH: usize, const SLOTS: usize> EncoderState<WIDTH, SLOTS> {
    /// A state before the first patch.
    #[must_use]
    pub const fn fresh() -> Self {
        Self {
            cache: KvCache::EMPTY,
            token: [Token::EMPTY],
        }
    }

    /// Makes the state fresh in place.
    pub const fn reset(&mut self) {
        self.cache.reset();
    }
}

impl<'m, const WIDTH: usize, const SLOTS: usize> Encoder<'m, WIDTH, SLOTS> {
    /// The encoder of a model.
    ///
    /// # Errors
    ///
    /// [`ModelError::TooLarge`] if the state has no room for a model of this width, or of this many
    /// layers and span.
    pub fn new(model: &Model<'m>) -> Result<Self, ModelError> {
        let dimensions = model.header.dimensions;
        let slots = dimensions.layers * dimensions.span;
        if dimensions.width > WIDTH || slots > SLOTS {
            return Err(ModelError::TooLarge {
                width: dimensions.width,
                most_width: WIDTH,
                slots,
                most_slots: SLOTS,
            });
        }
        Ok(Self {
            weights: model.weights,
            own_head: model.weights.head,
            dimensions,
            companding: model.header.companding,
            score_scale: inverse_square_root((dimensions.width / HEADS) as f32),
        })
    }

    /// The encoder with another look-back head; as it was if the head is one for other dimensions.
    #[must_use]
    pub fn with_head(mut self, head: &'m Head) -> Self {
        if head.fits(&self.dimensions) {
            self.weights.head = head.linear();
        }
        self
    }

    /// Uses the head of a record for its model, in place: a device's stack has no room for a second encoder.
    pub const fn set_head(&mut self, head: KeptHead<'m>) {
        self.weights.head = head.weights;
    }

    /// Number of classes, 3, 5 or 6.
    #[must_use]
    pub const fn classes(&self) -> usize {
        self.dimensions.vocabulary.classes()
    }

    /// A state for a new stream.
    #[must_use]
    pub const fn fresh(&self) -> EncoderState<WIDTH, SLOTS> {
        EncoderState::fresh()
    }

    /// Takes the next patch and gives the logits of the six newest.
    ///
    /// Rows that refer to patches before the state was fresh have no meaning. From the model's number
    /// of classes on every row holds 0.
    #[must_use]
    pub fn step(&self, state: &mut EncoderState<WIDTH, SLOTS>, patch: &Patch) -> LookBackLogits {
        self.step_probed(state, patch, &mut ())
    }

    /// Like [`Encoder::step`], but calls the probe at the end of every part.
    #[must_use]
    pub fn step_probed(
        &self,
        state: &mut EncoderState<WIDTH, SLOTS>,
        patch: &Patch,
        probe: &mut impl Probe,
    ) -> LookBackLogits {
        let EncoderState { cache, token } = state;
        let [logits] = self.tile(cache, token, [patch], probe);
        logits
    }

    /// Input of the look-back head at the patch of the last [`Encoder::step`]: the normalised residual stream, `[width]`.
    #[must_use]
    pub fn hidden<'s>(&self, state: &'s EncoderState<WIDTH, SLOTS>) -> &'s [f32] {
        &state.token[0].normalised[..self.dimensions.width]
    }

    /// Takes `T` consecutive patches, the oldest first, as `T` steps would.
    #[inline]
    fn tile<const T: usize>(
        &self,
        cache: &mut KvCache<WIDTH, SLOTS>,
        tokens: &mut [Token<WIDTH>; T],
        patches: [&Patch; T],
        probe: &mut impl Probe,
    ) -> [LookBackLogits; T] {
        let Dimensions {
            width,
            layers,
            span,
            ..
        } = self.dimensions;
        let slots = core::array::from_fn(|_| cache.advance(span));
        patch_embedding::embed(&self.weights.embed, self.companding, width, patches, tokens);
        probe.done(EncoderPart::Embed);
        for (number, layer) in self.weights.layers[..layers].iter().enumerate() {
            let mut attention = Attention {
                weights: layer,
                cache: cache.layer(number, &self.dimensions),
                dimensions: &self.dimensions,
                score_scale: self.score_scale,
            };
            attention.apply(slots, tokens);
            probe.done(EncoderPart::Attention);
            feed_forward(layer, width, tokens);
            probe.done(EncoderPart::FeedForward);
        }
        let logits = self.logits(tokens);
        probe.done(EncoderPart::Head);
        logits
    }

    #[inline]
    fn logits<const T: usize>(&self, tokens: &mut [Token<WIDTH>; T]) -> [LookBackLogits; T] {
        let (norm, head) = (&self.weights.final_norm, &self.weights.head);
        look_back_head::logits(norm, head, &self.dimensions, tokens)
    }
}

/// Patches that [`Encode::steps`] computes at once, on machines with the stack for it: enough that
/// unpacking the weights hardly counts.
const TILE: usize = 4;

impl<const WIDTH: usize, const SLOTS: usize> Encode for Encoder<'_, WIDTH, SLOTS> {
    type State = EncoderState<WIDTH, SLOTS>;

    fn classes(&self) -> usize {
        self.classes()
    }

    fn fresh(&self) -> Self::State {
        self.fresh()
    }

    fn reset(&self, state: &mut Self::State) {
        state.reset();
    }

    fn step(&self, state: &mut Self::State, patch: &Patch) -> LookBackLogits {
        self.step(state, patch)
    }

    fn hidden<'s>(&self, state: &'s Self::State) -> &'s [f32] {
        self.hidden(state)
    }

    fn logits_by(&self, head: &Head, state: &mut Self::State) -> LookBackLogits {
        let [logits] = self.with_head(head).logits(&mut state.token);
        logits
    }

    fn solve(&self, sums: &Sums, state: &mut Self::State, head: &mut Head) -> Result<(), Refusal> {
        let scratch = state.cache.scratch().ok_or(Refusal::WrongModel)?;
        solve_from(sums, &self.dimensions, &self.own_head, scratch, head)
    }

    fn steps(
        &self,
        state: &mut Self::State,
        patches: &[Patch],
        mut output: impl FnMut(LookBackLogits),
    ) {
        let mut tokens = [const { Token::EMPTY }; TILE];
        let (tiles, rest) = patches.as_chunks::<TILE>();
        for tile in tiles {
            let logits = self.tile(&mut state.cache, &mut tokens, tile.each_ref(), &mut ());
            logits.into_iter().for_each(&mut output);
        }
        for patch in rest {
            output(self.step(state, patch));
        }
    }
}

#[cfg(test)]
mod tests;
