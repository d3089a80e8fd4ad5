//! A bar for each person.

use std::collections::BTreeMap;

use plotters::{
    prelude::*,
    style::text_anchor::{HPos, VPos},
};

use super::{
    ReportError,
    canvas::{self, Area, Drawn, GRID, INK, MUTED, SCALE, entry_colour, text},
    overview::shortened,
};
use crate::{Measure, Score};

const WIDTH: i32 = 1100;
/// Width for a person's name; `NUMBER` is that for the number right of a bar, in pixels.
const GUTTER: i32 = 158;
const NUMBER: i32 = 42;
const LEGEND: i32 = 30;
const HEAD: i32 = LEGEND + 22;
/// Height of a bar; `GAP` is that between two people, in pixels.
const BAR: i32 = 9;
const GAP: i32 = 8;
/// Maximum number of letters of a name.
const LETTERS: usize = 23;

/// The balanced accuracy of each person.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct People {
    /// Names of the entries, one bar each.
    pub names: Vec<String>,
    /// Name of what the marks show; empty without them.
    pub floor: String,
    /// The people, the lowest value of the first entry first, those without one last.
    pub rows: Vec<Person>,
}

/// Values of one person.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Person {
    /// The subject.
    pub subject: String,
    /// Values under each entry; none for those that do not evaluate this person.
    pub values: Vec<Option<f64>>,
    /// Value under the floor.
    pub floor: Option<f64>,
}

impl People {
    /// Values of the people in the rows of some entries over all their recordings, each with the value of the first
    /// floor that has one.
    pub(super) fn of(entries: &[(&str, Vec<&Score>)], floors: &[&Score]) -> Self {
        let mut people: BTreeMap<&str, Person> = BTreeMap::new();
        for (at, (_, scores)) in entries.iter().enumerate() {
            let values = scores
                .iter()
                .map(|score| Measure::BalancedAccuracy.values(score));
            for (subject, value) in values.flatten() {
                let person = people.entry(subject).or_default();
                person.values.resize(entries.len(), None);
                person.values[at] = Some(value);
            }
        }
        for floor in floors {
            for (subject, value) in Measure::BalancedAccuracy.values(floor) {
                if let Some(person) = people.get_mut(subject) {
                    person.floor.get_or_insert(value);
                }
            }
        }
        let mut rows: Vec<Person> = people
            .into_iter()
            .map(|(subject, person)| Person {
                subject: subject.to_owned(),
                ..person
            })
            .collect();
        let key = |person: &Person| person.values[0].unwrap_or(f64::INFINITY);
        rows.sort_by(|a, b| key(a).total_cmp(&key(b)));
        Self {
            names: entries.iter().map(|(name, _)| (*name).to_owned()).collect(),
            floor: floors
                .first()
                .map_or_else(String::new, |own| own.model.clone()),
            rows,
        }
    }

    /// Number of columns of people side by side.
    const fn columns(&self) -> usize {
        match self.rows.len() {
            0..=12 => 1,
            13..=60 => 2,
            _ => 3,
        }
    }
}

/// Picture of balanced accuracy as bars from 0 to 1, with a mark at the floor.
pub(super) fn svg(people: &People) -> Result<String, ReportError> {
    let columns = people.columns();
    let in_column = people.rows.len().div_ceil(columns).max(1);
    let row = BAR * people.names.len() as i32 + GAP;
    // One column alone needs no whole page.
    let width = if columns == 1 { 640 } else { WIDTH };
    let height = HEAD + row * in_column as i32 + 6;
    let lowest = people.rows.first();
    let description = format!(
        "Balanced accuracy of {} people{}.",
        people.rows.len(),
        lowest.map_or_else(String::new, |own| format!(", the lowest {}", own.subject)),
    );
    canvas::draw(
        (width, height),
        "Balanced accuracy, a bar a person",
        &description,
        |area| {
            legend(area, people)?;
            for (number, own) in people.rows.chunks(in_column).enumerate() {
                let of = Column {
                    left: width / columns as i32 * number as i32 + GUTTER,
                    length: width / columns as i32 - GUTTER - NUMBER,
                };
                of.axis(area, row * own.len() as i32)?;
                for (at, person) in own.iter().enumerate() {
                    of.person(area, HEAD + row * at as i32, person)?;
                }
            }
            Ok(())
        },
    )
}

