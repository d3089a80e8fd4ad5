//! Tables of an evaluation.

use super::cell::{
    Cell, difference, estimate, latency, narrow_estimate, none, one_ms, quantile, rate, share, text,
};
use super::table::Table;
use crate::metric::offset::OffsetSummary;
use crate::results::{INTEGER, Results};
use crate::{ALL, CONSTANT, Difference, ENERGY, LookAhead, Measure, Score, Truth};

/// Measures whose differences are shown.
pub(super) const COMPARED: [Measure; 3] = [
    Measure::BalancedAccuracy,
    Measure::TransitionAccuracy,
    Measure::Recognition,
];

/// Transition accuracy with each buffer, the narrowest first.
const BY_BUFFER: [Measure; 3] = [
    Measure::TransitionAccuracyNarrow,
    Measure::TransitionAccuracyMiddle,
    Measure::TransitionAccuracy,
];

/// Tables of an evaluation: lag-compensated labels and the differences to the floors; labels as published; spliced
/// recordings; then the paper's measures.
#[must_use]
pub fn tables(results: &Results) -> Vec<Table> {
    let with = |truth: Truth| {
        let lines = results.published.iter();
        shown(
            lines.filter(move |score| score.truth == truth),
            results.aggregation,
        )
    };
    let (compensated, published) = (with(Truth::LagCompensated), with(Truth::Published));
    let spliced = shown(results.spliced.iter(), results.aggregation);
    let mut tables = vec![
        table(
            "Lag-compensated labels: moved to the onset of muscle activity",
            &compensated,
        ),
        differences(&compensated),
        table(
            "Labels as published: the times of the cues, as in the paper's evaluation",
            &published,
        ),
        table(
            "Spliced recordings of the same subjects, in random order and rhythm; lag-compensated labels",
            &spliced,
        ),
        paper(
            "The paper's measures: buffers, and offsets of the transitions followed; lag-compensated labels",
            &compensated,
        ),
        paper("The same with labels as published", &published),
    ];
    tables.retain(|table| !table.rows.is_empty());
    tables
}

/// Rows without look-ahead, and with that of the model file; people with all classes first, data set by data set.
fn shown<'a>(scores: impl Iterator<Item = &'a Score>, aggregation: LookAhead) -> Vec<&'a Score> {
    let mut shown: Vec<&Score> = scores
        .filter(|score| score.look_ahead == LookAhead::None || score.look_ahead == aggregation)
        .collect();
    sort(&mut shown);
    shown
}

/// Sorts rows: people with all classes, then those with fewer; data set by data set.
pub(super) fn sort(scores: &mut [&Score]) {
    scores.sort_by_key(|score| (score.people, score.data_set.clone()));
}

/// The scores of one model in 100 columns, a row a data set and group of people, and of the floors over all data sets:
/// lag-compensated labels, the model file's aggregation mode.
pub fn summary(results: &Results, model: &str) -> Table {
    let mut table = Table::new(
        "",
        [
            "recordings",
            "classes",
            "balanced",
            "transition",
            "events",
            "lat. ms",
            "false/min",
            "n",
        ],
    );
    let compensated = || {
        let scores = results.published.iter();
        scores.filter(|score| score.truth == Truth::LagCompensated)
    };
    let mut own: Vec<&Score> = compensated()
        .filter(|score| score.model == model && score.look_ahead == results.aggregation)
        .collect();
    // The last rows are over all recordings.
    own.sort_by_key(|score| score.data_set == ALL);
    for score in &own {
        table.push(narrow(score.data_set.clone(), score));
    }
    let last = own.last().map_or(ALL, |score| score.data_set.as_str());
    for (floor, name) in [(CONSTANT, "relax"), (ENERGY, "energy")] {
        let rows = compensated().filter(|score| score.model == floor && score.data_set == last);
        for score in rows {
            table.push(narrow(format!("{last}: {name}"), score));
        }
    }
    table
}

