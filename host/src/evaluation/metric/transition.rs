//! Transition accuracy = changes of the truth that the prediction follows / changes of the truth.
//!
//! A change follows if, within a buffer around it, the prediction goes from the old label A to the
//! new label B and shows nothing else, and then, up to the next buffer (the maintenance), stays B.
//!
//! Source: ReactEMG (arXiv 2506.19815) and its released evaluation, odd corners included: equal on
//! all of the reference's cases (tests/golden/transition.rs).

use std::ops::Range;

use shared::intent::Intent;

use super::{MetricError, same_length, stretches};

/// A predicted or true label; none: nothing emitted.
type Label = Option<Intent>;

/// How strictly a change is judged.
#[derive(Clone, Copy, PartialEq, Eq, Debug, serde::Serialize, serde::Deserialize)]
pub struct Rule {
    /// Width of the buffer in samples, both sides together; half of it lies on each side.
    pub buffer: usize,
    /// Once B has come, nothing but B may follow; and the buffer may not start with B.
    pub strict: bool,
    /// Relax is allowed too, in buffer and maintenance.
    pub allow_relax: bool,
}

impl Default for Rule {
    /// The paper's: half a second on each side, neither strict nor lenient.
    fn default() -> Self {
        Self {
            buffer: 200,
            strict: false,
            allow_relax: false,
        }
    }
}

/// The judgement of one change of the truth, A to B.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The prediction follows.
    Ok,
    /// A label other than A and B in the buffer, or none.
    BufferOtherClass,
    /// No change from A straight to B in the buffer.
    NoChangeInBuffer,
    /// Not B throughout the maintenance.
    MaintenanceNotHeld,
    /// Relax allowed: a label other than B and relax in the maintenance.
    MaintenanceOtherClass,
    /// Relax allowed: never B in the maintenance.
    MaintenanceOnlyRelax,
    /// Strict: a label other than A and B in the buffer, or none.
    StrictBufferOtherClass,
    /// Strict: no B in the buffer.
    StrictNoNewLabel,
    /// Strict: the buffer starts with B.
    StrictNewLabelAtStart,
    /// Strict: A again after B.
    StrictOldLabelAfterNew,
    /// Strict: not B throughout the maintenance.
    StrictMaintenanceNotHeld,
    /// Strict, relax allowed: a label other than B and relax in the maintenance.
    StrictMaintenanceOtherClass,
}

impl Verdict {
    /// The verdict as the golden cases and `--json` write it.
    #[must_use]
    pub const fn code(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::BufferOtherClass => "buffer_other_class",
            Self::NoChangeInBuffer => "no_change_in_buffer",
            Self::MaintenanceNotHeld => "maintenance_not_held",
            Self::MaintenanceOtherClass => "maintenance_other_class",
            Self::MaintenanceOnlyRelax => "maintenance_only_relax",
            Self::StrictBufferOtherClass => "strict_buffer_other_class",
            Self::StrictNoNewLabel => "strict_no_new_label",
            Self::StrictNewLabelAtStart => "strict_new_label_at_start",
            Self::StrictOldLabelAfterNew => "strict_old_label_after_new",
            Self::StrictMaintenanceNotHeld => "strict_maintenance_not_held",
            Self::StrictMaintenanceOtherClass => "strict_maintenance_other_class",
        }
    }

    /// The reason in words.
    #[must_use]
    pub const fn reason(self) -> &'static str {
        match self {
            Self::Ok => "follows",
            Self::BufferOtherClass | Self::StrictBufferOtherClass => {
                "a third label, or none, near the change"
            }
            Self::NoChangeInBuffer => "no change from the old label to the new one near the change",
            Self::MaintenanceNotHeld | Self::StrictMaintenanceNotHeld => {
                "the new label is not held until the next change"
            }
            Self::MaintenanceOtherClass | Self::StrictMaintenanceOtherClass => {
                "a third label, or none, while the new one should be held"
            }
            Self::MaintenanceOnlyRelax => "relax alone while the new label should be held",
            Self::StrictNoNewLabel => "the new label does not come near the change",
            Self::StrictNewLabelAtStart => "the new label comes too early",
            Self::StrictOldLabelAfterNew => "the old label comes back",
        }
    }
}

