//! Detection of two classes that are exchanged in the labels of a person's recordings.

use std::slice;

use shared::model::file::Model;

use super::error::{Exchange, PersonalizeError};
use super::person::{Own, PersonRecordings};
use evaluation::integer_candidate;
use evaluation::model_evaluation::look_ahead;
use evaluation::{Candidate, EvaluatedRecording, confusion};

/// Gain of balanced accuracy that an exchange has to explain.
const EXPLAINED: f64 = 0.1;

/// Finds two classes that the model takes for each other in a person's recordings, in all of them or in single ones; none if no
/// exchange of two explains a tenth of balanced accuracy.
///
/// Uses the published labels: lag compensation drops labels that no muscle follows, such as rest labelled as a gesture.
pub(super) fn exchange(
    file: &[u8],
    person: &PersonRecordings,
) -> Result<Option<Exchange>, PersonalizeError> {
    let model = Model::parse(file)?;
    let published = |own: &Own| {
        let mut recording = own.evaluated.clone();
        if let Some(labels) = recording.published.take() {
            recording.lag_compensated = labels;
        }
        recording
    };
    let recordings: Vec<EvaluatedRecording> = person.recordings.iter().map(published).collect();
    let candidate = integer_candidate("before", &model, &recordings)?;
    let look_ahead = look_ahead(&model.header.smoother);
    let vocabulary = model.header.dimensions.vocabulary;
    let counts = |logits, recordings: &[EvaluatedRecording]| {
        let candidate = Candidate {
            logits,
            ..candidate.clone()
        };
        let found = confusion(&candidate, recordings, vocabulary, look_ahead)?;
        Ok::<_, PersonalizeError>(found.counts)
    };
    let name = |class: usize| vocabulary.intents()[class].name();
    let named = |found: Found, recordings| Exchange {
        classes: found.classes.map(name),
        is_mutual: found.is_mutual,
        recordings,
        before: found.before,
        exchanged: found.exchanged,
    };
    if let Some(found) = exchanged(&counts(candidate.logits.clone(), &recordings)?) {
        return Ok(Some(named(found, Vec::new())));
    }
    // Each session is labelled separately, so single ones may be exchanged. The first such pair is returned, with all its
    // recordings.
    let mut own: Vec<(Found, &EvaluatedRecording)> = Vec::new();
    for (recording, logits) in recordings.iter().zip(&candidate.logits) {
        let found = exchanged(&counts(vec![logits.clone()], slice::from_ref(recording))?);
        let found = found.filter(|found| found.is_mutual);
        own.extend(found.map(|found| (found, recording)));
    }
    let Some(&(first, _)) = own.first() else {
        return Ok(None);
    };
    own.retain(|(found, _)| found.classes == first.classes);
    let recordings = own
        .iter()
        .map(|(_, recording)| recording.name.clone())
        .collect();
    let mean = |of: fn(&Found) -> f64| {
        own.iter().map(|(found, _)| of(found)).sum::<f64>() / own.len() as f64
    };
    let found = Found {
        classes: first.classes,
        is_mutual: true,
        before: mean(|found| found.before),
        exchanged: mean(|found| found.exchanged),
    };
    Ok(Some(named(found, recordings)))
}

/// Two classes, and balanced accuracy before and after their exchange.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Found {
    classes: [usize; 2],
    is_mutual: bool,
    before: f64,
    exchanged: f64,
}

/// Pair of classes whose exchange explains most of `counts[truth][prediction]`.
fn exchanged(counts: &[Vec<u64>]) -> Option<Found> {
    let share = |truth: usize, prediction: usize| {
        let all: u64 = counts[truth].iter().sum();
        (all > 0).then(|| counts[truth][prediction] as f64 / all as f64)
    };
    let classes = 0..counts.len();
    let recalls: Vec<f64> = classes.clone().filter_map(|own| share(own, own)).collect();
    let before = recalls.iter().sum::<f64>() / recalls.len() as f64;
    let pairs = classes
        .clone()
        .flat_map(|one| (0..one).map(move |other| [other, one]));
    let gained = |classes @ [one, other]: [usize; 2]| {
        let gains = [
            share(one, other)? - share(one, one)?,
            share(other, one)? - share(other, other)?,
        ];
        let exchanged = before + (gains[0] + gains[1]) / recalls.len() as f64;
        (exchanged >= before + EXPLAINED).then_some(Found {
            classes,
            is_mutual: gains.iter().all(|&gain| gain > 0.0),
            before,
            exchanged,
        })
    };
    pairs
        .filter_map(gained)
        .max_by(|one, other| one.exchanged.total_cmp(&other.exchanged))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Finds the exchange in counts in percent (last column: no label). Returns the pair, and whether it is mutual.
    fn found(counts: &[&[u64]]) -> Option<([usize; 2], bool)> {
        let counts: Vec<Vec<u64>> = counts.iter().map(|row| row.to_vec()).collect();
        exchanged(&counts).map(|found| (found.classes, found.is_mutual))
    }

    #[test]
    fn every_pair_is_found_by_its_exchange_alone() {
        for classes in [3, 6] {
            for other in 1..classes {
                for one in 0..other {
                    let counts: Vec<Vec<u64>> = (0..classes)
                        .map(|truth| {
                            let taken = match truth {
                                _ if truth == one => other,
                                _ if truth == other => one,
                                _ => truth,
                            };
                            let share = |prediction| if prediction == taken { 90 } else { 2 };
                            (0..=classes).map(share).collect()
                        })
                        .collect();
                    let found = exchanged(&counts).unwrap();
                    assert_eq!(found.classes, [one, other]);
                    assert!(found.exchanged > 0.85 && found.before < found.exchanged - 0.25);
                }
            }
        }
    }

    #[test]
    fn a_model_that_understands_a_person_badly_has_nothing_exchanged() {
        for (case, [relax, open, close]) in [
            ("always relax", [[100, 0, 0, 0]; 3]),
            (
                "one gesture for both",
                [[90, 0, 10, 0], [5, 0, 95, 0], [5, 0, 95, 0]],
            ),
            ("all right", [[98, 1, 1, 0], [1, 98, 1, 0], [1, 1, 98, 0]]),
            ("one never labelled", [[98, 1, 1, 0], [0; 4], [1, 90, 9, 0]]),
            ("nothing labelled", [[0; 4]; 3]),
        ] {
            assert_eq!(found(&[&relax, &open, &close]), None, "{case}");
        }
    }

    #[test]
    fn an_exchange_that_explains_one_of_the_two_is_said_to_be_doubtful() {
        // Labels of `close` are mostly recognised: only the open hand is taken for a fist.
        let counts: [&[u64]; 3] = [&[97, 0, 3, 0], &[0, 0, 100, 0], &[4, 26, 70, 0]];
        assert_eq!(found(&counts), Some(([1, 2], false)));
    }
}
