//! Tables of a cross-validation.

use std::collections::BTreeSet;

use evaluation::metric::event::activation::DailyUse;
use evaluation::report::Table;
use evaluation::report::cell;
use evaluation::{Difference, Group, LookAhead, Measure};
use recordings::statistics::{Interval, MeanSd};

use super::merged::{Merged, Section};

/// Measures whose intervals are shown.
const SHARES: [Measure; 4] = [
    Measure::BalancedAccuracy,
    Measure::TransitionAccuracy,
    Measure::Recognition,
    Measure::Decided,
];
const RATES: [Measure; 4] = [
    Measure::FalseActivations,
    Measure::OtherActivations,
    Measure::DailyActivations,
    Measure::Flicker,
];
/// Measures of labels at their emission times, beside the latency.
const EMISSION: [Measure; 7] = [
    Measure::BalancedAccuracyEmitted,
    Measure::TransitionAccuracyEmitted,
    Measure::Recognition,
    Measure::Within100,
    Measure::Within150,
    Measure::Within200,
    Measure::Within300,
];
/// Measures whose means over data sets are shown.
const OVER_SETS: [Measure; 6] = [
    Measure::BalancedAccuracyEmitted,
    Measure::BalancedAccuracy,
    Measure::TransitionAccuracyEmitted,
    Measure::Recognition,
    Measure::Raised,
    Measure::FalseActivations,
];
/// Measures that contenders are compared by.
const COMPARED: [Measure; 12] = [
    Measure::BalancedAccuracy,
    Measure::BalancedAccuracyEmitted,
    Measure::TransitionAccuracy,
    Measure::TransitionAccuracyMiddle,
    Measure::TransitionAccuracyNarrow,
    Measure::TransitionAccuracyEmitted,
    Measure::Recognition,
    Measure::Within200,
    Measure::FalseActivations,
    Measure::OtherActivations,
    Measure::Raised,
    Measure::DailyActivations,
];

const DEVELOPMENT: &str = "Held-out people: mean over people [95 % interval] of each person's mean over seeds; n: people of a \
    column, where the row has more";
const TEST: &str = "Test people, for a release alone: mean over people [95 % interval] of each person's mean over the students \
    of all folds and seeds, none of which has seen them";

