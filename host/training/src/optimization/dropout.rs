//! Dropout whose masks are computed from a seed and a position and never stored.
//!
//! Burn's own dropout draws from one generator per device, so two threads that train in parallel would
//! not repeat their draws. Here each use draws one seed from the caller's generator; whether a value is
//! dropped is a hash of seed, row and column, so any part of a mask can be computed again, in any
//! order.

use burn::tensor::{DType, Device, Int, Tensor, TensorData};
use rand::Rng as _;
use rand_chacha::ChaCha8Rng;

/// Source of dropout masks: a generator in training, none in inference.
pub struct Dropout(Option<ChaCha8Rng>);

impl From<ChaCha8Rng> for Dropout {
    fn from(rng: ChaCha8Rng) -> Self {
        Self(Some(rng))
    }
}

impl Dropout {
    /// No dropout, for inference.
    pub const fn off() -> Self {
        Self(None)
    }

    /// The next mask, which drops values with this probability; none if nothing is dropped.
    pub(crate) fn mask(&mut self, probability: f64) -> Option<Mask> {
        let rng = self.0.as_mut().filter(|_| probability > 0.0)?;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a probability times 2^32"
        )]
        Some(Mask {
            seed: rng.next_u64(),
            below: (probability * f64::from(u32::MAX)) as u32,
            first: 0,
            scale: (1.0 / (1.0 - probability)) as f32,
        })
    }

    /// Sets values to 0 with this probability and scales the others, so that the expected value stays.
    pub fn drop<const D: usize>(&mut self, x: Tensor<D>, probability: f64) -> Tensor<D> {
        match self.mask(probability) {
            Some(mask) => mask.apply(x),
            None => x,
        }
    }
}

/// Factor of the column number in the hash.
const COLUMN: u32 = 0x9e37_79b9;
/// Factors of the hash.
const FACTORS: [u32; 2] = [0x7feb_352d, 0x846c_a68b];

/// Whether the tensors of a device are in the program's own memory.
fn is_cpu(device: &Device) -> bool {
    #[cfg(feature = "flex")]
    if *device == Device::flex() {
        return true;
    }
    #[cfg(feature = "ndarray")]
    #[expect(deprecated, reason = "selectable on purpose, see docs/decisions.md")]
    if *device == Device::ndarray() {
        return true;
    }
    let _ = device;
    false
}

/// Dropout mask of a tensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mask {
    seed: u64,
    below: u32,
    /// First row of the tensor within the whole mask.
    first: usize,
    /// Factor of the values that are kept, 1 / (1 - probability).
    pub scale: f32,
}

impl Mask {
    /// The mask of the part of a tensor that begins with this row.
    pub(crate) fn starting_at(self, first: usize) -> Self {
        let first = self.first + first;
        Self { first, ..self }
    }

