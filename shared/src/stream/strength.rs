//! Strength of the wearer's contraction, for a hand that is driven in proportion: 0 to 100 % of their own range for the label.
//!
//! ```text
//! |x|, mean of 8 electrodes and 10 samples -> EMA over 0.2 s -> above rest -> over the range -> a curve -> percent
//! ```
//!
//! *Rest* is the [normalizer's](super::normalizer). A *range* is the strongest level of the label so far: it rises towards a
//! stronger one within 2 s, and forgets in 7 minutes of the label, at the hold of the shipped models. At first it is that of
//! most people. The curve is that of muscle against force: half of the force takes a quarter to a third of the level.
//!
//! Integers alone: the same on every target. What it was chosen from: docs/decisions.md; r against a measured force:
//! docs/results.md.

use core::num::NonZeroU8;

use super::normalizer::rectified;
use crate::intent::{Intent, MAX_CLASSES};
use crate::units::{CHANNELS, PATCH, Sample};

/// Fraction bits of levels.
const FRACTION: u32 = 16;
/// A count of the armband in fixed point.
const COUNT: u32 = 1 << FRACTION;
/// Weight of ten samples in the level: 1/4, a time constant of 0.2 s. This and those below as powers of two.
const SMOOTHING: u32 = 2;
/// Range before the first label.
const COMMON_RANGE: u32 = 24 * COUNT;
/// Smallest range. A smaller one would be of noise.
const MIN_RANGE: u32 = 3 * COUNT;
/// Weight of a label above the range: 1/16.
const RANGE_RISES: u32 = 4;
/// Weight of a label below it: 1/4096.
const RANGE_FALLS: u32 = 12;
/// Bend of the curve: a share q of the range is `(1 + BEND) q / (q + BEND)` of the strength.
const BEND: u32 = 2;
/// Strength of the whole range, percent.
const FULL: u8 = 100;

/// Strength in percent, 0 to 100. An optional one takes a byte: reports are queued.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Percent(NonZeroU8);

impl Percent {
    /// No strength.
    pub const ZERO: Self = Self(NonZeroU8::MIN);

    /// A strength of so many percent; none above 100.
    #[must_use]
    pub const fn new(percent: u8) -> Option<Self> {
        if percent <= FULL {
            Some(Self(NonZeroU8::MIN.saturating_add(percent)))
        } else {
            None
        }
    }

    /// The percent.
    #[must_use]
    pub const fn get(self) -> u8 {
        self.0.get() - 1
    }
}

/// Level of the muscles, and ranges of a wearer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Strength {
    /// Sum of |x| over the samples so far, of ten: at most 80 * 128.
    sum: u32,
    count: u8,
    /// Level, in [`COUNT`]s.
    level: u32,
    /// Range of each intent but relax.
    ranges: [u32; MAX_CLASSES - 1],
}

impl Default for Strength {
    /// Strength of a wearer about whom nothing is known.
    fn default() -> Self {
        Self {
            sum: 0,
            count: 0,
            level: 0,
            ranges: [COMMON_RANGE; MAX_CLASSES - 1],
        }
    }
}

impl Strength {
    /// Takes a sample as the armband sent it.
    pub fn push(&mut self, sample: Sample) {
        self.sum += rectified(sample).into_iter().map(u32::from).sum::<u32>();
        self.count += 1;
        if usize::from(self.count) == PATCH {
            // At most 128 << 16.
            let level = (self.sum << FRACTION) / (PATCH * CHANNELS) as u32;
            self.level = self.level - (self.level >> SMOOTHING) + (level >> SMOOTHING);
            self.sum = 0;
            self.count = 0;
        }
    }

    /// Takes a label that is due into its range. `rest` is the level at rest, in 1/65536 of a count.
    pub fn learn(&mut self, label: Intent, rest: u32) {
        let level = self.level.saturating_sub(rest);
        if let Some(range) = self.ranges.get_mut(label.class().wrapping_sub(1)) {
            if level > *range {
                *range += (level - *range) >> RANGE_RISES;
            } else {
                *range = MIN_RANGE.max(*range - ((*range - level) >> RANGE_FALLS));
            }
        }
    }

