//! Quantized keys and values of the newest patches: a ring of `span` slots per layer.

use crate::kernels::Aligned;
use crate::model::dimensions::{Dimensions, HEADS};

/// Keys and values of all layers, with room for `SLOTS` patches of width `WIDTH`.
///
/// A layer takes `span` consecutive slots, each as wide as the model: layer `l` begins with slot
/// `l span`. Codes have one scale per patch and head.
#[derive(Clone, Debug)]
pub(super) struct KvCache<const WIDTH: usize, const SLOTS: usize> {
    /// Keys, then values.
    codes: Aligned<[[[i16; WIDTH]; SLOTS]; 2]>,
    key_scales: [[f32; SLOTS]; HEADS],
    value_scales: [[f32; SLOTS]; HEADS],
    /// Slot of the next patch, the same in every layer.
    next: usize,
    /// Slots in use, at most the span.
    filled: usize,
}

impl<const WIDTH: usize, const SLOTS: usize> KvCache<WIDTH, SLOTS> {
    /// A cache without a slot in use.
    pub const EMPTY: Self = Self {
        codes: Aligned([[[0; WIDTH]; SLOTS]; 2]),
        key_scales: [[0.0; SLOTS]; HEADS],
        value_scales: [[0.0; SLOTS]; HEADS],
        next: 0,
        filled: 0,
    };

    /// Frees all slots. What they hold is not read again.
    pub const fn reset(&mut self) {
        self.next = 0;
        self.filled = 0;
    }

    /// The codes' memory, for another use while no slot is in use; `None` if it is too small.
    pub fn scratch<const N: usize>(&mut self) -> Option<&mut [f32; N]> {
        self.reset();
        let codes = self.codes.0.as_flattened_mut().as_flattened_mut();
        bytemuck::try_cast_slice_mut(codes)
            .ok()?
            .first_chunk_mut::<N>()
    }

    /// Takes a slot for the next patch: an unused one, or else the oldest patch's.
    #[inline]
    pub fn advance(&mut self, span: usize) -> Slot {
        let index = self.next;
        self.next = if index + 1 < span { index + 1 } else { 0 };
        self.filled = (self.filled + 1).min(span);
        Slot {
            index,
            filled: self.filled,
        }
    }

    /// The slots of one layer.
    #[inline]
    pub fn layer(&mut self, layer: usize, dimensions: &Dimensions) -> LayerCache<'_> {
        let Dimensions { width, span, .. } = *dimensions;
        let slots = layer * span..(layer + 1) * span;
        let codes = slots.start * width..slots.end * width;
        let [keys, values] = &mut self.codes.0;
        LayerCache {
            keys: &mut keys.as_flattened_mut()[codes.clone()],
            key_scales: self.key_scales.each_mut().map(|s| &mut s[slots.clone()]),
            values: &mut values.as_flattened_mut()[codes],
            value_scales: self.value_scales.each_mut().map(|s| &mut s[slots.clone()]),
        }
    }
}

/// The cache of one layer: `span` slots.
#[derive(Debug)]
pub(super) struct LayerCache<'c> {
    /// `[span][width]`.
    pub keys: &'c mut [i16],
    /// `[heads][span]`.
    pub key_scales: [&'c mut [f32]; HEADS],
    /// `[span][width]`.
    pub values: &'c mut [i16],
    /// `[heads][span]`.
    pub value_scales: [&'c mut [f32]; HEADS],
}

/// The slot of a patch.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct Slot {
    /// Index of the slot within the layer.
    pub index: usize,
    /// Slots in use once the patch is stored.
    pub filled: usize,
}
