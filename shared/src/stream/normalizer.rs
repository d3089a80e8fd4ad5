//! Normalization to the wearer while the stream continues: the level of rest of each electrode is subtracted, and the strength
//! of contractions scaled to a common one.
//!
//! People differ in how strong their signals are, and electrodes in how much they pick up at rest, by more than one gesture
//! differs from another. Both are followed from the stream itself, so nobody has to calibrate anything:
//!
//! * the *rest* of an electrode is the lowest level that it has had of late. It follows a fall within a second and rises with
//!   a time constant of 100 s, of 400 s during a contraction, so that an object can be held for minutes;
//! * the *strength* is the level above rest, mean over the electrodes, of contractions alone: it does not fall during rest.
//!
//! A level is the mean of |x| over 0.2 s. A sample is normalized with what was known before its 0.2 s began. Electrodes are
//! treated alike, so rotating the armband rotates the result. Integers alone: the same on every target.

mod packed;

use self::packed::{Magnitudes, Size, Sums};
use crate::units::{CHANNELS, CleanSample, Sample, sample_of, words};

/// Samples of which a level is the mean: 0.2 s.
const BLOCK: u8 = 40;
/// Fraction bits of levels.
const FRACTION: u32 = 16;
/// A count of the armband in fixed point.
const COUNT: u32 = 1 << FRACTION;
/// Rest before the first level, which becomes the rest whatever it is.
const UNKNOWN: u32 = u32::MAX;
/// Strength before the first contraction, and that to which all are scaled: near the median of the recorded people.
const COMMON_STRENGTH: u32 = 12 * COUNT;
/// Weakest strength that is scaled as such. More amplification would be of noise.
const MIN_STRENGTH: u32 = 3 * COUNT;
/// A contraction is a level above rest of more than the strength divided by this.
const CONTRACTION: u32 = 4;
/// Weight of a level below the rest: 1/4. This and those below as powers of two.
const REST_FALLS: u32 = 2;
/// Weight of a level above the rest, outside contractions: 1/512, a time constant of 102 s.
const REST_RISES: u32 = 9;
/// Weight of a level above the rest, in contractions: 1/2048, 410 s.
const REST_RISES_CONTRACTED: u32 = 11;
/// Weight of a contraction above the strength: 1/16, 3.2 s.
const STRENGTH_RISES: u32 = 4;
/// Weight of a contraction below it: 1/512.
const STRENGTH_FALLS: u32 = 9;
/// Fraction bits of a rest as it is subtracted.
const SAMPLE_FRACTION: u32 = 8;
/// Fraction bits of a factor.
const SCALE_FRACTION: u32 = 12;
/// Fraction bits of their product.
const PRODUCT_FRACTION: u32 = SAMPLE_FRACTION + SCALE_FRACTION;
/// Half a count as such a product.
const HALF: i32 = 1 << (PRODUCT_FRACTION - 1);

/// |x| of each electrode.
#[inline]
pub(super) fn rectified(sample: Sample) -> CleanSample {
    let [[a, b, c, d], [e, f, g, h]] = words(sample).map(|word| Magnitudes::of(word).bytes());
    [a, b, c, d, e, f, g, h]
}

/// Levels of a wearer, and the normalization by them.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Normalizer {
    /// Sums of |x| over the block so far, of the first four electrodes and the last four.
    sums: [Sums; 2],
    /// Samples of the block so far.
    count: u8,
    /// Rest of each electrode.
    rest: [u32; CHANNELS],
    /// Strength of contractions.
    strength: u32,
    /// Factor of |x|.
    factor: i32,
    /// Offset that is added, for rounding and for the rest of each electrode.
    offsets: [i32; CHANNELS],
}

