//! Tables of a cross-validation, printed and written.

use evaluation::report::{Table, recognition};
use evaluation::{CONSTANT, ENERGY, Group, LookAhead};
use presets::OperatingPoint;

use crate::cross_validation::{
    Contender, FoldScore, JobScores, Merged, Origin, daily_life, differences, emission, movements,
    over_sets, scores, test_scores,
};

/// Tables of the development people, then those of the test people, if they were evaluated.
pub(super) fn tables(development: &[Merged<'_>], test: &[Merged<'_>]) -> Vec<Table> {
    let mut tables = vec![
        scores(development),
        over_sets(development),
        emission(development),
        differences(development),
        movements(development),
        daily_life(development),
    ];
    tables.extend((!test.is_empty()).then(|| test_scores(test)));
    tables
}

/// Picture of the gestures recognised by the time since their onset, of people who have all classes: by the energy detector,
/// and by labels that use all rows of the look-ahead or none.
pub(super) fn picture(merged: &[Merged<'_>]) -> Option<String> {
    let curve = |own: &Merged<'_>| {
        let section = (None, Group::AllClasses);
        recognition::curve(own.short_name(), |ms| own.recognised_within(ms, section))
    };
    let is_system = |own: &&Merged<'_>| {
        own.look_ahead != LookAhead::SameInstant && ![CONSTANT, ENERGY].contains(&own.model)
    };
    let systems = merged.iter().filter(is_system).filter_map(curve);
    let energy = merged.iter().find(|own| own.model == ENERGY);
    recognition::svg(systems, energy.and_then(curve))
}

/// Merges the scores of every contender under each operating point and look-ahead, on some of the people. Without
/// look-ahead, only contenders without one are included.
pub(super) fn merged<'a, G: Iterator<Item = Option<OperatingPoint>>>(
    contenders: &'a [Contender],
    results: &'a [Vec<(Origin, JobScores)>],
    gates: impl Fn() -> G,
    people: fn(&JobScores) -> Option<&Vec<FoldScore>>,
) -> Vec<Merged<'a>> {
    let mut merged: Vec<Merged> = Vec::new();
    for (contender, own) in contenders.iter().zip(results) {
        for gate in gates() {
            let of = |look_ahead| {
                let scores = own.iter().flat_map(|(origin, scores)| {
                    let scores = people(scores).into_iter().flatten();
                    scores.map(|score| (*origin, score))
                });
                let merged = Merged::new(contender.name(), look_ahead, gate, scores);
                (!merged.is_empty()).then_some(merged)
            };
            let ahead = [LookAhead::AllRows, LookAhead::SameInstant].map(of);
            let looks_back = ahead.iter().any(Option::is_some);
            merged.extend(ahead.into_iter().flatten());
            if !looks_back {
                merged.extend(of(LookAhead::None));
            }
        }
    }
    merged
}