fn legend(area: &Area<'_>, people: &People) -> Drawn {
    let mut x = 10;
    let y = 12;
    let style = || text(12.0, INK, HPos::Left, VPos::Center);
    for (at, name) in people.names.iter().enumerate() {
        let square = [
            (x * SCALE, (y - 5) * SCALE),
            ((x + 12) * SCALE, (y + 5) * SCALE),
        ];
        area.draw(&Rectangle::new(square, entry_colour(at).filled()))?;
        let name = shortened(name, 30);
        area.draw(&Text::new(
            name.clone(),
            ((x + 18) * SCALE, y * SCALE),
            style(),
        ))?;
        x += 18 + 7 * name.chars().count() as i32 + 18;
    }
    if !people.floor.is_empty() {
        let line = vec![(x * SCALE, (y - 7) * SCALE), (x * SCALE, (y + 7) * SCALE)];
        area.draw(&PathElement::new(line, INK.stroke_width(4)))?;
        area.draw(&Text::new(
            people.floor.clone(),
            ((x + 8) * SCALE, y * SCALE),
            style(),
        ))?;
    }
    Ok(())
}

/// Position of a column of people, in pixels.
struct Column {
    left: i32,
    length: i32,
}

impl Column {
    fn x(&self, share: f64) -> i32 {
        let length = f64::from(self.length * SCALE);
        self.left * SCALE + (length * share.clamp(0.0, 1.0)).round() as i32
    }

    fn axis(&self, area: &Area<'_>, height: i32) -> Drawn {
        for (share, label) in [(0.0, "0"), (0.25, ""), (0.5, "0.5"), (0.75, ""), (1.0, "1")] {
            let x = self.x(share);
            let line = vec![(x, (HEAD - 4) * SCALE), (x, (HEAD + height) * SCALE)];
            area.draw(&PathElement::new(line, GRID.stroke_width(2)))?;
            let style = text(11.0, MUTED, HPos::Center, VPos::Center);
            area.draw(&Text::new(label, (x, (HEAD - 12) * SCALE), style))?;
        }
        Ok(())
    }

    fn person(&self, area: &Area<'_>, top: i32, person: &Person) -> Drawn {
        let high = BAR * person.values.len() as i32;
        let middle = (2 * top + high) * SCALE / 2;
        let style = text(11.0, INK, HPos::Right, VPos::Center);
        let name = shortened(&person.subject, LETTERS);
        area.draw(&Text::new(name, ((self.left - 8) * SCALE, middle), style))?;
        for (at, value) in person.values.iter().enumerate() {
            let Some(value) = *value else { continue };
            let y = top + BAR * at as i32;
            let bar = [
                (self.x(0.0), y * SCALE),
                (self.x(value), (y + BAR - 1) * SCALE),
            ];
            area.draw(&Rectangle::new(bar, entry_colour(at).filled()))?;
            let style = text(9.5, MUTED, HPos::Left, VPos::Center);
            let place = (self.x(1.0) + 6 * SCALE, (2 * y + BAR) * SCALE / 2);
            area.draw(&Text::new(format!("{value:.2}"), place, style))?;
        }
        if let Some(floor) = person.floor {
            let x = self.x(floor);
            let line = vec![(x, (top - 2) * SCALE), (x, (top + high + 1) * SCALE)];
            // A light edge, to be seen on a bar too.
            area.draw(&PathElement::new(line.clone(), WHITE.stroke_width(8)))?;
            area.draw(&PathElement::new(line, INK.stroke_width(4)))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn person(subject: &str, values: &[Option<f64>]) -> Person {
        Person {
            subject: subject.to_owned(),
            values: values.to_vec(),
            floor: Some(0.5),
        }
    }

    #[test]
    fn everybody_has_a_bar_for_each_entry_that_evaluates_them() {
        let people = People {
            names: vec!["a".to_owned(), "b".to_owned()],
            floor: "energy detector".to_owned(),
            rows: vec![
                person("x/1", &[Some(0.25), None]),
                person("x/2", &[Some(0.75), Some(1.0)]),
            ],
        };
        let svg = svg(&people).unwrap();
        let bars = svg.matches("<rect").count();
        // A square for each entry in the legend, and three bars.
        assert_eq!(bars, 2 + 3);
        assert!(svg.contains("x/1") && svg.contains("0.25"));
    }

    #[test]
    fn many_people_stand_in_columns() {
        let rows = (0..100).map(|at| person(&format!("x/{at}"), &[Some(0.5)]));
        let people = People {
            names: vec!["a".to_owned()],
            floor: String::new(),
            rows: rows.collect(),
        };
        assert_eq!(people.columns(), 3);
        let svg = svg(&people).unwrap();
        assert_eq!(svg.matches("<rect").count(), 101);
    }
}
