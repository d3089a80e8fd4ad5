//! Offset of a transition = time of the predicted change - time of the true change, in ms; positive: late.
//!
//! Only changes that the prediction follows have one. The paper reports absolute offsets; signed ones
//! separate late from early. The delay of a look-ahead is included if the labels are given at their
//! emission times, and not if at their reference times.

use super::event::latency::milliseconds;
use recordings::statistics::{MeanSd, median};

/// Offsets of many transitions together, in ms.
#[derive(Clone, Copy, PartialEq, Debug, serde::Serialize, serde::Deserialize)]
pub struct OffsetSummary {
    /// Number of transitions.
    pub count: usize,
    /// Mean and deviation of the signed offset.
    pub signed: MeanSd,
    /// Median of the signed offset.
    pub signed_median: f64,
    /// Mean and deviation of the absolute offset, as the paper reports it.
    pub absolute: MeanSd,
    /// Median of the absolute offset.
    pub absolute_median: f64,
}

/// Statistics of signed offsets, given in samples; none without an offset.
pub fn summary(offsets: &[i32]) -> Option<OffsetSummary> {
    let signed: Vec<f64> = offsets.iter().map(|&o| milliseconds(o)).collect();
    let absolute: Vec<f64> = signed.iter().map(|o| o.abs()).collect();
    Some(OffsetSummary {
        count: offsets.len(),
        signed: MeanSd::of(&signed)?,
        signed_median: median(&signed)?,
        absolute: MeanSd::of(&absolute)?,
        absolute_median: median(&absolute)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_are_reported_signed_and_absolute_in_milliseconds() {
        let summary = summary(&[-10, 0, 10, 20]).unwrap();
        let means = [summary.signed.mean, summary.absolute.mean];
        let medians = [summary.signed_median, summary.absolute_median];
        assert_eq!([means, medians], [[25.0, 50.0]; 2]);
        assert_eq!(super::summary(&[]), None);
    }
}