fn narrow(name: String, score: &Score) -> [String; 8] {
    let shown = |measure: Measure, interval| {
        let cell = narrow_estimate(measure.mean(score), interval);
        counted(cell, score, measure).shown
    };
    let median = score
        .events
        .latency
        .map(|latency| text(quantile(latency.median)));
    let rate = Measure::FalseActivations.mean(score);
    let rate = rate.map_or_else(none, |mean| text(format!("{:.1}", mean.mean)));
    [
        name,
        score.people_name(),
        shown(
            Measure::BalancedAccuracy,
            Measure::BalancedAccuracy.interval(score),
        ),
        shown(
            Measure::TransitionAccuracy,
            Measure::TransitionAccuracy.interval(score),
        ),
        shown(Measure::Recognition, None),
        counted(median.unwrap_or_else(none), score, Measure::Recognition).shown,
        counted(rate, score, Measure::FalseActivations).shown,
        score.widest().subjects.len().to_string(),
    ]
}

/// A cell with the number of people who have a value of `measure`, where that is not the row's.
pub(super) fn counted(cell: Cell, score: &Score, measure: Measure) -> Cell {
    let people = measure.mean(score).map_or(0, |mean| mean.n);
    cell.of_people(people, score.widest().subjects.len())
}

pub(super) fn table(caption: &str, scores: &[&Score]) -> Table {
    // Few data sets mark movements outside the vocabulary.
    let other = scores.iter().any(|s| s.events.other_activations.is_some());
    let mut header = vec![
        "recordings",
        "classes",
        "model",
        "look-ahead",
        "balanced",
        "TA",
        "recognised",
        "latency ms",
        "false/min",
    ];
    header.extend(other.then_some("other/min"));
    header.extend(["flicker/min", "raw", "subjects", "transitions", "gestures"]);
    let mut table = Table::new(caption, header);
    for score in scores {
        let shown = |cell, measure| counted(cell, score, measure).shown;
        let of = |measure: Measure| {
            let cell = estimate(measure.mean(score), measure.interval(score));
            shown(cell, measure)
        };
        let rate = |measure: Measure| shown(rate(measure.mean(score)), measure);
        let (widest, events) = (score.widest(), &score.events);
        let mut cells = heading(score);
        cells.extend([
            of(Measure::BalancedAccuracy),
            of(Measure::TransitionAccuracy),
            of(Measure::Recognition),
            shown(latency(events.latency), Measure::Recognition),
            rate(Measure::FalseActivations),
        ]);
        cells.extend(other.then(|| rate(Measure::OtherActivations)));
        cells.extend([
            rate(Measure::Flicker),
            shown(share(widest.raw_accuracy), Measure::RawAccuracy),
            widest.subjects.len().to_string(),
            widest.events.to_string(),
            events.gestures.to_string(),
        ]);
        table.push(cells);
    }
    table
}

/// Table of the model file against the floors, person by person; of a run without one, every model.
fn differences(scores: &[&Score]) -> Table {
    let header = ["recordings", "classes", "difference", "look-ahead"];
    let measures = COMPARED.map(Measure::name);
    let caption =
        "Differences to the floors, paired over subjects; mean [95 % interval] over n subjects";
    let mut table = Table::new(caption, header.into_iter().chain(measures));
    let is_floor = |score: &Score| [CONSTANT, ENERGY].contains(&score.model.as_str());
    let device = scores.iter().any(|score| score.model == INTEGER);
    let models = scores
        .iter()
        .filter(|score| !is_floor(score) && (score.model == INTEGER || !device));
    for score in models {
        let floors = scores
            .iter()
            .filter(|floor| is_floor(floor) && floor.same_people(score));
        for floor in floors {
            let [data_set, classes, model, look_ahead] = heading_of(score);
            let difference = |measure| difference(Difference::of(measure, score, floor)).shown;
            let pair = format!("{model} - {}", floor.model);
            let cells = [data_set, classes, pair, look_ahead];
            table.push(cells.into_iter().chain(COMPARED.map(difference)));
        }
    }
    table
}