/// One change of the truth. All positions are samples of the whole sequence.
#[derive(Clone, PartialEq, Eq, Debug, serde::Serialize)]
pub struct Change {
    /// First sample of the new label.
    pub at: usize,
    /// Name of the old label.
    #[serde(serialize_with = "by_name")]
    pub from: Intent,
    /// Name of the new label.
    #[serde(serialize_with = "by_name")]
    pub to: Intent,
    /// Where the prediction must change.
    pub buffer: Range<usize>,
    /// Where it must hold; may be empty.
    pub maintenance: Range<usize>,
    /// The judgement.
    pub verdict: Verdict,
    /// Predicted minus true change in samples, if the verdict is ok; positive is late.
    pub offset: Option<i32>,
}

/// All changes of one truth.
#[derive(Clone, PartialEq, Eq, Debug, Default, serde::Serialize)]
pub struct TransitionScore {
    /// In order of time.
    pub changes: Vec<Change>,
    /// Labelled stretches without any change, and how many of them are predicted without a fault.
    /// They are no events and weigh nothing in the accuracy.
    pub constant: ConstantStretches,
}

/// Labelled stretches without a change.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, serde::Serialize)]
pub struct ConstantStretches {
    /// How many.
    pub count: usize,
    /// How many have the right prediction at every sample.
    pub held: usize,
}

impl TransitionScore {
    /// Changes in the truth.
    #[must_use]
    pub const fn events(&self) -> usize {
        self.changes.len()
    }

    /// Changes that the prediction follows.
    #[must_use]
    pub fn correct(&self) -> usize {
        self.changes
            .iter()
            .filter(|change| change.verdict == Verdict::Ok)
            .count()
    }

    /// `correct / events`; none without a change.
    #[must_use]
    pub fn accuracy(&self) -> Option<f64> {
        (self.events() > 0).then(|| self.correct() as f64 / self.events() as f64)
    }

    /// Signed offsets, in samples, of the changes that have one.
    pub fn offsets(&self) -> impl Iterator<Item = i32> {
        self.changes.iter().filter_map(|change| change.offset)
    }
}

/// Judges every change of the truth.
///
/// Each labelled stretch of the truth is judged as a recording of its own ([`stretches`]).
///
/// # Errors
/// [`MetricError::Length`] if the sequences differ in length; [`MetricError::NarrowBuffer`] below
/// 2 samples;
/// [`MetricError::SingleSampleLabel`] if a true label between two changes lasts one sample.
pub fn score(
    truth: &[Label],
    prediction: &[Label],
    rule: &Rule,
) -> Result<TransitionScore, MetricError> {
    same_length(truth, prediction)?;
    if rule.buffer < 2 {
        return Err(MetricError::NarrowBuffer(rule.buffer));
    }
    let mut score = TransitionScore::default();
    for stretch in stretches(truth) {
        let truth: Vec<Intent> = truth[stretch.clone()].iter().copied().flatten().collect();
        let prediction = &prediction[stretch.clone()];
        let windows = Windows::new(&truth, rule.buffer);
        if windows.changes.is_empty() {
            score.constant.count += 1;
            let held = truth.iter().zip(prediction).all(|(&t, &p)| p == Some(t));
            score.constant.held += usize::from(held);
        }
        for index in 0..windows.changes.len() {
            let mut change = judge(&truth, prediction, &windows, index, rule).map_err(|at| {
                MetricError::SingleSampleLabel {
                    at: stretch.start + at,
                }
            })?;
            change.at += stretch.start;
            for range in [&mut change.buffer, &mut change.maintenance] {
                *range = range.start + stretch.start..range.end + stretch.start;
            }
            score.changes.push(change);
        }
    }
    Ok(score)
}

/// Buffers and maintenance of one labelled stretch.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Windows {
    /// First sample of every new label.
    pub changes: Vec<usize>,
    /// One buffer per change.
    pub buffers: Vec<Range<usize>>,
    /// What follows each buffer up to the next; without any change, everything.
    pub maintenance: Vec<Range<usize>>,
}

