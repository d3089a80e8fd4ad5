//! A run or a model file on a page, and the page that one or several of them make.

use std::ops::Range;

use shared::intent::{Intent, Vocabulary};
use shared::units::{LOOK_AHEAD, SAMPLE_RATE_HZ};

use super::cell::{estimate, quantile, rate};
use super::curves::Panel;
use super::device::Device;
use super::overview::{Kind, Row};
use super::people::People;
use super::scores::counted;
use super::timeline::Timeline;
use super::{Errors, Fact, Headline, ReportData, ReportError};
use crate::{
    ALL, Candidate, ENERGY, EvaluationError, Group, LookAhead, Measure, Score, Trial, confusion,
    gestures, smooth,
};

/// Maximum number of entries on one page, for their colours to differ.
pub const MOST_ENTRIES: usize = 5;

/// Samples of a recording in a picture: 20 s.
const SHOWN: usize = 4000;
/// People who are drawn of a single entry, the lowest first; the best one is added.
const WORST: usize = 3;

/// A run or a model file, and the data of its pictures.
pub(super) struct Entry<'a> {
    /// Name on the page.
    pub name: String,
    /// Facts about it, in the order to be shown.
    pub facts: Vec<Fact>,
    /// Rows under lag-compensated labels, one for each data set.
    pub scores: Vec<Score>,
    /// Rows of other models of the same run.
    pub beside: Vec<Score>,
    /// Rows of the floors, over the same people.
    pub floors: Vec<Score>,
    /// The recordings.
    pub trials: &'a [Trial],
    /// Logits over the recordings.
    pub candidate: &'a Candidate,
    /// Classes of the model.
    pub vocabulary: Vocabulary,
    /// Look-ahead of the model.
    pub look_ahead: LookAhead,
    /// Learning curves.
    pub panels: Vec<Panel>,
    /// The model file, if it is one.
    pub bytes: Option<&'a [u8]>,
}

impl Entry<'_> {
    /// Row over all recordings of the people who have all classes; of those with fewer, if nobody has.
    pub(super) fn over_all(&self) -> Option<&Score> {
        over_all(&self.scores).next()
    }

    /// Rows over all recordings: of the people who have all classes, of those with fewer.
    pub(super) fn everybody(&self) -> Vec<&Score> {
        over_all(&self.scores).collect()
    }

    /// People by balanced accuracy, the lowest first; those without one are left out.
    fn people(&self) -> Vec<&str> {
        let rows = over_all(&self.scores);
        let mut values: Vec<_> = rows
            .flat_map(|score| Measure::BalancedAccuracy.values(score))
            .collect();
        values.sort_by(|a, b| a.1.total_cmp(&b.1));
        values.into_iter().map(|(subject, _)| subject).collect()
    }

    /// Errors: confusion and latencies.
    fn errors(&self) -> Result<Errors, EvaluationError> {
        let (candidate, trials) = (self.candidate, self.trials);
        let confusion = confusion(candidate, trials, self.vocabulary, self.look_ahead)?;
        let gestures = gestures(candidate, trials, self.vocabulary, self.look_ahead)?;
        Ok(Errors {
            name: self.name.clone(),
            confusion: Some(confusion),
            latencies: gestures.into_iter().map(|own| own.latency).collect(),
        })
    }
}

/// The rows over all recordings, or those of the only data set: people with all classes first.
pub(super) fn over_all(scores: &[Score]) -> impl Iterator<Item = &Score> {
    let several = scores.iter().any(|score| score.data_set == ALL);
    let of = move |people| {
        let rows = scores.iter().filter(move |score| score.people == people);
        rows.filter(move |score| !several || score.data_set == ALL)
    };
    Group::ALL.into_iter().flat_map(of)
}

