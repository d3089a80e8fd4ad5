//! From rows of logits to the labels of a recording, by the device's own smoother.

use shared::intent::{Intent, MAX_CLASSES};
use shared::stream::smoother::{Settings, SettingsError, Smoother};
use shared::units::{LOOK_BACK, PATCH, SampleIndex};

use shared::model::LookBackLogits;

/// The labels of one recording, sample by sample, in two books.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Each label from the instant that it speaks of: the paper's book, in which look-ahead costs
    /// no time.
    pub reference: Vec<Option<Intent>>,
    /// Each label from the instant that it was emitted: what a user of the device sees.
    pub emitted: Vec<Option<Intent>>,
}

/// Smooths the rows of a recording's patches.
///
/// A label holds until the next one; samples before the first label and, in the first book, after
/// the last instant reference of have none.
///
/// # Errors
/// When the settings do not fit the rows.
pub fn track(
    rows: &[LookBackLogits],
    samples: usize,
    classes: usize,
    settings: Settings,
) -> Result<Track, SettingsError> {
    let mut smoother = Smoother::<MAX_CLASSES, LOOK_BACK>::new(settings, classes)?;
    let mut reference = vec![None; samples];
    let mut emitted = vec![None; samples];
    let mut held_until = 0;
    for (patch, rows) in rows.iter().enumerate() {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "a recording is shorter than 248 days"
        )]
        let window_end = SampleIndex((patch * PATCH + PATCH - 1) as u32);
        if let Some(decision) = smoother.push(window_end, rows) {
            let label = Intent::from_class(decision.class);
            let instant = decision.instant.0 as usize;
            held_until = (instant + settings.hold * PATCH).min(samples);
            reference[instant.min(samples)..].fill(label);
            emitted[(decision.window_end.0 as usize).min(samples)..].fill(label);
        }
    }
    reference[held_until..].fill(None);
    Ok(Track { reference, emitted })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(class: usize) -> LookBackLogits {
        let mut rows = LookBackLogits::default();
        for row in &mut rows {
            row[class] = 1.0;
        }
        rows
    }

    #[test]
    fn look_ahead_moves_the_emitted_book_and_not_the_reference_one() {
        let patches: Vec<LookBackLogits> = (0..40)
            .map(|patch| rows(usize::from(patch >= 20) * 2))
            .collect();
        let track = track(&patches, 400, 3, Settings::PAPER_IN_PATCHES).unwrap();
        let first =
            |book: &[Option<Intent>]| book.iter().position(|&label| label == Some(Intent::Close));
        let (reference, emitted) = (
            first(&track.reference).unwrap(),
            first(&track.emitted).unwrap(),
        );
        assert_eq!(emitted - reference, 50);
        assert_eq!(track.emitted.last(), Some(&Some(Intent::Close)));
        assert_eq!(track.reference.last(), Some(&None));
    }

    #[test]
    fn a_recording_shorter_than_the_look_ahead_has_no_label() {
        let track = track(&[rows(1); 3], 30, 3, Settings::PAPER_IN_PATCHES).unwrap();
        assert!(
            track
                .reference
                .iter()
                .chain(&track.emitted)
                .all(Option::is_none)
        );
    }
}