    /// The mask of one row along the last axis; rows are counted over all leading axes.
    pub(crate) fn row(&self, row: usize) -> RowMask {
        let row = self.first + row;
        // The finalizer of SplitMix64: neighbouring rows get unrelated keys.
        let mut key = self.seed ^ (row as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        key = (key ^ (key >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        key = (key ^ (key >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        RowMask {
            key: (key >> 32) as u32,
            below: self.below,
        }
    }

    /// Sets dropped values of a tensor to 0 and scales the others.
    pub(crate) fn apply<const D: usize>(&self, x: Tensor<D>) -> Tensor<D> {
        let (dims, device) = (x.dims(), x.device());
        if is_cpu(&device) {
            return x * Tensor::from_data(TensorData::new(self.factors(dims), dims), &device);
        }
        x * self.hashed(dims, &device)
    }

    /// [`factors`](Self::factors), computed on the device: a mask of attention weights is gigabytes, the keys of its rows
    /// are not.
    fn hashed<const D: usize>(&self, dims: [usize; D], device: &Device) -> Tensor<D> {
        let columns = dims[D - 1];
        let rows = dims[..D - 1].iter().product();
        let unsigned = |values: Vec<u32>, dims: [usize; 2]| {
            let values = TensorData::new(values, dims);
            Tensor::<2, Int>::from_data(values, (device, DType::U32)).expand([rows, columns])
        };
        let keys = unsigned((0..rows).map(|row| self.row(row).key).collect(), [rows, 1]);
        let places = (0..columns as u32).map(|column| column.wrapping_mul(COLUMN));
        let places = unsigned(places.collect(), [1, columns]);
        let shifted = |x: &Tensor<2, Int>, bits: u32| x.clone().bitwise_right_shift_scalar(bits);
        // The same hash as `RowMask::keeps`; products of unsigned numbers wrap on a GPU.
        let mut hash = keys.bitwise_xor(places);
        for (bits, factor) in [(16, FACTORS[0]), (15, FACTORS[1])] {
            let mixed = shifted(&hash, bits);
            hash = hash.bitwise_xor(mixed).mul_scalar(factor);
        }
        let mixed = shifted(&hash, 16);
        let kept = hash.bitwise_xor(mixed).greater_equal_elem(self.below);
        (kept.float() * self.scale).reshape(dims)
    }

    /// The factor of every value of a tensor: 0 or the scale.
    pub(crate) fn factors<const D: usize>(&self, dims: [usize; D]) -> Vec<f32> {
        let columns = dims[D - 1].max(1);
        let mut factors = vec![self.scale; dims.iter().product()];
        for (at, row) in factors.chunks_mut(columns).enumerate() {
            self.row(at).zero(row);
        }
        factors
    }
}

/// Dropout mask of a row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowMask {
    key: u32,
    below: u32,
}

impl RowMask {
    /// Whether the value of a column is kept.
    #[inline(always)]
    pub(crate) fn keeps(self, column: u32) -> bool {
        // Only multiplications and shifts, so that the compiler vectorizes a loop over columns.
        let mut hash = self.key ^ column.wrapping_mul(COLUMN);
        hash = (hash ^ (hash >> 16)).wrapping_mul(FACTORS[0]);
        hash = (hash ^ (hash >> 15)).wrapping_mul(FACTORS[1]);
        hash ^ (hash >> 16) >= self.below
    }

    /// Sets dropped values to 0.
    #[inline(always)]
    pub(crate) fn zero(self, row: &mut [f32]) {
        for (column, value) in (0_u32..).zip(row) {
            *value = if self.keeps(column) { *value } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    fn dropout(seed: u64) -> Dropout {
        Dropout::from(ChaCha8Rng::seed_from_u64(seed))
    }

    #[test]
    fn the_mean_is_kept_and_a_seed_repeats_its_mask() {
        let x = Tensor::<2>::ones([100, 200], &Device::default());
        let drop = |seed| crate::optimization::read_back(dropout(seed).drop(x.clone(), 0.15));
        let once = drop(1);
        assert_eq!(once, drop(1));
        assert_ne!(once, drop(2));
        let mean = once.iter().sum::<f32>() / 20_000.0;
        // Four standard errors of a mean of 20 000: 0.012.
        assert!((mean - 1.0).abs() < 0.012, "{mean}");
        assert!(once.contains(&0.0));
    }

    #[test]
    fn rows_columns_and_uses_are_dropped_independently() {
        let mut dropout = dropout(3);
        let (first, second) = (dropout.mask(0.5).unwrap(), dropout.mask(0.5).unwrap());
        let dims = [500, 400];
        let kept = |mask: Mask| mask.factors(dims).into_iter().map(|f| f > 0.0);
        let (a, b): (Vec<_>, Vec<_>) = (kept(first).collect(), kept(second).collect());
        let agreement = |pairs: &mut dyn Iterator<Item = (bool, bool)>| {
            let (mut equal, mut all) = (0_u32, 0_u32);
            for (x, y) in pairs {
                equal += u32::from(x == y);
                all += 1;
            }
            f64::from(equal) / f64::from(all)
        };
        let pairs = |distance: usize| a.iter().copied().zip(a[distance..].iter().copied());
        let next_use = &mut a.iter().copied().zip(b.iter().copied());
        for (what, share) in [
            ("the next column", agreement(&mut pairs(1))),
            ("the next row", agreement(&mut pairs(dims[1]))),
            ("two rows on", agreement(&mut pairs(2 * dims[1]))),
            ("the next use", agreement(next_use)),
        ] {
            // Five standard errors of a share of 200 000 coins: 0.0056.
            assert!((share - 0.5).abs() < 0.0056, "{what}: {share}");
        }
    }

    #[test]
    fn a_row_of_a_mask_is_the_same_alone_as_in_the_whole() {
        let mask = dropout(4).mask(0.3).unwrap();
        let whole = mask.factors([2, 3, 17]);
        for (at, expected) in whole.chunks(17).enumerate() {
            let mut row = [mask.scale; 17];
            mask.row(at).zero(&mut row);
            assert_eq!(row, expected);
        }
        let later = mask.starting_at(1).starting_at(1);
        assert_eq!(later.factors([4, 17]), whole[2 * 17..]);
    }

    #[test]
    fn without_dropout_nothing_changes() {
        let x = Tensor::<1>::ones([8], &Device::default());
        let dropped = Dropout::off().drop(x, 0.9);
        assert_eq!(crate::optimization::read_back(dropped), [1.0; 8]);
    }
}
