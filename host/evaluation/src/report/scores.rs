//! Tables of scores and of differences.

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

/// Measures of a person before and after tuning, with their decimals.
const TUNED: [(Measure, usize); 7] = [
    (Measure::BalancedAccuracy, 3),
    (Measure::TransitionAccuracy, 3),
    (Measure::Recognition, 3),
    (Measure::FalseActivations, 1),
    (Measure::OtherActivations, 1),
    (Measure::Raised, 2),
    (Measure::Flicker, 1),
];

/// Columns that name a row.
const HEADING: [&str; 4] = ["recordings", "classes", "model", "look-ahead"];

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
        floor_differences(&compensated),
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
        .filter(|score| [LookAhead::None, aggregation].contains(&score.look_ahead))
        .collect();
    sort(&mut shown);
    shown
}

/// Sorts rows: people with all classes, then those with fewer; data set by data set.
pub(super) fn sort(scores: &mut [&Score]) {
    scores.sort_by_key(|score| (score.people, score.data_set.clone()));
}

/// Whether a row is a floor's, which needs no model.
pub(super) fn is_floor(score: &Score) -> bool {
    [CONSTANT, ENERGY].contains(&score.model.as_str())
}

/// The scores of one model in 100 columns, a row a data set and group of people, and of the floors over all data sets:
/// lag-compensated labels, the model file's aggregation mode.
pub fn summary(results: &Results, model: &str) -> Table {
    let header = [
        "recordings",
        "classes",
        "balanced",
        "transition",
        "events",
        "lat. ms",
        "false/min",
        "n",
    ];
    let mut table = Table::new("", header);
    let compensated = || {
        results
            .published
            .iter()
            .filter(|score| score.truth == Truth::LagCompensated)
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
        rows.for_each(|score| table.push(narrow(format!("{last}: {name}"), score)));
    }
    table
}

fn narrow(name: String, score: &Score) -> [String; 8] {
    let shown =
        |cell: Option<Cell>, measure| counted(cell.unwrap_or_else(none), score, measure).shown;
    let accuracy = |measure: Measure, interval| {
        shown(
            Some(narrow_estimate(measure.mean(score), interval)),
            measure,
        )
    };
    let with_interval = |measure: Measure| accuracy(measure, measure.interval(score));
    let median = score
        .events
        .latency
        .map(|latency| text(quantile(latency.median)));
    let rate = Measure::FalseActivations.mean(score);
    [
        name,
        score.people_name(),
        with_interval(Measure::BalancedAccuracy),
        with_interval(Measure::TransitionAccuracy),
        accuracy(Measure::Recognition, None),
        shown(median, Measure::Recognition),
        shown(
            rate.map(|mean| text(format!("{:.1}", mean.mean))),
            Measure::FalseActivations,
        ),
        score.widest().subjects.len().to_string(),
    ]
}

/// A cell with the number of people who have a value of `measure`, where that is not the row's.
pub(super) fn counted(cell: Cell, score: &Score, measure: Measure) -> Cell {
    let people = measure.mean(score).map_or(0, |mean| mean.n);
    cell.of_people(people, score.widest().subjects.len())
}

/// Table with a row for each score.
pub(super) fn table(caption: &str, scores: &[&Score]) -> Table {
    // Few data sets mark movements outside the vocabulary.
    let other = scores.iter().any(|s| s.events.other_activations.is_some());
    let mut header = HEADING.to_vec();
    header.extend(["balanced", "TA", "recognised", "latency ms", "false/min"]);
    header.extend(other.then_some("other/min"));
    header.extend(["flicker/min", "raw", "subjects", "transitions", "gestures"]);
    let mut table = Table::new(caption, header);
    for score in scores {
        let shown = |cell, measure| counted(cell, score, measure).shown;
        let of = |measure: Measure| {
            shown(
                estimate(measure.mean(score), measure.interval(score)),
                measure,
            )
        };
        let rate = |measure: Measure| shown(rate(measure.mean(score)), measure);
        let (widest, events) = (score.widest(), &score.events);
        let mut cells = heading(score).to_vec();
        cells.extend(COMPARED.map(of));
        cells.extend([
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
fn floor_differences(scores: &[&Score]) -> Table {
    let device = scores.iter().any(|score| score.model == INTEGER);
    let models = scores
        .iter()
        .filter(|score| !is_floor(score) && (score.model == INTEGER || !device));
    let pairs = models.flat_map(|score| {
        let floors = scores
            .iter()
            .filter(|floor| is_floor(floor) && floor.same_people(score));
        floors.map(|floor| (*score, *floor))
    });
    let caption =
        "Differences to the floors, paired over subjects; mean [95 % interval] over n subjects";
    differences(caption, true, pairs)
}

/// Table with a row for each pair of rows: the first less the second, paired over people.
pub(super) fn differences<'s>(
    caption: &str,
    look_ahead: bool,
    pairs: impl IntoIterator<Item = (&'s Score, &'s Score)>,
) -> Table {
    let mut header = vec!["recordings", "classes", "difference"];
    header.extend(look_ahead.then_some("look-ahead"));
    let mut table = Table::new(
        caption,
        header.into_iter().chain(COMPARED.map(Measure::name)),
    );
    for (own, other) in pairs {
        let [data_set, classes, model, ahead] = heading(own);
        let mut cells = vec![data_set, classes, format!("{model} - {}", other.model)];
        cells.extend(look_ahead.then_some(ahead));
        cells.extend(COMPARED.map(|measure| difference(Difference::of(measure, own, other)).shown));
        table.push(cells);
    }
    table
}

fn paper(caption: &str, scores: &[&Score]) -> Table {
    let measures = [
        "TA 60",
        "TA 120",
        "TA 200",
        "offset ms",
        "median",
        "raw",
        "subjects",
        "transitions",
    ];
    let mut table = Table::new(caption, HEADING.into_iter().chain(measures));
    for score in scores {
        let widest = score.widest();
        let shown = |cell: Cell, measure| counted(cell, score, measure).shown;
        let followed = widest
            .subjects
            .iter()
            .filter(|own| own.offset.is_some())
            .count();
        let offset = |of: fn(OffsetSummary) -> f64| {
            let cell = one_ms(widest.offset.map(of));
            cell.of_people(followed, widest.subjects.len()).shown
        };
        let mut cells = heading(score).to_vec();
        cells.extend(BY_BUFFER.map(|measure| shown(share(measure.mean(score)), measure)));
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

/// Cells of the columns [`HEADING`].
fn heading(score: &Score) -> [String; 4] {
    let look_ahead = score.look_ahead.name().to_owned();
    [
        score.data_set.clone(),
        score.people_name(),
        score.model.clone(),
        look_ahead,
    ]
}

/// Table with a row for each model, before and after tuning on a person: the measures of the part held back.
#[must_use]
pub fn tuned(caption: &str, scores: &[Score]) -> Table {
    let header = ["model", "gestures"]
        .into_iter()
        .chain(TUNED.map(|(measure, _)| measure.name()));
    let mut table = Table::new(caption, header);
    for score in scores {
        let value = |(measure, decimals): (Measure, usize)| {
            measure
                .mean(score)
                .map_or_else(String::new, |own| format!("{:.decimals$}", own.mean))
        };
        let start = [score.model.clone(), score.events.gestures.to_string()];
        table.push(start.into_iter().chain(TUNED.map(value)));
    }
    table
}
