//! Results of several folds as if all of their subjects had been evaluated at once.
//!
//! Scores are merged by subject and summarized again; means of folds are not used. The score over all
//! data sets is computed from the subjects of each data set, since a fold that holds out subjects of one
//! data set only has no such score.

use std::collections::{BTreeMap, BTreeSet};

use myointent::dataset::DataSet;
use myointent::evaluation::metric::event::summary::EventSummary;
use myointent::evaluation::metric::summary::Summary;
use myointent::evaluation::{ALL, Cued, Group as People, LookAhead, Score, Truth};
use myointent::run::evaluate::Results;

/// Merges the results of folds that hold out different subjects.
///
/// The aggregation mode is the one that all folds chose. Where they differ it is the paper's, all rows:
/// choosing one by these results would choose on held-out subjects.
pub(super) fn merge(folds: &[&Results]) -> Results {
    let held_out: BTreeSet<&String> = folds.iter().flat_map(|fold| &fold.held_out).collect();
    let mut aggregations = folds.iter().map(|fold| fold.aggregation);
    let first = aggregations.next().unwrap_or(LookAhead::AllRows);
    let agreed = aggregations.all(|other| other == first);
    let mut gestures: BTreeMap<DataSet, Cued> = BTreeMap::new();
    for (&data_set, own) in folds.iter().flat_map(|fold| &fold.gestures) {
        let sum = gestures.entry(data_set).or_default();
        sum.cued += own.cued;
        sum.scored += own.scored;
    }
    Results {
        held_out: held_out.into_iter().cloned().collect(),
        aggregation: if agreed { first } else { LookAhead::AllRows },
        gestures,
        published: scores(folds.iter().flat_map(|fold| &fold.published)),
        spliced: scores(folds.iter().flat_map(|fold| &fold.spliced)),
    }
}

/// One score per condition and data set, in the order in which the conditions first appear.
fn scores<'a>(all: impl Iterator<Item = &'a Score>) -> Vec<Score> {
    type Condition<'a> = (Truth, &'a str, LookAhead, People);
    type Group<'a> = BTreeMap<&'a str, Vec<&'a Score>>;
    let mut groups: Vec<(Condition, Group)> = Vec::new();
    for score in all.filter(|score| score.data_set != ALL) {
        let condition = (
            score.truth,
            score.model.as_str(),
            score.look_ahead,
            score.people,
        );
        let at = groups
            .iter()
            .position(|(known, _)| *known == condition)
            .unwrap_or_else(|| {
                groups.push((condition, Group::new()));
                groups.len() - 1
            });
        let sets = &mut groups[at].1;
        sets.entry(&score.data_set).or_default().push(score);
    }
    let mut merged = Vec::new();
    for (condition, sets) in groups {
        for (data_set, folds) in &sets {
            merged.push(pooled(condition, data_set, folds));
        }
        if sets.len() > 1 {
            let all: Vec<&Score> = sets.into_values().flatten().collect();
            merged.push(pooled(condition, ALL, &all));
        }
    }
    // The order of an evaluation: all models with one kind of labels, then with the next.
    let order: Vec<Truth> = merged.iter().map(|score| score.truth).collect();
    merged.sort_by_key(|score| order.iter().position(|&truth| truth == score.truth));
    merged
}

fn pooled(
    (truth, model, look_ahead, people): (Truth, &str, LookAhead, People),
    data_set: &str,
    folds: &[&Score],
) -> Score {
    let with_buffer = |buffer: usize| {
        let of_fold = |fold: &&Score| fold.reference[buffer].subjects.clone();
        Summary::of_subjects(folds.iter().flat_map(of_fold).collect())
    };
    let events = folds.iter().flat_map(|fold| fold.events.subjects.clone());
    Score {
        model: model.to_owned(),
        data_set: data_set.to_owned(),
        classes: folds[0].classes,
        people,
        look_ahead,
        truth,
        reference: std::array::from_fn(with_buffer),
        events: EventSummary::of_subjects(events.collect()),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::comparison::results::fixture::{results, score};

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn any_division_into_folds_equals_one_evaluation(
            subjects in prop::collection::vec((0..4_usize, any::<bool>(), 0..=1000_u32, prop::collection::vec(-99..=99_i32, 0..6)), 1..12),
        ) {
            let scores: Vec<_> = subjects
                .iter()
                .enumerate()
                .map(|(at, (fold, roshambo, raw, offsets))| {
                    let set = if *roshambo { "roshambo" } else { "ss-stm" };
                    let raw = f64::from(*raw) / 1000.0;
                    (*fold, score(&format!("{set}/{at}"), raw, offsets, offsets.len() + at % 3))
                })
                .collect();
            let whole = results(scores.iter().map(|(_, score)| score.clone()), &[("teacher", true)]);
            let folds: Vec<Results> = (0..4)
                .map(|fold| {
                    let own = scores.iter().filter(|(of, _)| *of == fold);
                    results(own.map(|(_, score)| score.clone()), &[("teacher", true)])
                })
                .collect();
            let merged = merge(&folds.iter().rev().collect::<Vec<_>>());
            prop_assert_eq!(&merged.held_out, &whole.held_out);
            let of_set = |results: &Results, set: &str| {
                let mut all = results.published.iter();
                all.find(|score| score.data_set == set && score.truth == Truth::LagCompensated).cloned()
            };
            for set in ["roshambo", "ss-stm", ALL] {
                prop_assert_eq!(of_set(&merged, set), of_set(&whole, set));
            }
            // The naive version: a mean over subjects, directly from the drawn values.
            let naive = subjects.iter().map(|(_, _, raw, _)| f64::from(*raw) / 1000.0).sum::<f64>() / subjects.len() as f64;
            let last = merged.published.last().unwrap();
            prop_assert!((last.widest().raw_accuracy.unwrap().mean - naive).abs() < 1e-12);
            let events: usize = subjects.iter().enumerate().map(|(at, subject)| subject.3.len() + at % 3).sum();
            prop_assert_eq!(last.events.gestures, events);
        }
    }

    #[test]
    fn subjects_have_one_weight_whatever_the_size_of_their_fold() {
        let fold = |scores: Vec<_>| results(scores, &[("teacher", true)]);
        let one = fold(vec![score("roshambo/01", 1.0, &[], 1)]);
        let two = fold(vec![
            score("roshambo/02", 0.0, &[], 1),
            score("roshambo/03", 0.5, &[], 1),
        ]);
        let merged = merge(&[&one, &two]);
        // A mean of the folds' means would be 0.625.
        assert_eq!(merged.published[0].widest().raw_accuracy.unwrap().mean, 0.5);
    }

    #[test]
    fn a_median_is_over_all_transitions() {
        let fold = |scores: Vec<_>| results(scores, &[("teacher", true)]);
        let one = fold(vec![score("roshambo/01", 1.0, &[0, 10, 12], 3)]);
        let two = fold(vec![score("roshambo/02", 1.0, &[30, 40], 2)]);
        let merged = merge(&[&one, &two]);
        let offset = merged.published[0].widest().offset.unwrap();
        assert_eq!((offset.signed_median, offset.count), (60.0, 5));
    }
}
