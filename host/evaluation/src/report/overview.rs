//! Means and intervals of several systems, one below the other.

use plotters::{
    prelude::*,
    style::text_anchor::{HPos, VPos},
};

use super::{
    ReportError,
    canvas::{self, Area, Drawn, GRID, INK, MUTED, SCALE, entry_colour, text},
    cell::{self, Cell},
};
use crate::{Group, Measure, Score};
use recordings::statistics::{Interval, MeanSd};

/// Measures that are drawn: shares of 1, of which more is better.
const DRAWN: [(Measure, &str); 3] = [
    (Measure::BalancedAccuracy, "balanced accuracy"),
    (Measure::TransitionAccuracy, "transition accuracy"),
    (Measure::Recognition, "gestures recognised"),
];

const WIDTH: i32 = 1100;
/// Width for the names, in pixels.
const GUTTER: i32 = 190;
/// Width for a number right of its axis, in pixels.
const NUMBER: i32 = 86;
const HEAD: i32 = 30;
const ROW: i32 = 26;
const FOOT: i32 = 22;
/// Maximum number of letters of a name.
const LETTERS: usize = 27;

/// Kind of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The entry of this number.
    Entry(usize),
    /// Another model of the same run.
    Beside,
    /// A baseline without a model.
    Floor,
}

/// A system and its means over people.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Row {
    /// Name at the left.
    pub name: String,
    /// Kind, which decides the colour.
    pub kind: Kind,
    /// Number of people.
    pub people: usize,
    /// Mean and interval of each measure.
    pub values: [Option<(MeanSd, Option<Interval>)>; DRAWN.len()],
}

impl Row {
    /// The row of a score.
    pub(super) fn of(score: &Score, kind: Kind) -> Self {
        Self {
            name: match score.people {
                Group::AllClasses => score.model.clone(),
                Group::FewerClasses => format!("{}, fewer", score.model),
            },
            kind,
            people: score.widest().subjects.len(),
            values: DRAWN.map(|(measure, _)| {
                let mean = measure.mean(score)?;
                Some((mean, measure.interval(score)))
            }),
        }
    }
}

/// Picture with a point for each mean, and a line over its 95 % interval.
pub(super) fn svg(rows: &[Row]) -> Result<String, ReportError> {
    let told = rows.iter().map(|row| {
        let mean = row.values[0].map_or_else(|| "-".to_owned(), |(mean, _)| number(mean).shown);
        format!("{} {mean}", row.name)
    });
    let description = format!(
        "Means over people with 95 % intervals. {}: {}.",
        DRAWN[0].1,
        told.collect::<Vec<_>>().join(", ")
    );
    let height = HEAD + ROW * rows.len() as i32 + FOOT;
    canvas::draw(
        (WIDTH, height),
        "Scores at a glance",
        &description,
        |area| {
            for (at, row) in rows.iter().enumerate() {
                let style = text(12.0, INK, HPos::Right, VPos::Center);
                let place = ((GUTTER - 12) * SCALE, middle(at));
                area.draw(&Text::new(shortened(&row.name, LETTERS), place, style))?;
            }
            for panel in 0..DRAWN.len() {
                axis(area, panel, rows.len())?;
                for (at, row) in rows.iter().enumerate() {
                    if let Some((mean, interval)) = row.values[panel] {
                        let told = number(mean).of_people(mean.n, row.people).shown;
                        point(area, panel, middle(at), row.kind, mean.mean, interval, told)?;
                    }
                }
            }
            Ok(())
        },
    )
}

/// Middle of a row, in units of the drawing.
const fn middle(row: usize) -> i32 {
    (HEAD + ROW * row as i32 + ROW / 2) * SCALE
}

/// Left end and width of a panel's axis, in pixels.
const fn panel_axis(panel: usize) -> (i32, i32) {
    let width = (WIDTH - GUTTER) / DRAWN.len() as i32;
    (GUTTER + width * panel as i32 + 6, width - NUMBER - 22)
}

/// Place of a share on the axis of a panel, in units of the drawing.
fn x(panel: usize, share: f64) -> i32 {
    let (left, width) = panel_axis(panel);
    left * SCALE + (f64::from(width * SCALE) * share.clamp(0.0, 1.0)).round() as i32
}

fn axis(area: &Area<'_>, panel: usize, rows: usize) -> Drawn {
    let (left, _) = panel_axis(panel);
    let bottom = HEAD + ROW * rows as i32;
    let style = text(13.0, INK, HPos::Left, VPos::Center);
    area.draw(&Text::new(
        DRAWN[panel].1,
        (left * SCALE, 13 * SCALE),
        style,
    ))?;
    for (share, label) in [(0.0, "0"), (0.25, ""), (0.5, "0.5"), (0.75, ""), (1.0, "1")] {
        let x = x(panel, share);
        let line = vec![(x, HEAD * SCALE), (x, bottom * SCALE)];
        area.draw(&PathElement::new(line, GRID.stroke_width(2)))?;
        let style = text(11.0, MUTED, HPos::Center, VPos::Center);
        area.draw(&Text::new(label, (x, (bottom + 11) * SCALE), style))?;
    }
    Ok(())
}

fn point(
    area: &Area<'_>,
    panel: usize,
    y: i32,
    kind: Kind,
    mean: f64,
    interval: Option<Interval>,
    told: String,
) -> Drawn {
    let colour = match kind {
        Kind::Entry(number) => entry_colour(number),
        Kind::Beside => INK,
        Kind::Floor => MUTED,
    };
    if let Some(Interval { low, high }) = interval {
        let line = vec![(x(panel, low), y), (x(panel, high), y)];
        area.draw(&PathElement::new(line, colour.stroke_width(5)))?;
    }
    area.draw(&Circle::new(
        (x(panel, mean), y),
        5 * SCALE,
        colour.filled(),
    ))?;
    let (left, width) = panel_axis(panel);
    let place = ((left + width + NUMBER - 4) * SCALE, y);
    let style = text(12.0, INK, HPos::Right, VPos::Center);
    area.draw(&Text::new(told, place, style))
}

fn number(mean: MeanSd) -> Cell {
    cell::text(format!("{:.3}", mean.mean))
}

/// Name cut to at most `letters` letters.
pub(super) fn shortened(name: &str, letters: usize) -> String {
    if name.chars().count() <= letters {
        return name.to_owned();
    }
    name.chars().take(letters - 1).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_has_its_place_on_the_axis_of_its_panel() {
        let (left, width) = panel_axis(1);
        assert_eq!(x(1, 0.0), left * SCALE);
        assert_eq!(x(1, 1.0), (left + width) * SCALE);
        assert_eq!(x(1, 7.0), x(1, 1.0));
        assert!(x(0, 1.0) + NUMBER < x(1, 0.0));
    }

    #[test]
    fn a_long_name_ends_in_an_ellipsis() {
        assert_eq!(shortened("student", 7), "student");
        assert_eq!(shortened("students", 7), "studen…");
    }
}