fn paper(caption: &str, scores: &[&Score]) -> Table {
    let header = [
        "recordings",
        "classes",
        "model",
        "look-ahead",
        "TA 60",
        "TA 120",
        "TA 200",
        "offset ms",
        "median",
        "raw",
        "subjects",
        "transitions",
    ];
    let mut table = Table::new(caption, header);
    for score in scores {
        let widest = score.widest();
        let shown = |cell: Cell, measure| counted(cell, score, measure).shown;
        let accuracy = |measure: Measure| shown(share(measure.mean(score)), measure);
        let followed = widest.subjects.iter().filter(|own| own.offset.is_some());
        let followed = followed.count();
        let offset = |of: fn(OffsetSummary) -> f64| {
            let cell = one_ms(widest.offset.map(of));
            cell.of_people(followed, widest.subjects.len()).shown
        };
        let mut cells = heading(score);
        cells.extend(BY_BUFFER.map(accuracy));
        cells.extend([
            offset(|offset| offset.signed.mean),
            offset(|offset| offset.signed_median),
            shown(share(widest.raw_accuracy), Measure::RawAccuracy),
            widest.subjects.len().to_string(),
            widest.events.to_string(),
        ]);
        table.push(cells);
    }
    table
}

fn heading(score: &Score) -> Vec<String> {
    heading_of(score).to_vec()
}

fn heading_of(score: &Score) -> [String; 4] {
    let look_ahead = score.look_ahead.name().to_owned();
    [
        score.data_set.clone(),
        score.people_name(),
        score.model.clone(),
        look_ahead,
    ]
}

#[cfg(test)]
mod tests {
    use shared::intent::{Intent, Vocabulary};
    use std::collections::BTreeMap;

    use shared::model::LookBackLogits;

    use super::*;
    use crate::{Candidate, EnergyDetector, Trial, constant, score_all};
    use recordings::DataSet;

    /// One recording of a person: 2 s of each class in turn.
    fn trial(who: &str, classes: &[usize]) -> Trial {
        let labels = classes
            .iter()
            .flat_map(|&class| std::iter::repeat_n(Intent::from_class(class), 400));
        let truth: Vec<Option<Intent>> = labels.collect();
        Trial {
            data_set: DataSet::Synthetic,
            subject: format!("synthetic/{who}"),
            name: "r".to_owned(),
            raw: Vec::new(),
            emg: truth
                .iter()
                .map(|&label| [if label == Some(Intent::Relax) { 1 } else { 20 }; 8])
                .collect(),
            normalized: Vec::new(),
            published: Some(truth.clone()),
            lag_compensated: truth,
            other_movement: Vec::new(),
        }
    }

    /// A model that sees each change of these recordings after 100 ms, and the floors.
    fn results_of(trials: &[Trial]) -> Results {
        let logits = trials.iter().map(|trial| {
            let rows = |patch: usize| {
                let mut rows = LookBackLogits::default();
                for (back, row) in rows.iter_mut().enumerate() {
                    let at = (patch * 10).saturating_sub(back * 10 + 20);
                    row[trial.lag_compensated[at].map_or(0, Intent::class)] = 1.0;
                }
                rows
            };
            (0..trial.emg.len() / 10).map(rows).collect()
        });
        let model = Candidate {
            name: INTEGER.to_owned(),
            looks_back: true,
            logits: logits.collect(),
            entry_margins: [0.0; 6],
            other_margin: None,
        };
        let detector = EnergyDetector::fit(trials).unwrap();
        let candidates = [model, constant(trials), detector.candidate(trials)];
        let scores =
            |truths: &[Truth]| score_all(&candidates, trials, Vocabulary::Three, truths).unwrap();
        Results {
            held_out: Vec::new(),
            aggregation: LookAhead::SameInstant,
            gestures: BTreeMap::new(),
            published: scores(&[Truth::Published, Truth::LagCompensated]),
            spliced: scores(&[Truth::LagCompensated]),
        }
    }

    /// Two people, who close their hand twice, and a model that sees each change after 100 ms.
    fn results() -> Results {
        results_of(&["a", "b"].map(|who| trial(who, &[0, 2, 0, 2, 0])))
    }

