//! Latency = first sample with the emitted label of a gesture - onset of the gesture, in ms.
//!
//! The label is what a user gets, so the look-ahead is included. A gesture that is not recognised counts as
//! infinitely late: with n gestures, the q-quantile is the ceil(q n)-th smallest latency (nearest rank), which is
//! *missed* where it falls on a gesture that is not recognised. Nothing is left out, so a model cannot look
//! fast by missing the gestures that it would be slow at.

use shared::units::SAMPLE_PERIOD_MS;

/// A quantile of the latencies.
#[derive(Clone, Copy, PartialEq, Debug, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Latency {
    /// Latency in milliseconds.
    Ms(f64),
    /// The quantile falls on a gesture that is not recognised.
    Missed,
}

/// Latencies of many gestures together.
#[derive(Clone, Copy, PartialEq, Debug, serde::Serialize, serde::Deserialize)]
pub struct LatencySummary {
    /// Median.
    pub median: Latency,
    /// 90th percentile.
    pub p90: Latency,
}

/// Median and 90th percentile over `gestures` gestures. The recognised ones have a latency in samples. `None`
/// without a gesture.
pub fn summary(latencies: &[i32], gestures: usize) -> Option<LatencySummary> {
    let mut sorted = latencies.to_vec();
    sorted.sort_unstable();
    let quantile = |percent: usize| {
        let rank = (percent * gestures).div_ceil(100);
        sorted.get(rank - 1).map_or(Latency::Missed, |&samples| {
            Latency::Ms(milliseconds(samples))
        })
    };
    (gestures > 0).then(|| LatencySummary {
        median: quantile(50),
        p90: quantile(90),
    })
}

pub(crate) fn milliseconds(samples: i32) -> f64 {
    f64::from(samples) * f64::from(SAMPLE_PERIOD_MS)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn misses_are_later_than_every_latency() {
        let nine = [50, 10, 20, 30, 40, 60, 70, 80, 90];
        let all = summary(&nine, 9).unwrap();
        assert_eq!(all.median, Latency::Ms(250.0));
        assert_eq!(all.p90, Latency::Ms(450.0));
        let one_missed = summary(&nine, 10).unwrap();
        assert_eq!(one_missed.p90, Latency::Ms(450.0));
        let two_missed = summary(&nine, 11).unwrap();
        assert_eq!(two_missed.p90, Latency::Missed);
        assert_eq!(summary(&[4], 3).unwrap().median, Latency::Missed);
        assert_eq!(summary(&[], 0), None);
    }

    proptest! {
        #[test]
        fn a_quantile_is_the_least_latency_that_so_many_gestures_have_at_most(
            latencies in prop::collection::vec(-50..400_i32, 0..30),
            missed in 0..30_usize,
        ) {
            let gestures = latencies.len() + missed;
            let naive = |share: f64| {
                let mut candidates = latencies.clone();
                candidates.sort_unstable();
                let enough = |&latency: &i32| {
                    let so_far = latencies.iter().filter(|&&own| own <= latency).count();
                    so_far as f64 >= share * gestures as f64 - 1e-9
                };
                let found = candidates.into_iter().find(enough);
                found.map_or(Latency::Missed, |samples| Latency::Ms(5.0 * f64::from(samples)))
            };
            match summary(&latencies, gestures) {
                None => prop_assert_eq!(gestures, 0),
                Some(found) => {
                    prop_assert_eq!(found.median, naive(0.5));
                    prop_assert_eq!(found.p90, naive(0.9));
                }
            }
        }
    }
}
