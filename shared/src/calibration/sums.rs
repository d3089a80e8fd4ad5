//! Sums over the hidden vectors that a wearer shows.

use crate::intent::{Intent, MAX_CLASSES, MAX_LOGITS};
use crate::model::head::MAX_HEAD_WIDTH;

/// Most columns: the hidden vector and the 1 behind it.
pub(super) const COLUMNS: usize = MAX_HEAD_WIDTH + 1;
/// Entries of a symmetric matrix up to the diagonal.
pub(super) const TRIANGLE: usize = COLUMNS * (COLUMNS + 1) / 2;

/// Class that a patch shows.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Shown {
    /// An intent of the model.
    Intent(Intent),
    /// Movement outside the vocabulary.
    Other,
}

impl Shown {
    /// Index among the sums by class.
    pub(super) const fn index(self) -> usize {
        match self {
            Self::Intent(intent) => intent.class(),
            Self::Other => MAX_CLASSES,
        }
    }
}

/// Sums over the hidden vectors of all patches shown so far, over rounds and days. Size: 10 KB.
#[derive(Clone, PartialEq, Debug)]
pub struct Sums {
    /// Columns of the hidden vectors, the 1 behind them included; 0 before the first.
    pub(super) columns: usize,
    /// Sums of the products of any two columns: row by row, each up to the diagonal.
    pub(super) products: [f32; TRIANGLE],
    /// Sums of the columns for each class, then for other movement.
    pub(super) of_class: [[f32; COLUMNS]; MAX_LOGITS],
    /// Patches of each class, then of other movement.
    pub(super) patches: [u32; MAX_LOGITS],
}

impl Sums {
    /// Sums of no patches.
    pub const EMPTY: Self = Self {
        columns: 0,
        products: [0.0; TRIANGLE],
        of_class: [[0.0; COLUMNS]; MAX_LOGITS],
        patches: [0; MAX_LOGITS],
    };

    /// Forgets all patches, in place: a device's stack has no room for a second one.
    pub fn clear(&mut self) {
        let Self {
            columns,
            products,
            of_class,
            patches,
        } = self;
        *columns = 0;
        products.fill(0.0);
        of_class.as_flattened_mut().fill(0.0);
        patches.fill(0);
    }

    /// Adds the [hidden vector](crate::model::encoder::Encoder::hidden) of a patch, `[width]`. A vector longer than
    /// [`MAX_HEAD_WIDTH`], or of another length than those before, is left out.
    pub fn add(&mut self, hidden: &[f32], shown: Shown) {
        let columns = hidden.len() + 1;
        if self.columns == 0 && columns <= COLUMNS {
            self.columns = columns;
        }
        if self.columns != columns {
            return;
        }
        let mut x = [1.0; COLUMNS];
        x[..hidden.len()].copy_from_slice(hidden);
        let x = &x[..columns];
        add_products(&mut self.products, x, 1.0);
        let own = &mut self.of_class[shown.index()];
        for (sum, value) in own.iter_mut().zip(x) {
            *sum += value;
        }
        let patches = &mut self.patches[shown.index()];
        *patches = patches.saturating_add(1);
    }

    /// Number of patches that showed a class so far.
    #[must_use]
    pub const fn patches(&self, shown: Shown) -> u32 {
        self.patches[shown.index()]
    }
}

/// Adds the products of any two numbers of a vector, times a factor, to a triangle: row by row, each up to the diagonal.
pub(super) fn add_products(triangle: &mut [f32; TRIANGLE], x: &[f32], factor: f32) {
    let mut rest = &mut triangle[..];
    for (row, &own) in x.iter().enumerate() {
        let (products, after) = rest.split_at_mut(row + 1);
        let own = factor * own;
        for (product, other) in products.iter_mut().zip(x) {
            *product += own * other;
        }
        rest = after;
    }
}
