//! Tables of scores and of differences.

use super::cell::{
    difference, estimate, latency, median, narrow_estimate, narrow_median, none, of_people, rate,
    share,
};
use super::row::{Row, sort};
use super::table::Table;
use crate::Measure::{self, *};
use crate::results::Results;
use crate::{ALL, Difference, LookAhead, Score, System, Truth};

/// Measures whose differences are shown.
pub(super) const COMPARED: [Measure; 3] = [BalancedAccuracy, TransitionAccuracy, Recognition];

/// Measures of a person before and after tuning, with their decimals.
const TUNED: [(Measure, usize); 7] = [
    (BalancedAccuracy, 3),
    (TransitionAccuracy, 3),
    (Recognition, 3),
    (FalseActivations, 1),
    (OtherActivations, 1),
    (Raised, 2),
    (Flicker, 1),
];

/// Column of a table of scores: its name, and its cells.
type Column = (&'static str, Cell);

#[derive(Clone, Copy)]
enum Cell {
    /// Text about the row.
    Text(fn(&Row<'_>) -> String),
    /// A measure, and its format.
    Of(Measure, fn(&Score, Measure) -> String),
}
use Cell::{Of, Text};

impl Cell {
    fn of(self, row: &Row<'_>) -> String {
        match self {
            Text(text) => text(row),
            Of(measure, show) => counted(show(row, measure), row, measure),
        }
    }
}

const RECORDINGS: Column = ("recordings", Text(|own| own.data_set.clone()));
const CLASSES: Column = ("classes", Text(|own| own.people_name()));
const MODEL: Column = ("model", Text(|own| own.name.clone()));
const LOOK_AHEAD: Column = ("look-ahead", Text(|own| own.look_ahead.name().to_owned()));
const LATENCY: Column = (
    "latency ms",
    Of(Recognition, |own, _| latency(own.events.latency)),
);
const RELEASE: Column = ("release ms", Text(|own| latency(own.events.release)));
const OTHER: Column = ("other/min", Of(OtherActivations, mean_rate));
const RAISED: Column = (Raised.name(), Of(Raised, mean_share));
const DAILY: Column = (DailyActivations.name(), Of(DailyActivations, mean_rate));
const SUBJECTS: Column = ("subjects", Text(|own| people(own).to_string()));

const SCORES: [Column; 20] = [
    RECORDINGS,
    CLASSES,
    MODEL,
    LOOK_AHEAD,
    ("balanced", Of(BalancedAccuracy, estimated)),
    ("TA", Of(TransitionAccuracy, estimated)),
    ("recognised", Of(Recognition, estimated)),
    (Decided.name(), Of(Decided, estimated)),
    LATENCY,
    RELEASE,
    ("false/min", Of(FalseActivations, mean_rate)),
    (RestKept.name(), Of(RestKept, mean_share)),
    OTHER,
    RAISED,
    DAILY,
    ("flicker/min", Of(Flicker, mean_rate)),
    ("raw", Of(RawAccuracy, mean_share)),
    SUBJECTS,
    ("transitions", Text(|own| own.widest().events.to_string())),
    ("gestures", Text(|own| own.events.gestures.to_string())),
];

/// Columns of what a user of the device gets.
const EMITTED: [Column; 13] = [
    RECORDINGS,
    CLASSES,
    MODEL,
    LOOK_AHEAD,
    ("balanced", Of(BalancedAccuracyEmitted, estimated)),
    ("TA", Of(TransitionAccuracyEmitted, estimated)),
    (Within100.name(), Of(Within100, mean_share)),
    (Within150.name(), Of(Within150, mean_share)),
    (Within200.name(), Of(Within200, mean_share)),
    (Within300.name(), Of(Within300, mean_share)),
    LATENCY,
    RELEASE,
    SUBJECTS,
];

const BALANCED: Column = ("balanced", Of(BalancedAccuracy, narrow_interval));
const EVENTS: Column = ("events", Of(Recognition, narrow_share));
const FALSE: Column = ("false/min", Of(FalseActivations, narrow_rate));
const PEOPLE: Column = ("n", SUBJECTS.1);

/// Columns of a summary of one model, 100 letters together.
const SUMMARY: [Column; 8] = [
    RECORDINGS,
    CLASSES,
    BALANCED,
    ("transition", Of(TransitionAccuracy, narrow_interval)),
    EVENTS,
    (
        "lat. ms",
        Of(Recognition, |own, _| {
            own.events.latency.map_or_else(none, median)
        }),
    ),
    FALSE,
    PEOPLE,
];

/// Columns of several models, 100 letters together.
const NARROW: [Column; 11] = [
    RECORDINGS,
    CLASSES,
    MODEL,
    PEOPLE,
    BALANCED,
    EVENTS,
    (Decided.name(), Of(Decided, narrow_share)),
    (
        "lat. ms",
        Of(Recognition, |own, _| {
            own.events.latency.map_or_else(none, narrow_median)
        }),
    ),
    ("TA", Of(TransitionAccuracy, narrow_share)),
    FALSE,
    (
        "off ms",
        Text(|own| own.events.release.map_or_else(none, median)),
    ),
];

fn people(score: &Score) -> usize {
    score.widest().subjects.len()
}

/// A cell with the number of people who have a value of `measure`, where that is not the row's.
pub(super) fn counted(cell: String, score: &Score, measure: Measure) -> String {
    let with_value = measure.mean(score).map_or(0, |mean| mean.n);
    of_people(cell, with_value, people(score))
}

fn mean_share(score: &Score, measure: Measure) -> String {
    share(measure.mean(score))
}

fn mean_rate(score: &Score, measure: Measure) -> String {
    rate(measure.mean(score))
}

pub(super) fn estimated(score: &Score, measure: Measure) -> String {
    estimate(measure.mean(score), measure.interval(score))
}

fn narrow_interval(score: &Score, measure: Measure) -> String {
    narrow_estimate(measure.mean(score), measure.interval(score))
}

fn narrow_share(score: &Score, measure: Measure) -> String {
    narrow_estimate(measure.mean(score), None)
}

fn narrow_rate(score: &Score, measure: Measure) -> String {
    let mean = measure.mean(score);
    mean.map_or_else(none, |mean| format!("{:.1}", mean.mean))
}

/// Tables of an evaluation: lag-compensated labels; if `wide`, also the differences to the floors and labels as published.
pub fn tables(results: &Results, wide: bool) -> Vec<Table> {
    let compensated = shown(&results.published, Truth::LagCompensated, results);
    if !wide {
        let own = |row: &Row<'_>| row.model.is_floor() || row.look_ahead == results.aggregation;
        let own: Vec<Row<'_>> = compensated.into_iter().filter(own).collect();
        let caption =
            "Lag-compensated labels: moved to the onset of muscle activity; with look-ahead";
        return vec![narrow(caption, &own)];
    }
    let published = shown(&results.published, Truth::Published, results);
    let mut tables = vec![
        table(
            "Lag-compensated labels: moved to the onset of muscle activity",
            &compensated,
        ),
        floor_differences(&compensated),
        emitted(&compensated),
        table(
            "Labels as published: the times of the cues, as in the paper's evaluation",
            &published,
        ),
    ];
    tables.retain(|table| !table.rows.is_empty());
    tables
}

/// Rows without look-ahead, and with that of the model file; people with all classes first, data set by data set.
fn shown<'a>(scores: &'a [Score], truth: Truth, results: &Results) -> Vec<Row<'a>> {
    let look_aheads = [LookAhead::None, results.aggregation];
    let wanted = |score: &&Score| score.truth == truth && look_aheads.contains(&score.look_ahead);
    let mut shown: Vec<Row<'a>> = scores.iter().filter(wanted).map(Row::new).collect();
    sort(&mut shown);
    shown
}

/// The scores of the integer student in 100 columns, a row a data set and group of people, and of the floors over all data sets:
/// lag-compensated labels, the model file's aggregation mode.
pub fn summary(results: &Results) -> Table {
    let of = |model: System| {
        let scores = results.published.iter();
        let own =
            scores.filter(move |own| own.model == model && own.truth == Truth::LagCompensated);
        own.map(Row::new)
    };
    let own = of(System::Integer).filter(|row| row.look_ahead == results.aggregation);
    let mut rows: Vec<Row<'_>> = own.collect();
    // The last rows are over all recordings.
    rows.sort_by_key(|row| row.data_set == ALL);
    let last = rows.last().map_or(ALL, |row| &row.score.data_set);
    let mut names: Vec<String> = rows.iter().map(|row| row.data_set.clone()).collect();
    for (floor, name) in [(System::Constant, "relax"), (System::Energy, "energy")] {
        rows.extend(of(floor).filter(|row| row.data_set == last));
        names.resize(rows.len(), format!("{last}: {name}"));
    }
    let mut table = of_columns("", &rows, &SUMMARY);
    for (row, name) in table.rows.iter_mut().zip(names) {
        row[0] = name;
    }
    table
}

pub(super) fn table(caption: &str, rows: &[Row<'_>]) -> Table {
    // Few data sets mark movements outside the vocabulary, or are daily life.
    let has = |measure: Measure| rows.iter().any(|own| measure.mean(own).is_some());
    let mut columns = SCORES.to_vec();
    columns.retain(|(name, _)| match *name {
        name if name == OTHER.0 || name == RAISED.0 => has(OtherActivations),
        name if name == DAILY.0 => has(DailyActivations),
        _ => true,
    });
    of_columns(caption, rows, &columns)
}

/// Table with a row for each score and what matters most, for a terminal.
pub(super) fn narrow(caption: &str, rows: &[Row<'_>]) -> Table {
    of_columns(caption, rows, &NARROW)
}

/// Table of labels at the times when they are emitted, with the shares of gestures that are recognised so soon.
pub(super) fn emitted(rows: &[Row<'_>]) -> Table {
    let caption = "Labels at the times when they are emitted, and shares of gestures recognised within so many ms of their onset; \
                   lag-compensated labels";
    of_columns(caption, rows, &EMITTED)
}

fn of_columns(caption: &str, rows: &[Row<'_>], columns: &[Column]) -> Table {
    let mut table = Table::new(caption, columns.iter().map(|(name, _)| *name));
    for row in rows {
        table.push(columns.iter().map(|(_, cell)| cell.of(row)));
    }
    table
}

/// Table of the model file against the floors, person by person; without a model file, of every model.
fn floor_differences(rows: &[Row<'_>]) -> Table {
    let device = rows.iter().any(|row| row.model == System::Integer);
    let models = rows.iter().filter(|row| !row.model.is_floor());
    let models = models.filter(|row| row.model == System::Integer || !device);
    let pairs = models.flat_map(|own| {
        let floors = rows.iter().filter(|row| row.model.is_floor());
        let floors = floors.filter(|floor| floor.same_people(own));
        floors.map(move |floor| (own, floor))
    });
    let caption =
        "Differences to the floors, paired over subjects; mean [95 % interval] over n subjects";
    differences(caption, true, pairs)
}

/// Table with a row for each pair of rows: the first less the second, paired over people.
pub(super) fn differences<'s>(
    caption: &str,
    look_ahead: bool,
    pairs: impl IntoIterator<Item = (&'s Row<'s>, &'s Row<'s>)>,
) -> Table {
    let mut header = vec!["recordings", "classes", "difference"];
    header.extend(look_ahead.then_some("look-ahead"));
    let mut table = Table::new(
        caption,
        header.into_iter().chain(COMPARED.map(Measure::name)),
    );
    for (own, other) in pairs {
        let pair = format!("{} - {}", own.name, other.name);
        let mut cells = vec![own.data_set.clone(), own.people_name(), pair];
        cells.extend(look_ahead.then(|| LOOK_AHEAD.1.of(own)));
        cells.extend(COMPARED.map(|measure| difference(Difference::of(measure, own, other))));
        table.push(cells);
    }
    table
}

/// Table with a row for each model, before and after tuning on a person: the measures of the part held back.
pub fn tuned(caption: &str, scores: &[Score]) -> Table {
    let header = ["model", "gestures"]
        .into_iter()
        .chain(TUNED.map(|(measure, _)| measure.name()));
    let mut table = Table::new(caption, header);
    for score in scores {
        let value = |(measure, decimals): (Measure, usize)| {
            let mean = measure.mean(score);
            mean.map_or_else(String::new, |own| format!("{:.decimals$}", own.mean))
        };
        let start = [score.model.to_string(), score.events.gestures.to_string()];
        table.push(start.into_iter().chain(TUNED.map(value)));
    }
    table
}
