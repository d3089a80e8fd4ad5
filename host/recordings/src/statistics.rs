//! Statistics of small samples: mean and deviation, median, interval of a mean.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Minimum number of people for an interval or a difference: if all of five people have one sign, a sign test still
/// gives p = 0.06, and a bootstrap over so few is far too narrow.
pub const FEWEST: usize = 6;

/// Mean and sample standard deviation.
#[derive(Clone, Copy, PartialEq, Debug, serde::Serialize, serde::Deserialize)]
pub struct MeanSd {
    /// Arithmetic mean.
    pub mean: f64,
    /// Sample standard deviation (n - 1); none for a single value.
    pub sd: Option<f64>,
    /// Number of values.
    pub n: usize,
}

impl MeanSd {
    /// Mean and deviation of the values; none without a value.
    pub fn of(values: &[f64]) -> Option<Self> {
        if values.is_empty() {
            return None;
        }
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        let sd = (values.len() > 1).then(|| (squares / (count - 1.0)).sqrt());
        Some(Self {
            mean,
            sd,
            n: values.len(),
        })
    }
}

/// Resamples of a bootstrap.
const RESAMPLES: usize = 10_000;
/// Seed of all bootstraps: an interval is a function of its values.
const SEED: u64 = 42;

/// A 95 % interval of a mean.
#[derive(Clone, Copy, PartialEq, Debug, serde::Serialize, serde::Deserialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// The interval of the mean of the values, one for each person: percentile bootstrap over persons.
    ///
    /// 10 000 times as many persons are drawn with replacement as there are; the interval reaches from the 2.5 % to
    /// the 97.5 % quantile of the means (nearest rank). None with fewer than [`FEWEST`] values. With fewer than about
    /// ten it is too narrow.
    ///
    /// Source: Efron, Tibshirani, *An Introduction to the Bootstrap*, 1993, section 13.3.
    pub fn of_mean(values: &[f64]) -> Option<Self> {
        if values.len() < FEWEST {
            return None;
        }
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        let mut means: Vec<f64> = (0..RESAMPLES)
            .map(|_| {
                let drawn = (0..values.len()).map(|_| values[rng.random_range(0..values.len())]);
                drawn.sum::<f64>() / values.len() as f64
            })
            .collect();
        means.sort_unstable_by(f64::total_cmp);
        Some(Self {
            low: means[RESAMPLES * 25 / 1000 - 1],
            high: means[RESAMPLES * 975 / 1000 - 1],
        })
    }

    /// Whether a value lies in it, its ends included.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// The median: the middle value, or the mean of the two middle ones; none without a value.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let upper = sorted.get(sorted.len() / 2)?;
    let lower = sorted[(sorted.len() - 1) / 2];
    Some(f64::midpoint(lower, *upper))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_deviation_is_that_of_a_sample() {
        let both = MeanSd::of(&[1.0, 3.0]).unwrap();
        assert_eq!((both.mean, both.sd), (2.0, Some(2.0_f64.sqrt())));
        assert_eq!(MeanSd::of(&[1.0]).unwrap().sd, None);
    }

    #[test]
    fn the_interval_is_that_of_all_resamples() {
        // Naive: every one of the 6^6 equally likely resamples.
        let values = [0.1, 0.4, 0.5, 0.9, 0.2, 0.7];
        let mut means = Vec::new();
        for draw in 0..46_656_usize {
            let places = [1, 6, 36, 216, 1296, 7776].map(|step| draw / step % 6);
            means.push(places.map(|place| values[place]).iter().sum::<f64>() / 6.0);
        }
        means.sort_unstable_by(f64::total_cmp);
        let interval = Interval::of_mean(&values).unwrap();
        // 2.5 % of 46 656 is rank 1166, 97.5 % rank 45 490; 10 000 draws err by 73 ranks, here within three times that.
        let between = |value: f64, low: usize, high: usize| {
            (means[low] - 1e-9..=means[high] + 1e-9).contains(&value)
        };
        assert!(between(interval.low, 946, 1386), "{interval:?}");
        assert!(between(interval.high, 45_270, 45_710), "{interval:?}");
        assert_eq!(Interval::of_mean(&values), Some(interval));
    }

    #[test]
    fn fewer_people_than_a_difference_needs_have_no_interval() {
        let values = [0.3, 0.6, 0.9, 0.5, 0.7, 0.8];
        assert_eq!(Interval::of_mean(&values[..5]), None);
        assert!(Interval::of_mean(&values).is_some());
    }

    #[test]
    fn the_median_of_an_even_count_is_the_mean_of_the_middle_two() {
        assert_eq!(median(&[3.0, 1.0, 2.0, 10.0]), Some(2.5));
        assert_eq!(median(&[]), None);
    }
}
