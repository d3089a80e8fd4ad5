//! A run or a model file on a page.

use std::ops::Range;

use shared::intent::{Intent, Vocabulary};
use shared::units::SAMPLE_RATE_HZ;

use super::Fact;
use super::pictures::charts::Panel;
use super::pictures::timeline::Timeline;
use super::row::{Row, over_all};
use crate::{Candidate, EvaluatedRecording, EvaluationError, LookAhead, Measure, System};

/// Samples of a recording in a picture: 20 s.
pub(super) const SHOWN: usize = 4000;

/// A run or a model file, and the data of its pictures.
pub(super) struct Entry<'a> {
    /// Name on the page.
    pub name: String,
    /// Facts about it, in the order to be shown.
    pub facts: Vec<Fact>,
    /// Rows under lag-compensated labels, one for each data set.
    pub scores: Vec<Row<'a>>,
    /// Rows of other models of the same run.
    pub beside: Vec<Row<'a>>,
    /// Rows of the floors, over the same people.
    pub floors: Vec<Row<'a>>,
    /// The recordings.
    pub recordings: &'a [EvaluatedRecording],
    /// Logits over the recordings.
    pub candidate: &'a Candidate,
    /// Classes of the model.
    pub vocabulary: Vocabulary,
    /// Look-ahead of the model.
    pub look_ahead: LookAhead,
    /// Learning curves.
    pub panels: Vec<Panel>,
}

impl<'a> Entry<'a> {
    /// Rows over all recordings: of the people who have all classes, of those with fewer.
    pub(super) fn everybody(&self) -> Vec<&Row<'a>> {
        over_all(&self.scores).collect()
    }

    pub(super) fn energy(&self) -> impl Iterator<Item = &Row<'a>> {
        over_all(&self.floors).filter(|floor| floor.model == System::Energy)
    }

    /// The busiest recordings of the `worst` people with the lowest balanced accuracy, the worst first, and of the best
    /// one; of those who have all classes, if there are any. Named after the entry where it is not the only one.
    pub(super) fn drawn(
        &self,
        worst: usize,
        named: bool,
    ) -> Result<Vec<Timeline<'_>>, EvaluationError> {
        let measure = Measure::BalancedAccuracy;
        let first = over_all(&self.scores).next();
        let mut people = first.map_or_else(Vec::new, |score| measure.values(score));
        people.sort_by(|a, b| a.1.total_cmp(&b.1));
        let best = people.iter().skip(worst).last();
        let drawn = people.iter().take(worst).chain(best);
        let mut timelines = Vec::new();
        for (at, part) in drawn.filter_map(|(subject, _)| self.busiest(subject)) {
            let second = part.start / SAMPLE_RATE_HZ as usize;
            let mut shown = self.timeline(at, part)?;
            if second > 0 {
                shown.recording += &format!(", from {second} s");
            }
            if named {
                shown.recording += &format!(" · {}", self.name);
            }
            timelines.push(shown);
        }
        Ok(timelines)
    }

    /// The 20 s of a person's recordings with the most movement.
    fn busiest(&self, subject: &str) -> Option<(usize, Range<usize>)> {
        let all = self.recordings.iter().enumerate();
        let own = all.filter(|(_, recording)| recording.subject == subject);
        own.map(|(at, recording)| (at, busiest_part(recording)))
            .max_by_key(|(at, part)| movement(&self.recordings[*at], part))
    }

    /// A part of a recording with the labels that the model emits for it.
    pub(super) fn timeline(
        &self,
        at: usize,
        part: Range<usize>,
    ) -> Result<Timeline<'_>, EvaluationError> {
        let recording = &self.recordings[at];
        let (vocabulary, look_ahead) = (self.vocabulary, self.look_ahead);
        let labels = self
            .candidate
            .labels(at, recording, vocabulary, look_ahead)?;
        Ok(Timeline {
            subject: &recording.subject,
            recording: recording.name.clone(),
            emg: within(&recording.emg, &part),
            truth: within(&recording.lag_compensated, &part),
            emitted: within(&labels.emitted, &part).to_vec(),
        })
    }
}

/// The 20 s of a recording with the most movement, the first ones on ties.
fn busiest_part(recording: &EvaluatedRecording) -> Range<usize> {
    let starts = (0..recording.emg.len().max(1)).step_by(SHOWN / 4);
    let parts = starts.map(|start| start..start + SHOWN);
    // A part that the recording's end cuts short only if there is no other.
    let whole = parts.filter(|part| part.start == 0 || part.end <= recording.emg.len());
    whole
        .rev()
        .max_by_key(|part| movement(recording, part))
        .unwrap_or(0..SHOWN)
}

/// Number of gestures that begin in a part of a recording, then of samples in gestures: holds have no beginning.
pub(super) fn movement(recording: &EvaluatedRecording, part: &Range<usize>) -> (usize, usize) {
    let is_gesture = |label: &Option<Intent>| label.is_some_and(|intent| intent != Intent::Relax);
    let begins = |pair: &&[Option<Intent>]| pair[0] != pair[1] && is_gesture(&pair[1]);
    let labels = within(&recording.lag_compensated, part);
    let moving = labels.iter().filter(|label| is_gesture(label)).count();
    (labels.windows(2).filter(begins).count(), moving)
}

/// Part of a sequence; what lies outside of it is cut off.
fn within<'s, T>(of: &'s [T], part: &Range<usize>) -> &'s [T] {
    let end = part.end.min(of.len());
    &of[part.start.min(end)..end]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_is_cut_at_the_end_of_its_sequence() {
        assert_eq!(within(&[1, 2, 3, 4, 5, 6], &(4..8)), [5, 6]);
        assert!(within(&[1, 2, 3], &(20..30)).is_empty());
    }
}