impl Windows {
    /// Lays the windows out for buffers of `width` samples.
    ///
    /// A buffer starts no earlier than the one before it ends, and stops one sample *before* the
    /// last sample of its label where the next change is near: both are the reference's.
    #[must_use]
    pub fn new(truth: &[Intent], width: usize) -> Self {
        let half = width / 2;
        let samples = truth.len();
        let changes: Vec<usize> = (1..samples)
            .filter(|&at| truth[at] != truth[at - 1])
            .collect();
        let mut buffers: Vec<Range<usize>> = Vec::with_capacity(changes.len());
        for (index, &change) in changes.iter().enumerate() {
            let before = buffers.last().map_or(0, |buffer| buffer.end);
            let start = change.saturating_sub(half).max(before);
            let end = (change + half).min(samples);
            let end = match changes.get(index + 1) {
                Some(&next) if next <= end => next - 1,
                _ => end,
            };
            buffers.push(start..end);
        }
        let maintenance = if buffers.is_empty() {
            std::iter::once(0..samples).collect()
        } else {
            let next_starts = buffers.iter().skip(1).map(|b| b.start).chain([samples]);
            buffers
                .iter()
                .zip(next_starts)
                .map(|(buffer, next)| buffer.end..next)
                .collect()
        };
        Self {
            changes,
            buffers,
            maintenance,
        }
    }
}

/// Judges one change; the error is the sample of a label too short to have a buffer.
fn judge(
    truth: &[Intent],
    prediction: &[Label],
    windows: &Windows,
    index: usize,
    rule: &Rule,
) -> Result<Change, usize> {
    let at = windows.changes[index];
    let (buffer, maintenance) = (&windows.buffers[index], &windows.maintenance[index]);
    if !buffer.contains(&at) || buffer.start == at {
        return Err(at);
    }
    let (from, to) = (truth[at - 1], truth[at]);
    let near = &prediction[buffer.clone()];
    let later = &prediction[maintenance.clone()];
    let verdict = if rule.strict {
        strict(from, to, near, later, rule.allow_relax)
    } else {
        lenient(from, to, near, later, rule.allow_relax)
    };
    let offset = (verdict == Verdict::Ok)
        .then(|| offset(prediction, at, Some(from), Some(to), rule.buffer / 2))
        .flatten();
    Ok(Change {
        at,
        from,
        to,
        buffer: buffer.clone(),
        maintenance: maintenance.clone(),
        verdict,
        offset,
    })
}

fn lenient(from: Intent, to: Intent, near: &[Label], later: &[Label], relax: bool) -> Verdict {
    let (from, to) = (Some(from), Some(to));
    let allowed = |label: Label| relax && label == Some(Intent::Relax);
    if near
        .iter()
        .any(|&label| label != from && label != to && !allowed(label))
    {
        return Verdict::BufferOtherClass;
    }
    if !near.windows(2).any(|pair| pair == [from, to]) {
        return Verdict::NoChangeInBuffer;
    }
    if relax {
        if later.iter().any(|&label| label != to && !allowed(label)) {
            return Verdict::MaintenanceOtherClass;
        }
        if !later.is_empty() && !later.contains(&to) {
            return Verdict::MaintenanceOnlyRelax;
        }
    } else if later.iter().any(|&label| label != to) {
        return Verdict::MaintenanceNotHeld;
    }
    Verdict::Ok
}

fn strict(from: Intent, to: Intent, near: &[Label], later: &[Label], relax: bool) -> Verdict {
    let (from, to) = (Some(from), Some(to));
    let allowed = |label: Label| relax && label == Some(Intent::Relax);
    if near
        .iter()
        .any(|&label| label != from && label != to && !allowed(label))
    {
        return Verdict::StrictBufferOtherClass;
    }
    let Some(first) = near.iter().position(|&label| label == to) else {
        return Verdict::StrictNoNewLabel;
    };
    if first == 0 {
        return Verdict::StrictNewLabelAtStart;
    }
    if near[first..]
        .iter()
        .any(|&label| label != to && !allowed(label))
    {
        return Verdict::StrictOldLabelAfterNew;
    }
    match later.iter().any(|&label| label != to && !allowed(label)) {
        true if relax => Verdict::StrictMaintenanceOtherClass,
        true => Verdict::StrictMaintenanceNotHeld,
        false => Verdict::Ok,
    }
}

/// The nearest predicted change A, B within half a buffer of the true one, the earliest on ties.
fn offset(prediction: &[Label], at: usize, from: Label, to: Label, half: usize) -> Option<i32> {
    let last_old = at - 1;
    let range = last_old.saturating_sub(half)..(prediction.len() - 1).min(last_old + half);
    let distance = |sample: usize| sample as i32 - last_old as i32;
    let straight = range
        .clone()
        .filter(|&i| prediction[i] == from && prediction[i + 1] == to)
        .map(distance)
        .min_by_key(|offset| offset.abs());
    // Reached only where relax lies between A and B: the first B then, as the reference does.
    straight.or_else(|| range.clone().find(|&i| prediction[i] == to).map(distance))
}

