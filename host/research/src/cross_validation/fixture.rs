//! Scores of folds for tests.

use evaluation::metric::event::activation::Rate;
use evaluation::metric::event::latency;
use evaluation::metric::event::summary::SubjectEvents;
use evaluation::metric::summary::SubjectScore;
use evaluation::{ALL, LookAhead, Score};

use super::job::FoldScore;
use super::merged::Origin;

pub(crate) const fn origin(seed: u64, fold: usize) -> Origin {
    Origin { seed, fold }
}

/// Scores of one fold under every look-ahead, from each person's balanced and raw accuracy, offsets of followed
/// transitions, and number of all transitions.
pub(crate) fn fold(model: &str, people: &[(&str, f64, &[i32], usize)]) -> Vec<FoldScore> {
    let subjects: Vec<SubjectScore> = people
        .iter()
        .map(|&(subject, accuracy, offsets, transitions)| SubjectScore {
            subject: subject.to_owned(),
            balanced_accuracy: Some(accuracy),
            raw_accuracy: Some(accuracy),
            correct: offsets.len(),
            events: transitions,
            transition_accuracy: (transitions > 0)
                .then(|| offsets.len() as f64 / transitions as f64),
            offsets: offsets.to_vec(),
            ..SubjectScore::default()
        })
        .collect();
    let events = subjects.iter().map(events).collect();
    let of_people = Score::of_people(subjects, events);
    let score = |look_ahead| Score {
        model: model.into(),
        data_set: ALL.to_owned(),
        look_ahead,
        ..of_people.clone()
    };
    let scores = LookAhead::ALL.into_iter().map(score);
    scores
        .map(|score| FoldScore { gate: None, score })
        .collect()
}

/// Events of a person: every transition is the onset of a gesture, and labels are emitted 50 samples after their reference
/// time, and end 40 samples after it. There is one false activation in half a minute of rest, and three changes too many in a minute.
fn events(score: &SubjectScore) -> SubjectEvents {
    let latencies: Vec<i32> = score.offsets.iter().map(|offset| offset + 50).collect();
    let rate = |count, seconds| Rate { count, seconds };
    SubjectEvents {
        subject: score.subject.clone(),
        gestures: score.events,
        recognised: score.correct,
        recognition: score.transition_accuracy,
        latency: latency::summary(&latencies, score.events),
        latencies,
        releases: score.offsets.iter().map(|offset| offset + 40).collect(),
        rest: rate(1, 30.0),
        flicker: rate(3, 60.0),
        ..SubjectEvents::default()
    }
}