    /// Strength in the label's range; 0 for relax.
    #[must_use]
    pub fn of(&self, label: Intent, rest: u32) -> Percent {
        let Some(&range) = self.ranges.get(label.class().wrapping_sub(1)) else {
            return Percent::ZERO;
        };
        let level = self.level.saturating_sub(rest).min(range);
        // At most 300 * 128 << 16, and a half of 3 * 128 << 16.
        let (part, whole) = (level * (u32::from(FULL) * (1 + BEND)), level + BEND * range);
        Percent::new(((part + whole / 2) / whole) as u8).unwrap_or(Percent::ZERO)
    }
}

const _: () = assert!(302 * (128_u64 << FRACTION) < 1 << 32);

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    const REST: u32 = 2 * COUNT;

    /// Strengths of a label every 0.1 s, at a mean |x| of so many counts.
    fn last(strength: &mut Strength, label: Intent, level: i8, seconds: usize) -> u8 {
        let mut last = 0;
        for sample in 0..seconds * 200 {
            let sign = if sample % 2 == 0 { 1 } else { -1 };
            strength.push([sign * level; CHANNELS]);
            if sample % 20 == 19 {
                strength.learn(label, REST);
                last = strength.of(label, REST).get();
            }
        }
        last
    }

    #[test]
    fn the_curve_is_that_of_the_documentation() {
        // Of a range of 24 counts above a rest of 2.
        for (level, percent) in [(2, 0), (8, 33), (14, 60), (20, 82), (26, 100), (50, 100)] {
            assert_eq!(
                last(&mut Strength::default(), Intent::Close, level, 2),
                percent
            );
        }
    }

    #[test]
    fn relax_has_none() {
        let mut strength = Strength::default();
        assert_eq!(last(&mut strength, Intent::Relax, 100, 1), 0);
        assert_eq!(strength.ranges, Strength::default().ranges);
    }

    #[test]
    fn nine_tenths_of_a_step_are_seen_after_400_ms() {
        let mut strength = Strength::default();
        last(&mut strength, Intent::Close, 2, 2);
        let level = |strength: &Strength| (strength.level - REST) / COUNT;
        for _ in 0..80 {
            strength.push([22; CHANNELS]);
        }
        assert_eq!(level(&strength), 17);
        for _ in 0..10 {
            strength.push([22; CHANNELS]);
        }
        assert_eq!(level(&strength), 18);
    }

    #[test]
    fn a_stronger_label_is_the_whole_range_and_the_others_keep_theirs() {
        let mut strength = Strength::default();
        last(&mut strength, Intent::Close, 50, 20);
        // Half of it.
        assert_eq!(last(&mut strength, Intent::Close, 26, 2), 60);
        assert_eq!(last(&mut strength, Intent::Open, 26, 2), 100);
    }

    #[test]
    fn a_weak_wearer_has_the_whole_range_after_minutes_of_the_label() {
        let mut strength = Strength::default();
        assert_eq!(last(&mut strength, Intent::Open, 8, 2), 33);
        // An hour of rest forgets nothing.
        let before = strength.ranges;
        last(&mut strength, Intent::Relax, 2, 3600);
        assert_eq!(strength.ranges, before);
        assert!(last(&mut strength, Intent::Open, 8, 420) > 50);
        assert!(last(&mut strength, Intent::Open, 8, 3600) > 98);
    }

    #[test]
    fn noise_is_not_amplified() {
        let mut strength = Strength::default();
        last(&mut strength, Intent::Open, 2, 7200);
        assert!(strength.ranges.iter().all(|&range| range >= MIN_RANGE));
    }

    proptest! {
        #[test]
        fn it_is_a_percentage_whatever_comes_and_rises_with_the_level(
            samples: Vec<Sample>, label in prop::sample::select(&Intent::ALL[..]), rest: u32, louder in 0..=127_i8,
        ) {
            let mut strength = Strength::default();
            for sample in samples {
                strength.push(sample);
                strength.learn(label, rest);
                let next = strength.of(label, rest).get();
                prop_assert!(next <= FULL && (next == 0 || label != Intent::Relax));
            }
            let mut before = 0;
            for level in [louder / 2, louder] {
                let mut still = strength;
                for _ in 0..1000 {
                    still.push([level; CHANNELS]);
                }
                let now = still.of(label, rest).get();
                prop_assert!(now >= before);
                before = now;
            }
        }
    }
}
