//! Means and intervals of several systems, one below the other.

use maud::{Markup, html};
use recordings::statistics::{Interval, MeanSd};

use super::{INK, ShareAxis, circle, line, picture, shortened, text};
use crate::report::cell;
use crate::report::row::Row;
use crate::{Group, Measure};

/// Measures that are drawn: shares of 1, of which more is better.
const DRAWN: [(Measure, &str); 3] = [
    (Measure::BalancedAccuracy, "balanced accuracy"),
    (Measure::TransitionAccuracy, "transition accuracy"),
    (Measure::Recognition, "gestures recognised"),
];

const WIDTH: f64 = 1100.0;
/// Width for the names.
const GUTTER: f64 = 190.0;
/// Width of a measure: its axis, and `NUMBER` for a number right of it.
const PANEL: f64 = (WIDTH - GUTTER) / DRAWN.len() as f64;
const NUMBER: f64 = 86.0;
const HEAD: f64 = 30.0;
const ROW: f64 = 26.0;
const FOOT: f64 = 22.0;
const LETTERS: usize = 27;

/// Picture with a row for each score, in its colour: a point for each mean, and a line over its 95 % interval.
pub(in crate::report) fn overview(rows: &[(&str, &Row<'_>)]) -> Markup {
    let told = rows.iter().map(|(_, score)| {
        let mean = DRAWN[0].0.mean(score).map_or_else(cell::none, number);
        format!("{} {mean}", name(score))
    });
    let (told, first) = (told.collect::<Vec<_>>().join(", "), DRAWN[0].1);
    let description = format!("{first}: {told}.");
    let bottom = HEAD + ROW * rows.len() as f64;
    let middle = |row: usize| HEAD + ROW * (row as f64 + 0.5);
    let body = html! {
        @for (at, (_, score)) in rows.iter().enumerate() {
            (text("end", (GUTTER - 12.0, middle(at)), 12.0, INK, shortened(&name(score), LETTERS)))
        }
        @for (panel, (measure, title)) in DRAWN.into_iter().enumerate() {
            @let axis = ShareAxis { left: GUTTER + PANEL * panel as f64 + 6.0, width: PANEL - NUMBER - 22.0 };
            (text("start", (axis.left, 13.0), 13.0, INK, title))
            (axis.grid(HEAD, bottom, bottom + 11.0))
            @for (at, (colour, score)) in rows.iter().enumerate() {
                @if let Some(mean) = measure.mean(score) {
                    @let place = |share: f64| (axis.x(share), middle(at));
                    @if let Some(Interval { low, high }) = measure.interval(score) {
                        (line(place(low), place(high), colour, 2.5))
                    }
                    (circle(place(mean.mean), 5.0, colour))
                    @let told = cell::of_people(number(mean), mean.n, score.widest().subjects.len());
                    (text("end", (axis.x(1.0) + NUMBER - 4.0, middle(at)), 12.0, INK, told))
                }
            }
        }
    };
    let size = (WIDTH, bottom + FOOT);
    picture(size, "Scores at a glance", &description, &body)
}

fn name(row: &Row<'_>) -> String {
    match row.people {
        Group::AllClasses => row.name.clone(),
        Group::FewerClasses => format!("{}, fewer", row.name),
    }
}

fn number(mean: MeanSd) -> String {
    format!("{:.3}", mean.mean)
}