fn by_name<S: serde::Serializer>(intent: &Intent, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(intent.name())
}

#[cfg(test)]
mod tests {
    use super::*;

    const R: Label = Some(Intent::Relax);
    const O: Label = Some(Intent::Open);
    const C: Label = Some(Intent::Close);

    fn sequence(runs: &[(Label, usize)]) -> Vec<Label> {
        runs.iter()
            .flat_map(|&(label, count)| vec![label; count])
            .collect()
    }

    fn verdict(truth: &[(Label, usize)], prediction: &[(Label, usize)]) -> Verdict {
        let score = score(&sequence(truth), &sequence(prediction), &Rule::default()).unwrap();
        score.changes[0].verdict
    }

    #[test]
    fn a_delay_below_half_the_buffer_follows_and_half_does_not() {
        let truth = [(R, 500), (O, 500)];
        assert_eq!(verdict(&truth, &[(R, 599), (O, 401)]), Verdict::Ok);
        assert_eq!(
            verdict(&truth, &[(R, 600), (O, 400)]),
            Verdict::NoChangeInBuffer
        );
        assert_eq!(verdict(&truth, &[(R, 401), (O, 599)]), Verdict::Ok);
        assert_eq!(
            verdict(&truth, &[(R, 400), (O, 600)]),
            Verdict::NoChangeInBuffer
        );
    }

    #[test]
    fn each_failure_has_its_reason() {
        let truth = [(R, 500), (O, 500)];
        let third = [(R, 480), (C, 30), (O, 490)];
        assert_eq!(verdict(&truth, &third), Verdict::BufferOtherClass);
        let silent = [(R, 480), (None, 30), (O, 490)];
        assert_eq!(verdict(&truth, &silent), Verdict::BufferOtherClass);
        let dropped = [(R, 500), (O, 400), (R, 100)];
        assert_eq!(verdict(&truth, &dropped), Verdict::MaintenanceNotHeld);
    }

    #[test]
    fn unlabelled_stretches_divide_the_truth() {
        let truth = sequence(&[
            (R, 300),
            (O, 300),
            (None, 200),
            (R, 300),
            (C, 300),
            (None, 10),
        ]);
        let prediction = sequence(&[(R, 310), (O, 490), (R, 290), (C, 320)]);
        let score = score(&truth, &prediction, &Rule::default()).unwrap();
        let found: Vec<_> = score
            .changes
            .iter()
            .map(|c| (c.at, c.verdict, c.offset, c.maintenance.end))
            .collect();
        assert_eq!(
            found,
            [
                (300, Verdict::Ok, Some(10), 600),
                (1100, Verdict::Ok, Some(-10), 1400)
            ]
        );
        assert_eq!(score.accuracy(), Some(1.0));
    }

    #[test]
    fn a_truth_of_one_label_is_no_event() {
        let score = score(&[R; 50], &[R; 50], &Rule::default()).unwrap();
        assert_eq!((score.events(), score.accuracy()), (0, None));
        assert_eq!(score.constant, ConstantStretches { count: 1, held: 1 });
    }

    #[test]
    fn a_label_of_one_sample_is_refused_with_its_place() {
        let truth = sequence(&[(R, 300), (O, 1), (R, 300)]);
        let error = score(&truth, &truth, &Rule::default()).unwrap_err();
        assert_eq!(error, MetricError::SingleSampleLabel { at: 300 });
    }

    proptest::proptest! {
        #[test]
        fn any_sequences_are_scored_or_refused(
            labels in proptest::collection::vec((0..4usize, 0..4usize), 1..200),
            buffer in 0..80usize,
            strict: bool,
            allow_relax: bool,
        ) {
            let intent = |class| if class == 3 { None } else { Intent::from_class(class) };
            let (truth, prediction): (Vec<_>, Vec<_>) =
                labels.into_iter().map(|(t, p)| (intent(t), intent(p))).unzip();
            let _ = score(&truth, &prediction, &Rule { buffer, strict, allow_relax });
        }
    }
}
