//! From ten samples to the residual stream.

use super::{
    Patch,
    linear::{self, Mapped, Quantized, as_is},
    token::Token,
};
use crate::model::file::{Companding, LinearWeights};

/// The code of an input of 1.
pub const ONE: i16 = 1 << 14;
/// Codes of a cleaned sample 0..=128; value = code / 16384.
type Table = [i16; 129];

/// `x * 128`: x / 128, exactly.
pub const LINEAR: Table = {
    let mut table = [0; 129];
    let mut x = 0;
    while x <= 128 {
        table[x] = x as i16 * 128;
        x += 1;
    }
    table
};

/// `round(sqrt(x / 128) * 16384)`, that is the rounded square root of `x 2^21`.
pub const SQUARE_ROOT: Table = {
    let mut table = [0; 129];
    let mut x = 0;
    while x <= 128 {
        let square = (x as u32) << 21;
        let root = square.isqrt();
        // Above the middle between two integers: square > (root + 1/2)^2.
        table[x] = (root + (square > root * root + root) as u32) as i16;
        x += 1;
    }
    table
};

impl Companding {
    /// The table of input codes.
    #[must_use]
    pub const fn table(self) -> &'static [i16; 129] {
        const { assert!(LINEAR[128] == ONE && SQUARE_ROOT[128] == ONE) };
        match self {
            Self::Linear => &LINEAR,
            Self::SquareRoot => &SQUARE_ROOT,
        }
    }
}

/// `h = W_e x + b_e`; the 80 inputs sample by sample, the oldest first, channel 1 first.
///
/// A value above 128, which no cleaned sample has, counts as 128.
#[inline]
pub fn embed<const T: usize, const D: usize>(
    map: &LinearWeights<'_>,
    companding: Companding,
    patches: [&Patch; T],
    tokens: &mut [Token<D>; T],
) {
    let table = companding.table();
    let code = |value: u8| table[usize::from(value.min(128))];
    for (token, patch) in tokens.iter_mut().zip(patches) {
        token.samples.0 = patch.map(|sample| sample.map(code));
    }
    let tokens = tokens.each_mut().map(|token| Mapped {
        token: Quantized {
            codes: token.samples.0.as_flattened(),
            scale: const { 1.0 / ONE as f32 },
        },
        outputs: &mut token.h,
    });
    linear::map(map, tokens, as_is);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_hold_their_rounded_functions() {
        for x in 0..=128_u8 {
            let share = f64::from(x) / 128.0;
            let expected = [share * 16384.0, libm::round(libm::sqrt(share) * 16384.0)];
            let found = [Companding::Linear, Companding::SquareRoot]
                .map(|companding| f64::from(companding.table()[usize::from(x)]));
            assert_eq!(found, expected, "x = {x}");
        }
    }
}