/// Table of the scores of held-out people, over all and by data set: a row for each contender and aggregation mode.
pub(crate) fn scores(merged: &[Merged<'_>]) -> Table {
    scores_table(DEVELOPMENT, merged)
}

/// Table of the scores of the test people, with the rows of [`scores`].
pub(crate) fn test_scores(merged: &[Merged<'_>]) -> Table {
    scores_table(TEST, merged)
}

fn scores_table(caption: &str, merged: &[Merged<'_>]) -> Table {
    let measures = SHARES.map(Measure::name).into_iter();
    let header = ["recordings", "classes", "model (look-ahead)"]
        .into_iter()
        .chain(measures)
        .chain(["latency ms", "release ms"])
        .chain(RATES.map(Measure::name))
        .chain([Measure::Raised, Measure::RawAccuracy].map(Measure::name))
        .chain(["people"]);
    let mut table = Table::new(caption, header);
    for section in sections(merged) {
        for own in merged {
            let people = own.people(section).len();
            if people == 0 {
                continue;
            }
            let numbers = |measure| own.numbers(measure, section);
            let share = |measure| {
                let numbers = numbers(measure);
                let cell = cell::estimate(MeanSd::of(&numbers), Interval::of_mean(&numbers));
                cell::of_people(cell, numbers.len(), people)
            };
            let one = |measure, digits: usize| {
                let mean = MeanSd::of(&numbers(measure));
                let cell = mean.map_or_else(cell::none, |of| format!("{:.digits$}", of.mean));
                cell::of_people(cell, mean.map_or(0, |of| of.n), people)
            };
            let latency = cell::latency(own.latency(section));
            let (release, with_releases) = own.release(section);
            let release = cell::of_people(cell::latency(release), with_releases, people);
            let with_gestures = numbers(Measure::Recognition).len();
            table.push(
                names(section, own)
                    .into_iter()
                    .chain([own.name()])
                    .chain(SHARES.map(share))
                    .chain([cell::of_people(latency, with_gestures, people), release])
                    .chain(RATES.map(|measure| one(measure, 1)))
                    .chain([
                        one(Measure::Raised, 2),
                        one(Measure::RawAccuracy, 3),
                        people.to_string(),
                    ]),
            );
        }
    }
    table
}

/// Table of the means over data sets, each of which counts once, however many people it has: a row for each contender and
/// aggregation mode. With the lowest value of a set.
pub(crate) fn over_sets(merged: &[Merged<'_>]) -> Table {
    let caption = "Each data set counts once: mean over sets [95 % interval over sets] of a set's mean over its held-out people; \
        lowest of a set; n: sets";
    let header = ["classes", "model (look-ahead)"].into_iter();
    let mut table = Table::new(caption, header.chain(OVER_SETS.map(Measure::name)));
    let all = sections(merged);
    for group in Group::ALL {
        let sets = || {
            all.iter()
                .filter(|(set, own)| set.is_some() && *own == group)
        };
        for own in merged.iter().filter(|_| sets().next().is_some()) {
            let cells = OVER_SETS.map(|measure| {
                let means = sets()
                    .filter_map(|section| Some(MeanSd::of(&own.numbers(measure, *section))?.mean));
                let means: Vec<f64> = means.collect();
                let cell = cell::estimate(MeanSd::of(&means), Interval::of_mean(&means));
                let lowest = means.iter().copied().fold(f64::INFINITY, f64::min);
                match means.len() {
                    0 => cell,
                    n => format!("{cell}; {lowest:.3}; n {n}"),
                }
            });
            let start = [group.name(own.classes()), own.name()];
            table.push(start.into_iter().chain(cells));
        }
    }
    table
}

/// Table of the labels at their emission times, with the rows of [`scores`] whose people make gestures.
pub(crate) fn emission(merged: &[Merged<'_>]) -> Table {
    let caption = "Held-out people, labels when they are emitted: mean over people [95 % interval]; latency: median / 90 % of \
        all gestures";
    let header = ["recordings", "classes", "model (look-ahead)"].into_iter();
    let header = header.chain(EMISSION.map(Measure::name));
    let mut table = Table::new(caption, header.chain(["latency ms", "people"]));
    for section in sections(merged) {
        for own in merged {
            let people = own.values(Measure::Recognition, section).len();
            if people == 0 {
                continue;
            }
            let shares = EMISSION.map(|measure| {
                let numbers = own.numbers(measure, section);
                let cell = cell::estimate(MeanSd::of(&numbers), Interval::of_mean(&numbers));
                cell::of_people(cell, numbers.len(), people)
            });
            table.push(
                names(section, own)
                    .into_iter()
                    .chain([own.name()])
                    .chain(shares)
                    .chain([cell::latency(own.latency(section)), people.to_string()]),
            );
        }
    }
    table
}

/// Table of differences, paired over people: every row of [`scores`] against the first one with its aggregation mode;
/// without look-ahead, against the first of all.
pub(crate) fn differences(merged: &[Merged<'_>]) -> Table {
    let caption = "Differences, paired over people; mean [95 % interval] over n people";
    let start = ["recordings", "classes", "difference"].into_iter();
    let mut table = Table::new(caption, start.chain(COMPARED.map(Measure::name)));
    for section in sections(merged) {
        for own in merged {
            let Some(first) = merged
                .iter()
                .find(|first| [first.look_ahead, LookAhead::None].contains(&own.look_ahead))
                .filter(|first| first.name() != own.name())
            else {
                continue;
            };
            let paired = |measure: Measure| {
                let (values, others) =
                    (own.values(measure, section), first.values(measure, section));
                cell::difference(Difference::paired(&values, &others))
            };
            let pair = [format!("{} - {}", own.name(), first.name())];
            let start = names(section, own).into_iter().chain(pair);
            table.push(start.chain(COMPARED.map(paired)));
        }
    }
    table
}

/// Table of movements outside the vocabulary, a row for each kind: their number, and the share that raises a label, for
/// each contender and aggregation mode.
pub(crate) fn movements(merged: &[Merged<'_>]) -> Table {
    let caption = "Movements outside the vocabulary, of all people, whatever their classes, and seeds: share in which a gesture's \
        label begins";
    let by_kind: Vec<_> = merged.iter().map(Merged::raised).collect();
    let names = merged.iter().map(Merged::name);
    let header = ["movement".to_owned(), "number".to_owned()];
    let mut table = Table::new(caption, header.into_iter().chain(names));
    let kinds: BTreeSet<&str> = by_kind.iter().flat_map(|own| own.keys().copied()).collect();
    for kind in kinds {
        let number = by_kind.iter().find_map(|own| Some(own.get(kind)?.all));
        let shares = by_kind.iter().map(|own| {
            let share = own.get(kind).and_then(|of| of.share());
            share.map_or_else(cell::none, |share| format!("{share:.2}"))
        });
        let names = [kind.to_owned(), number.unwrap_or(0).to_string()];
        table.push(names.into_iter().chain(shares));
    }
    table
}

/// Table of daily life, a row for each kind: minutes, and for each contender and aggregation mode the activations a minute
/// and the share of the time with an active label.
pub(crate) fn daily_life(merged: &[Merged<'_>]) -> Table {
    let caption = "Daily life of all people and seeds: activations a minute; share of the time with a gesture's label";
    let by_kind: Vec<_> = merged.iter().map(Merged::daily_life).collect();
    let header = ["kind".to_owned(), "minutes".to_owned()].into_iter();
    let mut table = Table::new(caption, header.chain(merged.iter().map(Merged::name)));
    let kinds: BTreeSet<&str> = by_kind.iter().flat_map(|own| own.keys().copied()).collect();
    for kind in kinds {
        let mut all = by_kind.iter().filter_map(|own| own.get(kind));
        let minutes = all.next().map_or(0.0, |own| own.activations.seconds / 60.0);
        let cells = by_kind.iter().map(|own| {
            let rate = |own: &DailyUse| Some((own.activations.per_minute()?, own.active_share()));
            let rate = own.get(kind).and_then(rate);
            rate.map_or_else(cell::none, |(rate, share)| format!("{rate:.1}; {share:.2}"))
        });
        let names = [kind.to_owned(), format!("{minutes:.0}")];
        table.push(names.into_iter().chain(cells));
    }
    table
}

/// Table for CSV with a row for each person and job: those held out (`development`), then the test people (`test`).
pub(crate) fn people(development: &[Merged<'_>], test: &[Merged<'_>]) -> Table {
    let measures = SHARES.into_iter().chain(RATES).chain([
        Measure::Raised,
        Measure::DailyActive,
        Measure::RawAccuracy,
        Measure::TransitionAccuracyMiddle,
        Measure::TransitionAccuracyNarrow,
    ]);
    let measures: Vec<Measure> = measures.collect();
    let names = measures.iter().map(|measure| measure.name());
    let header = [
        "model",
        "look-ahead",
        "entry margin",
        "seed",
        "fold",
        "people",
        "subject",
        "classes",
    ]
    .into_iter()
    .chain(names);
    let mut table = Table::new("", header);
    let development = development.iter().map(|own| ("development", own));
    let test = test.iter().map(|own| ("test", own));
    for (of, own) in development.chain(test) {
        for (origin, score) in own.scores() {
            for person in &score.widest().subjects {
                let value = |measure: &Measure| {
                    let values = measure.values(score);
                    let found = values.iter().find(|(name, _)| *name == person.subject);
                    found.map_or_else(String::new, |(_, value)| format!("{value:.4}"))
                };
                let names = [
                    own.model.to_owned(),
                    own.look_ahead.name().to_owned(),
                    own.gate.map_or_else(String::new, |gate| gate.to_string()),
                    origin.seed.to_string(),
                    origin.fold.to_string(),
                    of.to_owned(),
                    person.subject.clone(),
                    person.classes.to_string(),
                ];
                table.push(names.into_iter().chain(measures.iter().map(value)));
            }
        }
    }
    table
}

/// Names of a section in tables: data set and group.
fn names((data_set, group): Section<'_>, of: &Merged<'_>) -> [String; 2] {
    [
        data_set.unwrap_or("all").to_owned(),
        group.name(of.classes()),
    ]
}

/// Sections of a table: all people, then each data set; first people who have all classes, then those with fewer.
fn sections<'a>(merged: &[Merged<'a>]) -> Vec<Section<'a>> {
    let mut sets: Vec<Option<&str>> = merged
        .iter()
        .flat_map(Merged::data_sets)
        .map(Some)
        .chain([None])
        .collect();
    sets.sort_unstable();
    sets.dedup();
    let of = |group| sets.iter().map(move |&set| (set, group));
    let sections = Group::ALL.into_iter().flat_map(of);
    let has_people = |section: &Section<'_>| {
        let mut merged = merged.iter();
        merged.any(|own| !own.people(*section).is_empty())
    };
    sections.filter(has_people).collect()
}

#[cfg(test)]
mod tests {
    use evaluation::{CONSTANT, EvaluatedRecording, constant, score};
    use shared::intent::Vocabulary;

    use super::*;
    use crate::cross_validation::{FoldScore, Origin};

    /// Scores of always saying relax, of one fold: two people with onsets, one with only holds, one who never opens the
    /// hand.
    fn fold() -> Vec<FoldScore> {
        let mut recordings = vec![
            EvaluatedRecording::made_up("x/a", &[0, 1, 0, 2, 0]),
            EvaluatedRecording::made_up("x/b", &[0, 2, 0, 1, 0]),
            EvaluatedRecording::made_up("y/d", &[0, 2, 0, 2, 0]),
        ];
        recordings.extend([0, 1, 2].map(|class| EvaluatedRecording::made_up("x/c", &[class])));
        let (constant, three) = (constant(&recordings), Vocabulary::Three);
        let scores = score(&constant, &recordings, three, LookAhead::None).unwrap();
        scores
            .into_iter()
            .map(|score| FoldScore { gate: None, score })
            .collect()
    }

    #[test]
    fn every_column_has_its_own_number_of_people_and_two_class_people_stand_apart() {
        let fold = fold();
        let origin = Origin { seed: 1, fold: 1 };
        let rows = fold.iter().map(|own| (origin, own));
        let merged = [Merged::new(CONSTANT, LookAhead::None, None, rows)];
        let table = scores(&merged);
        let column = |name: &str| table.header.iter().position(|own| own == name).unwrap();
        let (set, classes) = (column("recordings"), column("classes"));
        let row = |wanted: [&str; 2]| {
            let mut rows = table.rows.iter();
            rows.find(|row| [&row[set][..], &row[classes]] == wanted)
                .unwrap()
        };
        let all = row(["all", "all 3"]);
        assert_eq!(all[column("people")], "3");
        assert_eq!(all[column("balanced")], "0.333");
        assert_eq!(all[column("TA")], "0.000 n 2");
        assert_eq!(all[column("recognised")], "0.000 n 2");
        assert_eq!(all[column("latency ms")], ">50 % missed n 2");
        let fewer = row(["all", "fewer"]);
        assert_eq!(
            [&fewer[column("balanced")], &fewer[column("people")]],
            ["0.500", "1"]
        );
        assert_eq!(fewer[column("TA")], "0.000");
        // A data set without such people has no such row.
        assert_eq!(row(["x", "all 3"])[column("people")], "3");
        assert_eq!(row(["y", "fewer"])[column("people")], "1");
        assert_eq!(table.rows.len(), 4);
    }
}
