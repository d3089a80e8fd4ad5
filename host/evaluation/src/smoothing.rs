//! Labels of a recording from its logits, by the device's own smoother.

use shared::intent::{Intent, MAX_LOGITS};
use shared::model::LookBackLogits;
use shared::stream::smoother::{Settings, SettingsError, Smoother};
use shared::units::{LOOK_BACK, PATCH, SampleIndex};

/// The labels of one recording, sample by sample, on two time bases.
///
/// The smoother emits the label of an instant, its reference time, only after the look-ahead.
#[derive(Clone, Debug, PartialEq)]
pub struct SmoothedLabels {
    /// Each label from its reference time on: the paper's evaluation, in which the look-ahead adds no delay.
    pub reference: Vec<Option<Intent>>,
    /// Each label from its emission time on: what a user of the device gets. The median before the model waits for
    /// one sample after the newest patch.
    pub emitted: Vec<Option<Intent>>,
}

/// Samples that the median needs after the sample that it cleans.
const MEDIAN_LAG: usize = 1;

/// Smooths the logits of a recording's patches to the labels of its samples.
///
/// A label holds until the next one. Samples before the first label have none; on the reference time base,
/// neither have samples after the last label's hold time.
pub fn smooth(
    logits: &[LookBackLogits],
    samples: usize,
    classes: usize,
    settings: Settings,
) -> Result<SmoothedLabels, SettingsError> {
    let mut smoother = Smoother::<MAX_LOGITS, LOOK_BACK>::new(settings, classes)?;
    let mut reference = vec![None; samples];
    let mut emitted = vec![None; samples];
    let mut held_until = 0;
    for (patch, logits) in logits.iter().enumerate() {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a recording is shorter than 248 days"
        )]
        let window_end = SampleIndex((patch * PATCH + PATCH - 1) as u32);
        if let Some(decision) = smoother.push(window_end, logits) {
            let label = Intent::from_class(decision.class);
            let instant = decision.instant.0 as usize;
            held_until = (instant + settings.hold * PATCH).min(samples);
            reference[instant.min(samples)..].fill(label);
            let emission = decision.window_end.0 as usize + MEDIAN_LAG;
            emitted[emission.min(samples)..].fill(label);
        }
    }
    reference[held_until..].fill(None);
    Ok(SmoothedLabels { reference, emitted })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn logits(class: usize) -> LookBackLogits {
        let mut logits = LookBackLogits::default();
        for patch in &mut logits {
            patch[class] = 1.0;
        }
        logits
    }

    #[test]
    fn the_look_ahead_delays_emitted_labels_but_not_their_reference_times() {
        const CLOSE: Option<Intent> = Some(Intent::Close);
        let patches = [vec![logits(0); 20], vec![logits(2); 20]].concat();
        let labels = smooth(&patches, 400, 3, Settings::PAPER_IN_PATCHES).unwrap();
        let [reference, emitted] = [&labels.reference, &labels.emitted]
            .map(|labels| labels.iter().position(|&label| label == CLOSE).unwrap());
        // As in the lines of `replay`.
        assert_eq!(emitted - reference, 51);
        assert_eq!(labels.emitted.last(), Some(&CLOSE));
        assert_eq!(labels.reference.last(), Some(&None));
    }

    #[test]
    fn a_recording_shorter_than_the_look_ahead_has_no_label() {
        let labels = smooth(&[logits(1); 3], 30, 3, Settings::PAPER_IN_PATCHES).unwrap();
        let mut all = labels.reference.iter().chain(&labels.emitted);
        assert!(all.all(Option::is_none));
    }
}
