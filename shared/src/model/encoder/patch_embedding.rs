//! Patch embedding: the residual stream from ten samples.

use super::{
    linear::{self, Mapped, PER_WEIGHT, Quantized},
    token::Token,
};
use crate::model::dimensions::Companding;
use crate::model::file::LinearWeights;
use crate::units::{CHANNELS, PATCH, Patch};

/// The code of an input of 1: the largest with which no sum of 80 products leaves 32 bits, whatever the weights.
const ONE: i16 = 1 << 9;
const _: () = assert!(PATCH as i64 * CHANNELS as i64 * 32_768 * ONE as i64 <= i32::MAX as i64);
/// Codes of a preprocessed sample, 0..=128: input = code / 512.
type Table = [i16; 129];

/// `x * 4`: x / 128, exactly.
const LINEAR: Table = {
    let mut table = [0; 129];
    let mut x = 0;
    while x <= 128 {
        table[x] = x as i16 * (ONE / 128);
        x += 1;
    }
    table
};

/// `round(sqrt(x / 128) * 512)`, that is the rounded square root of `x 2^11`.
const SQUARE_ROOT: Table = {
    let mut table = [0; 129];
    let mut x = 0;
    while x <= 128 {
        let square = (x as u32) << 11;
        let root = square.isqrt();
        // Round up above the middle of two integers: square > (root + 1/2)^2.
        table[x] = (root + (square > root * root + root) as u32) as i16;
        x += 1;
    }
    table
};

const fn table(companding: Companding) -> &'static Table {
    const { assert!(LINEAR[128] == ONE && SQUARE_ROOT[128] == ONE) };
    match companding {
        Companding::Linear => &LINEAR,
        Companding::SquareRoot => &SQUARE_ROOT,
    }
}

/// `h = W_e x + b_e`; the 80 inputs sample by sample, the oldest first, channel 1 first.
///
/// A value above 128, which no preprocessed sample has, counts as 128.
#[inline]
pub(super) fn embed<const T: usize, const WIDTH: usize>(
    map: &LinearWeights<'_>,
    companding: Companding,
    width: usize,
    patches: [&Patch; T],
    tokens: &mut [Token<WIDTH>; T],
) {
    let table = table(companding);
    let code = |value: u8| table[usize::from(value.min(128))];
    for (token, patch) in tokens.iter_mut().zip(patches) {
        token.samples.0 = patch.map(|sample| sample.map(code));
    }
    let tokens = tokens.each_mut().map(|token| Mapped {
        token: Quantized {
            codes: token.samples.0.as_flattened(),
            scale: const { PER_WEIGHT / ONE as f32 },
        },
        outputs: &mut token.residual[..width],
    });
    linear::map(map, tokens);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_hold_their_rounded_functions() {
        for x in 0..=128_u8 {
            let share = f64::from(x) / 128.0;
            let expected = [share * 512.0, libm::round(libm::sqrt(share) * 512.0)];
            let found = [Companding::Linear, Companding::SquareRoot]
                .map(|companding| f64::from(table(companding)[usize::from(x)]));
            assert_eq!(found, expected, "x = {x}");
        }
    }
}