/// Parts of a page that come from its entries: people, pictures, device cost. Title, summary, facts, tables and notes
/// are the caller's.
///
/// # Errors
/// When labels cannot be compared or the smoother's settings are invalid.
pub(super) fn pictures(entries: &[Entry<'_>]) -> Result<ReportData, ReportError> {
    let mut data = ReportData {
        overview: overview(entries),
        people: people(entries),
        panels: entries.iter().flat_map(|own| own.panels.clone()).collect(),
        device: entries.iter().filter_map(device).collect(),
        ..ReportData::default()
    };
    if let [only] = entries {
        data.headline = headline(only);
        data.drawn =
            "The people with the lowest balanced accuracy, the worst first, then the best one"
                .to_owned();
    } else {
        data.drawn =
            "The person with the lowest balanced accuracy of each model, then its best one"
                .to_owned();
    }
    for entry in entries {
        let people = entry.people();
        let worst = if entries.len() == 1 { WORST } else { 1 };
        let drawn = people.iter().take(worst);
        for subject in drawn.chain(people.iter().skip(worst).last()) {
            data.timelines
                .extend(drawn_recording(entry, subject, entries.len() > 1)?);
        }
        data.errors.push(entry.errors()?);
    }
    Ok(data)
}

/// The part of a person's recordings with the most gestures.
fn drawn_recording(
    entry: &Entry<'_>,
    subject: &str,
    named: bool,
) -> Result<Option<Timeline>, EvaluationError> {
    let own = (0..entry.trials.len()).filter(|&at| entry.trials[at].subject == subject);
    let busiest = own
        .map(|at| (at, busiest_part(&entry.trials[at])))
        .max_by_key(|(at, part)| onsets(&entry.trials[*at], part));
    let Some((at, part)) = busiest else {
        return Ok(None);
    };
    let classes = entry.vocabulary.classes();
    let whole = timeline(entry.candidate, entry.trials, at, entry.look_ahead, classes)?;
    let mut shown = whole.section(part.clone());
    if part.start > 0 {
        let second = part.start / SAMPLE_RATE_HZ as usize;
        shown.recording += &format!(", from {second} s");
    }
    if named {
        shown.recording += &format!(" · {}", entry.name);
    }
    Ok(Some(shown))
}

/// One trial with the labels that a candidate emits for it.
pub(super) fn timeline(
    candidate: &Candidate,
    trials: &[Trial],
    at: usize,
    look_ahead: LookAhead,
    classes: usize,
) -> Result<Timeline, EvaluationError> {
    let trial = &trials[at];
    let labels = smooth(
        &candidate.logits[at],
        trial.emg.len(),
        classes,
        candidate.settings(look_ahead),
    )?;
    Ok(Timeline {
        subject: trial.subject.clone(),
        recording: trial.name.clone(),
        emg: trial.emg.clone(),
        truth: trial.lag_compensated.clone(),
        emitted: labels.reference,
        look_ahead_samples: match look_ahead {
            LookAhead::None => 0,
            LookAhead::AllRows | LookAhead::SameInstant => LOOK_AHEAD,
        },
    })
}

/// The 20 s of a recording with the most gestures, the first ones on ties.
fn busiest_part(trial: &Trial) -> Range<usize> {
    let starts = (0..trial.emg.len().max(1)).step_by(SHOWN / 4);
    let parts = starts.map(|start| start..start + SHOWN);
    // A part that the recording's end cuts short only if there is no other.
    let whole = parts.filter(|part| part.start == 0 || part.end <= trial.emg.len());
    whole
        .rev()
        .max_by_key(|part| onsets(trial, part))
        .unwrap_or(0..SHOWN)
}

/// Gestures that begin in a part of a recording.
pub(super) fn onsets(trial: &Trial, part: &Range<usize>) -> usize {
    let labels = &trial.lag_compensated;
    let end = part.end.min(labels.len());
    let labels = &labels[part.start.min(end)..end];
    let is_gesture = |label: Option<Intent>| label.is_some_and(|intent| intent != Intent::Relax);
    let begins = |pair: &&[Option<Intent>]| pair[0] != pair[1] && is_gesture(pair[1]);
    labels.windows(2).filter(begins).count()
}

fn overview(entries: &[Entry<'_>]) -> Vec<Row> {
    let mut rows: Vec<Row> = Vec::new();
    for (number, entry) in entries.iter().enumerate() {
        let own = entry.everybody().into_iter();
        rows.extend(own.map(|own| Row::of(own, Kind::Entry(number))));
    }
    let beside = entries.iter().map(|entry| (&entry.beside, Kind::Beside));
    let floors = entries.iter().map(|entry| (&entry.floors, Kind::Floor));
    for (scores, kind) in beside.chain(floors) {
        for score in over_all(scores) {
            let row = Row::of(score, kind);
            // Floors of several entries may be the same.
            if !rows.contains(&row) {
                rows.push(row);
            }
        }
    }
    rows
}

fn people(entries: &[Entry<'_>]) -> Option<People> {
    let own: Vec<(&str, Vec<&Score>)> = entries
        .iter()
        .map(|entry| (&entry.name[..], entry.everybody()))
        .collect();
    let floors: Vec<&Score> = entries
        .iter()
        .flat_map(|entry| {
            let floors = over_all(&entry.floors);
            floors.filter(|own| own.model.starts_with(ENERGY))
        })
        .collect();
    let people = People::of(&own, &floors);
    (!people.rows.is_empty()).then_some(people)
}

fn device(entry: &Entry<'_>) -> Option<Device> {
    Device::of(&entry.name, entry.bytes?)
}

/// Numbers at the top of a page, each beside the energy detector's: of people who have all classes, if there are any.
fn headline(entry: &Entry<'_>) -> Vec<Headline> {
    let Some(own) = entry.over_all() else {
        return Vec::new();
    };
    let energy = over_all(&entry.floors)
        .find(|floor| floor.model.starts_with(ENERGY) && floor.people == own.people);
    let share = |name: &str, measure: Measure| {
        let shown = counted(
            estimate(measure.mean(own), measure.interval(own)),
            own,
            measure,
        )
        .shown;
        let (value, interval) = shown.split_once(' ').unwrap_or((&shown, ""));
        let floor = energy.and_then(|floor| measure.mean(floor));
        Headline {
            name: name.to_owned(),
            value: value.to_owned(),
            remark: interval.to_owned(),
            floor: floor.map(|floor| format!("{:.3}", floor.mean)),
        }
    };
    let median = |score: &Score| score.events.latency.map(|own| quantile(own.median));
    let false_rate = |score: &Score| rate(score.events.false_activations).shown;
    let first = |text: String| text.split(' ').next().unwrap_or_default().to_owned();
    vec![
        Headline {
            name: "people".to_owned(),
            value: own.widest().subjects.len().to_string(),
            remark: own.people.told(own.classes),
            floor: None,
        },
        share("balanced accuracy", Measure::BalancedAccuracy),
        share("transition accuracy", Measure::TransitionAccuracy),
        share("gestures recognised", Measure::Recognition),
        Headline {
            name: "median latency, ms".to_owned(),
            value: median(own).unwrap_or_else(|| "-".to_owned()),
            remark: "from the muscle's onset".to_owned(),
            floor: energy.and_then(median),
        },
        Headline {
            name: "false activations".to_owned(),
            value: first(false_rate(own)),
            remark: "a minute of rest".to_owned(),
            floor: energy.map(|floor| first(false_rate(floor))),
        },
    ]
}