    /// Two people of three classes with onsets, one with holds alone, and one who never opens the hand.
    fn four_people() -> Results {
        let mut trials = vec![
            trial("a", &[0, 1, 0, 2, 0]),
            trial("b", &[0, 2, 0, 1, 0]),
            trial("d", &[0, 2, 0, 2, 0]),
        ];
        trials.extend([0, 1, 2].map(|class| trial("c", &[class])));
        results_of(&trials)
    }

    #[test]
    fn every_column_has_its_own_number_of_people_and_two_class_people_stand_apart() {
        for table in tables(&four_people()) {
            let column = |name: &str| table.header.iter().position(|own| own == name);
            let (classes, model) = (column("classes").unwrap(), column("model"));
            let Some(model) = model else {
                // Differences say their number of people in each cell.
                let found: Vec<&str> = table.rows.iter().map(|row| &row[classes][..]).collect();
                assert!(
                    found.contains(&"all 3") && found.contains(&"fewer"),
                    "{table:?}"
                );
                continue;
            };
            for name in [INTEGER, CONSTANT, ENERGY] {
                let rows: Vec<_> = table.rows.iter().filter(|row| row[model] == name).collect();
                let all = rows.iter().find(|row| row[classes] == "all 3").unwrap();
                let fewer = rows.iter().find(|row| row[classes] == "fewer").unwrap();
                let people = column("subjects").unwrap();
                let spliced = table.caption.starts_with("Spliced");
                assert_eq!(
                    (&all[people][..], &fewer[people][..]),
                    ("3", "1"),
                    "{table:?}"
                );
                for (name, own) in [
                    ("TA", "n 2"),
                    ("TA 200", "n 2"),
                    ("recognised", "n 2"),
                    ("latency ms", "n 2"),
                ] {
                    if let Some(at) = column(name) {
                        assert!(all[at].ends_with(own), "{name}: {all:?}, {spliced}");
                        assert!(!fewer[at].contains("n 1"), "{name}: {fewer:?}");
                    }
                }
                if let Some(at) = column("balanced") {
                    assert!(!all[at].contains('n'), "{all:?}");
                }
            }
        }
        let table = summary(&four_people(), INTEGER);
        let rows: Vec<_> = table
            .rows
            .iter()
            .filter(|row| row[0] == "synthetic")
            .collect();
        assert_eq!(
            rows.iter().map(|row| &row[1][..]).collect::<Vec<_>>(),
            ["all 3", "fewer"]
        );
        assert!(
            rows[0][3].ends_with("n 2") && rows[0].last().unwrap() == "3",
            "{rows:?}"
        );
    }

    #[test]
    fn every_table_of_scores_has_its_floors_and_the_differences_to_them() {
        let tables = tables(&results());
        let found: Vec<Vec<&str>> = tables
            .iter()
            .map(|table| table.rows.iter().map(|row| row[2].as_str()).collect())
            .collect();
        // Rows without look-ahead and with the model file's.
        let scores = vec![INTEGER, INTEGER, CONSTANT, ENERGY];
        let constant = format!("{INTEGER} - {CONSTANT}");
        let energy = format!("{INTEGER} - {ENERGY}");
        let differences = vec![constant.as_str(), &energy, &constant, &energy];
        let expected = [
            scores.clone(),
            differences,
            scores.clone(),
            scores.clone(),
            scores.clone(),
            scores,
        ];
        assert_eq!(found, expected);
        let cells = |table: usize, row: usize| tables[table].rows[row][4..].to_vec();
        let floor = &cells(0, 2);
        // Relax and close: the recall of relax is 1.
        assert_eq!(floor[0], "0.500");
        assert_eq!(floor[3..6], ["missed / missed", "0.0 (0.0)", "0.0 (0.0)"]);
        assert_eq!(floor[2], "0.000");
        assert_eq!(cells(0, 1)[2], "1.000");
        assert_eq!(cells(1, 2)[2], "+1.000 n 2, no difference shown");
    }

    #[test]
    fn the_summary_ends_with_the_floors() {
        let table = summary(&results(), INTEGER);
        let names: Vec<&str> = table.rows.iter().map(|row| row[0].as_str()).collect();
        assert_eq!(
            names,
            ["synthetic", "synthetic: relax", "synthetic: energy"]
        );
    }
}
