//! Profile of a gesture: the logarithm of each electrode's activity.

use super::placement::Alignment;
use crate::units::CHANNELS;

/// Units of an octave, a factor of two.
pub const OCTAVE: i16 = 256;

/// Units of a count in a mean.
pub const COUNT: u32 = 64;

/// The logarithm of each electrode's mean activity, less the mean of the eight.
///
/// In 1/256 octaves: `256 log2(1 + m)` where `m` is the mean of |x| in counts, 0 to 128; within -1793..=1794. The 1 keeps
/// electrodes without activity from deciding.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Profile(pub(super) [i16; CHANNELS]);

impl Profile {
    /// Profile of each electrode's mean |x|, in 1/64 counts; more than 128 counts count as 128.
    #[must_use]
    pub fn new(means: [u32; CHANNELS]) -> Self {
        let logarithms = means.map(|mean| log2(COUNT + mean.min(128 * COUNT)));
        // At most 8 x 13 x 256.
        let sum: i16 = logarithms.iter().sum();
        // The nearest, halves up.
        let mean = (sum + CHANNELS as i16 / 2).div_euclid(CHANNELS as i16);
        Self(logarithms.map(|logarithm| logarithm - mean))
    }

    /// The profile with the electrodes aligned.
    #[must_use]
    pub fn aligned(self, alignment: Alignment) -> Self {
        Self(alignment.apply(self.0))
    }

    /// The values, electrode by electrode.
    #[must_use]
    pub const fn values(self) -> [i16; CHANNELS] {
        self.0
    }
}

/// `256 log2(value)`, rounded down; 0 for 0. The binary digits of a logarithm by repeated squaring.
fn log2(value: u32) -> i16 {
    let Some(whole) = value.checked_ilog2() else {
        return 0;
    };
    // 1 to 2, in 2^-31.
    let mut mantissa = u64::from(value) << (31 - whole);
    let mut logarithm = whole as i16;
    for _ in 0..OCTAVE.ilog2() {
        mantissa = (mantissa * mantissa) >> 31;
        let digit = (mantissa >> 32) as i16;
        mantissa >>= digit;
        logarithm = 2 * logarithm + digit;
    }
    logarithm
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn logarithms_are_those_of_a_table() {
        // 256 log2(value), rounded down.
        for (value, expected) in [
            (0, 0),
            (1, 0),
            (2, 256),
            (3, 405),
            (64, 1536),
            (100, 1700),
            (8256, 3330),
        ] {
            assert_eq!(log2(value), expected, "{value}");
        }
    }

    #[test]
    fn a_profile_is_free_of_the_strength_of_a_gesture_that_is_far_above_rest() {
        let strong = [100, 200, 300, 400, 500, 600, 700, 800].map(|counts| counts * 10);
        let weak = strong.map(|mean| mean / 2);
        let [strong, weak] = [strong, weak].map(|means| Profile::new(means).values());
        for (strong, weak) in strong.into_iter().zip(weak) {
            // A tenth of an octave: the 1 is added to means of 8 to 125 counts.
            assert!(strong.abs_diff(weak) < 26, "{strong} {weak}");
        }
    }

    proptest! {
        #[test]
        fn any_means_give_a_profile_about_zero_within_its_bounds(means: [u32; CHANNELS]) {
            let values = Profile::new(means).values();
            let sum: i32 = values.iter().copied().map(i32::from).sum();
            prop_assert!(sum.abs() <= 4);
            prop_assert!(values.iter().all(|value| (-1793..=1794).contains(value)));
        }
    }
}
