//! The picture of a recording: EMG above, true and emitted labels below.

mod axis;
mod layers;

use std::ops::Range;

use shared::intent::Intent;
use shared::units::{CleanSample, SAMPLE_RATE_HZ};

use self::axis::{Axis, EMITTED, HEIGHT, TRUTH, WIDTH};
use super::{ReportError, canvas};
use recordings::runs;

/// One recording with its labels; the three sequences run sample by sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Timeline {
    /// The person.
    pub subject: String,
    /// Name of the recording.
    pub recording: String,
    /// EMG after median and rectification, 0..=128.
    pub emg: Vec<CleanSample>,
    /// The true label of each sample; none where it is unknown.
    pub truth: Vec<Option<Intent>>,
    /// The label emitted *for* each sample, `look_ahead_samples` after it.
    pub emitted: Vec<Option<Intent>>,
    /// Samples from the reference time of a label to its emission.
    pub look_ahead_samples: usize,
}

impl Timeline {
    /// A part of the recording; what lies outside of it is cut off.
    #[must_use]
    pub(crate) fn section(&self, samples: Range<usize>) -> Self {
        fn part<T: Copy>(of: &[T], samples: &Range<usize>) -> Vec<T> {
            let end = samples.end.min(of.len());
            of[samples.start.min(end)..end].to_vec()
        }
        Self {
            emg: part(&self.emg, &samples),
            truth: part(&self.truth, &samples),
            emitted: part(&self.emitted, &samples),
            ..self.clone()
        }
    }
}

/// The picture as an SVG file of its own, for a README.
///
/// # Errors
/// [`ReportError::Draw`] on a bug of the layout only.
pub(crate) fn timeline_svg(timeline: &Timeline) -> Result<String, ReportError> {
    svg(timeline).map(|svg| canvas::stand_alone(&svg))
}

/// The picture as a part of the page.
pub(super) fn svg(timeline: &Timeline) -> Result<String, ReportError> {
    let title = format!(
        "EMG and labels: {}, {}",
        timeline.subject, timeline.recording
    );
    let axis = Axis {
        samples: timeline
            .emg
            .len()
            .max(timeline.truth.len())
            .max(timeline.emitted.len())
            .max(1),
    };
    let description = format!(
        "{:.1} s of eight channels; below them {} true and {} emitted runs of one label each.",
        axis.samples as f64 / f64::from(SAMPLE_RATE_HZ),
        runs(&timeline.truth).len(),
        runs(&timeline.emitted).len(),
    );
    canvas::draw((WIDTH, HEIGHT), &title, &description, |area| {
        layers::head(area, timeline)?;
        layers::guides(area, &axis, &timeline.truth)?;
        layers::traces(area, &axis, &timeline.emg)?;
        layers::band(area, &axis, TRUTH, "true", &timeline.truth)?;
        layers::band(area, &axis, EMITTED, "emitted", &timeline.emitted)?;
        layers::delays(area, &axis, timeline)?;
        layers::seconds(area, &axis, timeline.look_ahead_samples)
    })
}

#[cfg(test)]
mod tests {
    use shared::units::CHANNELS;

    use super::*;

    #[test]
    fn a_section_is_cut_from_all_three_sequences() {
        let timeline = Timeline {
            emg: vec![[1; CHANNELS]; 10],
            truth: vec![Some(Intent::Open); 10],
            emitted: vec![None; 6],
            ..Timeline::default()
        };
        let section = timeline.section(4..8);
        assert_eq!(
            (
                section.emg.len(),
                section.truth.len(),
                section.emitted.len()
            ),
            (4, 4, 2)
        );
        assert_eq!(timeline.section(20..30).emg, Vec::<CleanSample>::new());
    }
}