impl Default for Normalizer {
    /// A normalizer that knows nothing about the wearer.
    fn default() -> Self {
        Self {
            sums: [Sums::ZERO; 2],
            count: 0,
            rest: [UNKNOWN; CHANNELS],
            strength: COMMON_STRENGTH,
            factor: 1 << PRODUCT_FRACTION,
            offsets: [HALF; CHANNELS],
        }
    }
}

impl Normalizer {
    /// Level at rest, mean over the electrodes, in 1/65536 of a count; more than any level before the first 0.2 s are over.
    #[must_use]
    pub fn rest(&self) -> u32 {
        self.rest.iter().map(|rest| rest / CHANNELS as u32).sum()
    }

    /// Takes a sample; returns it normalized, as long and with the signs that it had.
    pub fn push(&mut self, sample: Sample) -> Sample {
        let [first, last] = words(sample).map(Magnitudes::of);
        self.sums[0].add(first);
        self.sums[1].add(last);
        let normalized = |electrode: usize, size: u8| {
            let scaled = i32::from(size) * self.factor + self.offsets[electrode];
            Size::nearest(scaled >> PRODUCT_FRACTION)
        };
        let first = first.with_sizes(normalized);
        let last = last.with_sizes(|electrode, size| normalized(4 + electrode, size));
        self.count += 1;
        if self.count == BLOCK {
            self.end_block();
        }
        sample_of([first, last])
    }

    /// Takes the level of the block. Apart from what every sample takes, whose registers it would use up.
    #[cold]
    #[inline(never)]
    fn end_block(&mut self) {
        let sums = self.sums.map(Sums::of_each);
        let levels = core::array::from_fn(|electrode| {
            (sums.as_flattened()[electrode] << FRACTION) / u32::from(BLOCK)
        });
        for (rest, level) in self.rest.iter_mut().zip(levels) {
            if *rest == UNKNOWN {
                *rest = level;
            }
        }
        let contracted = self.above_rest(&levels) > self.strength / CONTRACTION;
        for (rest, level) in self.rest.iter_mut().zip(levels) {
            if level < *rest {
                *rest -= (*rest - level) >> REST_FALLS;
            } else {
                let rises = if contracted {
                    REST_RISES_CONTRACTED
                } else {
                    REST_RISES
                };
                *rest += (level - *rest) >> rises;
            }
        }
        if contracted {
            let above = self.above_rest(&levels);
            if above > self.strength {
                self.strength += (above - self.strength) >> STRENGTH_RISES;
            } else {
                self.strength -= (self.strength - above) >> STRENGTH_FALLS;
            }
        }
        let strength = self.strength.max(MIN_STRENGTH) >> 4;
        let scale = ((COMMON_STRENGTH << (SCALE_FRACTION - 4)) / strength) as i32;
        self.factor = scale << SAMPLE_FRACTION;
        self.offsets = self.rest.map(|rest| {
            let rest = (rest >> (FRACTION - SAMPLE_FRACTION)) as i32;
            HALF - rest * scale
        });
        self.sums = [Sums::ZERO; 2];
        self.count = 0;
    }

