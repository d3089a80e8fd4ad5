//! Metrics of an epoch: means over its steps, and their line in the metrics file.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::learner::WeightedMetric;

/// Weighted means by name, in the order of first appearance.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(from = "KeptMeans", into = "KeptMeans")]
pub(super) struct RunningMeans(Vec<RunningMean>);

#[derive(Clone, Debug)]
struct RunningMean {
    name: Cow<'static, str>,
    mean: f64,
    weight: f64,
}

/// [`RunningMeans`] in a file: name, and the bits of mean and weight.
type KeptMeans = Vec<(String, u64, u64)>;

impl RunningMeans {
    pub(super) fn add(&mut self, metrics: &[WeightedMetric]) {
        for metric in metrics {
            match self.0.iter_mut().find(|known| known.name == metric.name) {
                Some(known) => {
                    let weight = known.weight + metric.weight;
                    if weight > 0.0 {
                        known.mean += (metric.mean - known.mean) * metric.weight / weight;
                    }
                    known.weight = weight;
                }
                None => self.0.push(RunningMean {
                    name: metric.name.into(),
                    mean: metric.mean,
                    weight: metric.weight,
                }),
            }
        }
    }

    /// Complete means by name.
    pub(super) fn of(means: Vec<(&'static str, f64)>) -> Self {
        let mean = |(name, mean): (&'static str, f64)| RunningMean {
            name: name.into(),
            mean,
            weight: 1.0,
        };
        Self(means.into_iter().map(mean).collect())
    }

    pub(super) fn by_name(&self) -> Vec<(String, f64)> {
        self.0
            .iter()
            .map(|metric| (metric.name.clone().into_owned(), recorded(metric.mean)))
            .collect()
    }
}

impl From<RunningMeans> for KeptMeans {
    fn from(means: RunningMeans) -> Self {
        let kept = |one: RunningMean| {
            let name = one.name.into_owned();
            (name, one.mean.to_bits(), one.weight.to_bits())
        };
        means.0.into_iter().map(kept).collect()
    }
}

impl From<KeptMeans> for RunningMeans {
    fn from(kept: KeptMeans) -> Self {
        let mean = |(name, mean, weight): (String, u64, u64)| RunningMean {
            name: name.into(),
            mean: f64::from_bits(mean),
            weight: f64::from_bits(weight),
        };
        Self(kept.into_iter().map(mean).collect())
    }
}

/// Rounds a number to ten significant digits for files. A longer one may change in the last bit when it is read back from JSON,
/// and a resumed training would not write the same files.
pub(super) fn recorded(number: f64) -> f64 {
    format!("{number:.9e}").parse().unwrap_or(number)
}

impl std::fmt::Display for RunningMeans {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (position, metric) in self.0.iter().enumerate() {
            let gap = if position == 0 { "" } else { ", " };
            write!(f, "{gap}{} {:.4}", metric.name, metric.mean)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_recorded_is_read_back_exactly() {
        let read_back = |number: f64| -> f64 {
            serde_json::from_str(&serde_json::to_string(&number).unwrap()).unwrap()
        };
        // A number that is not rounded may change.
        let long = 0.181_150_673_643_538_82;
        assert_ne!(read_back(long).to_bits(), long.to_bits());
        for step in 1..20_000 {
            let number = (f64::from(step) * 0.37).sin() * 10_f64.powi(step % 9 - 6);
            let kept = recorded(number);
            assert_eq!(read_back(kept).to_bits(), kept.to_bits(), "{number}");
            assert!((kept - number).abs() <= 1e-9 * number.abs(), "{number}");
        }
    }

    #[test]
    fn means_are_weighted() {
        let metric = |name, mean, weight| WeightedMetric { name, mean, weight };
        let mut means = RunningMeans::default();
        means.add(&[metric("a", 1.0, 1.0)]);
        means.add(&[metric("a", 4.0, 2.0), metric("b", 0.0, 0.0)]);
        assert_eq!(
            means.by_name(),
            [("a".to_owned(), 3.0), ("b".to_owned(), 0.0)]
        );
    }
}