    /// Levels above rest, mean over the electrodes.
    fn above_rest(&self, levels: &[u32; CHANNELS]) -> u32 {
        let above = levels
            .iter()
            .zip(&self.rest)
            .map(|(level, rest)| level.saturating_sub(*rest));
        above.sum::<u32>() / CHANNELS as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    const SECOND: usize = 200;

    /// EMG of this mean |x| on all electrodes: signs and sizes alternate.
    fn emg(level: i32, samples: usize) -> impl Iterator<Item = Sample> {
        (0..samples).map(move |t| {
            let size = if t % 4 < 2 {
                level / 2
            } else {
                level + level / 2
            };
            let signed = if t % 2 == 0 { size } else { -size };
            [signed.clamp(-128, 127) as i8; CHANNELS]
        })
    }

    /// Mean |x| of the last second. Keeps no more than that: a device has no room for hours.
    fn level(normalizer: &mut Normalizer, samples: impl Iterator<Item = Sample>) -> f64 {
        let mut last = [0_u8; SECOND];
        for (t, sample) in samples.enumerate() {
            last[t % SECOND] = normalizer.push(sample)[0].unsigned_abs();
        }
        let sum: u32 = last.into_iter().map(u32::from).sum();
        f64::from(sum) / SECOND as f64
    }

    /// Ten minutes of rest and contractions in turn.
    fn use_it(normalizer: &mut Normalizer, rest: i32, contraction: i32) {
        for _ in 0..300 {
            level(normalizer, emg(rest, SECOND));
            level(normalizer, emg(contraction, SECOND));
        }
    }

    #[test]
    fn strong_and_weak_wearers_look_alike() {
        let used = |rest, contraction| {
            let mut normalizer = Normalizer::default();
            use_it(&mut normalizer, rest, contraction);
            let at_rest = level(&mut normalizer.clone(), emg(rest, SECOND));
            (at_rest, level(&mut normalizer, emg(contraction, SECOND)))
        };
        for (rest, contraction) in [(2, 8), (2, 20), (4, 60)] {
            let (at_rest, contracted) = used(rest, contraction);
            assert!(
                (9.0..14.0).contains(&contracted),
                "{contraction}: {contracted}"
            );
            assert!(at_rest < 1.5, "{contraction}: {at_rest} at rest");
        }
    }

    #[test]
    fn a_hold_of_two_minutes_keeps_most_of_its_level() {
        let mut normalizer = Normalizer::default();
        use_it(&mut normalizer, 2, 20);
        let before = level(&mut normalizer, emg(20, SECOND));
        let after = level(&mut normalizer, emg(20, 120 * SECOND));
        assert!(after > 0.7 * before, "{before}, later {after}");
    }

    #[test]
    fn an_hour_of_rest_amplifies_nothing() {
        let mut normalizer = Normalizer::default();
        use_it(&mut normalizer, 2, 20);
        let before = level(&mut normalizer.clone(), emg(20, SECOND));
        level(&mut normalizer, emg(2, 3600 * SECOND));
        let after = level(&mut normalizer, emg(20, SECOND));
        assert!((after - before).abs() < 1.0, "{before}, later {after}");
    }

    #[test]
    fn a_stream_that_begins_in_a_contraction_finds_the_rest_once_it_is_seen() {
        let mut normalizer = Normalizer::default();
        // The weaker half of the signal is gone.
        assert!(level(&mut normalizer, emg(20, 3 * SECOND)) < 6.0);
        level(&mut normalizer, emg(2, 2 * SECOND));
        assert!(level(&mut normalizer, emg(20, SECOND)) > 8.0);
    }

    fn samples() -> impl Strategy<Value = Vec<Sample>> {
        // Runs of equal samples reach every state, among them the loudest and the quietest.
        let run = (any::<Sample>(), 1..200_usize);
        prop::collection::vec(run, 1..20).prop_map(|runs| {
            runs.into_iter()
                .flat_map(|(sample, times)| core::iter::repeat_n(sample, times))
                .collect()
        })
    }

    proptest! {
        #[test]
        fn rotating_the_armband_rotates_the_result(samples in samples(), turn in 0..CHANNELS) {
            let (mut one, mut other) = (Normalizer::default(), Normalizer::default());
            for sample in samples {
                let mut turned = sample;
                turned.rotate_right(turn);
                let mut expected = one.push(sample);
                expected.rotate_right(turn);
                prop_assert_eq!(other.push(turned), expected);
            }
        }

        #[test]
        fn a_sample_keeps_its_signs_whatever_comes(samples in samples()) {
            let mut normalizer = Normalizer::default();
            for sample in samples {
                for (from, to) in sample.into_iter().zip(normalizer.push(sample)) {
                    prop_assert!(to == 0 || (from < 0) == (to < 0));
                    prop_assert!(to != i8::MIN);
                }
            }
        }
    }
}
