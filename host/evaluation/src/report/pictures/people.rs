//! A bar for each person.

use std::collections::BTreeMap;

use maud::{Markup, html};

use super::{INK, MUTED, ShareAxis, entry_colour, line, picture, rect, shortened, text};
use crate::Measure;
use crate::report::row::Row;

const WIDTH: f64 = 1100.0;
/// Width for a person's name; `NUMBER` is that for the number right of a bar.
const GUTTER: f64 = 158.0;
const NUMBER: f64 = 42.0;
/// Height of the legend and the numbers of the axis.
const HEAD: f64 = 52.0;
/// Height of a bar; `GAP` is that between two people.
const BAR: f64 = 9.0;
const GAP: f64 = 8.0;
/// Maximum number of letters of a name.
const LETTERS: usize = 23;

/// Balanced accuracy of one person.
#[derive(Default)]
struct Person<'a> {
    subject: &'a str,
    /// Values under each entry; none for those that do not evaluate this person.
    values: Vec<Option<f64>>,
    /// Value under the first floor that has one.
    floor: Option<f64>,
}

/// Picture of balanced accuracy as bars from 0 to 1, one for each entry, with a mark at the floor; none without people.
///
/// An entry is its name and its rows over all recordings. People with the lowest value of the first entry come first,
/// those without one last.
pub(in crate::report) fn bars(
    entries: &[(&str, Vec<&Row<'_>>)],
    floors: &[&Row<'_>],
) -> Option<Markup> {
    let people = people(entries, floors);
    let (lowest, count) = (people.first()?.subject, people.len());
    let whose = match count {
        1 => format!("of {lowest}"),
        _ => format!("of {count} people, the lowest {lowest}"),
    };
    let columns = columns(count);
    let in_column = count.div_ceil(columns);
    let row = BAR * entries.len() as f64 + GAP;
    // One column alone needs no whole page.
    let width = if columns == 1 { 640.0 } else { WIDTH };
    let column = width / columns as f64;
    let description = format!("Balanced accuracy {whose}.");
    let body = html! {
        (legend(entries, floors))
        @for (number, own) in people.chunks(in_column).enumerate() {
            @let axis = ShareAxis { left: column * number as f64 + GUTTER, width: column - GUTTER - NUMBER };
            (axis.grid(HEAD - 4.0, HEAD + row * own.len() as f64, HEAD - 12.0))
            @for (at, person) in own.iter().enumerate() {
                (bars_of(axis, HEAD + row * at as f64, person))
            }
        }
    };
    let size = (width, HEAD + row * in_column as f64 + 6.0);
    let title = "Balanced accuracy, a bar a person";
    Some(picture(size, title, &description, &body))
}

/// Number of columns that these people stand in, side by side.
const fn columns(people: usize) -> usize {
    match people {
        0..=12 => 1,
        13..=60 => 2,
        _ => 3,
    }
}

fn people<'a>(entries: &'a [(&str, Vec<&Row<'_>>)], floors: &'a [&Row<'_>]) -> Vec<Person<'a>> {
    let measure = Measure::BalancedAccuracy;
    let mut people: BTreeMap<&str, Person<'_>> = BTreeMap::new();
    for (at, (_, scores)) in entries.iter().enumerate() {
        for (subject, value) in scores.iter().flat_map(|score| measure.values(score)) {
            let person = people.entry(subject).or_default();
            person.subject = subject;
            person.values.resize(entries.len(), None);
            person.values[at] = Some(value);
        }
    }
    for (subject, value) in floors.iter().flat_map(|floor| measure.values(floor)) {
        if let Some(person) = people.get_mut(subject) {
            person.floor.get_or_insert(value);
        }
    }
    let mut people: Vec<_> = people.into_values().collect();
    let key = |person: &Person<'_>| person.values[0].unwrap_or(f64::INFINITY);
    people.sort_by(|a, b| key(a).total_cmp(&key(b)));
    people
}

fn legend(entries: &[(&str, Vec<&Row<'_>>)], floors: &[&Row<'_>]) -> Markup {
    let y = 12.0;
    let mut x = 10.0;
    let mut places = Vec::new();
    for (name, _) in entries {
        let name = shortened(name, 30);
        let width = 36.0 + 7.0 * name.chars().count() as f64;
        places.push((x, name));
        x += width;
    }
    html! {
        @for (at, (x, name)) in places.iter().enumerate() {
            (rect((*x, y - 5.0), (x + 12.0, y + 5.0), entry_colour(at), 1.0))
            (text("start", (x + 18.0, y), 12.0, INK, name))
        }
        @if let Some(floor) = floors.first() {
            (line((x, y - 7.0), (x, y + 7.0), INK, 2.0))
            (text("start", (x + 8.0, y), 12.0, INK, &floor.name))
        }
    }
}

fn bars_of(axis: ShareAxis, top: f64, person: &Person<'_>) -> Markup {
    let bottom = top + BAR * person.values.len() as f64;
    let name = shortened(person.subject, LETTERS);
    html! {
        (text("end", (axis.left - 8.0, f64::midpoint(top, bottom)), 11.0, INK, name))
        @for (at, value) in person.values.iter().enumerate() {
            @if let Some(value) = *value {
                @let y = top + BAR * at as f64;
                (rect((axis.left, y), (axis.x(value), y + BAR - 1.0), entry_colour(at), 1.0))
                (text("start", (axis.x(1.0) + 6.0, y + BAR / 2.0), 9.5, MUTED, format!("{value:.2}")))
            }
        }
        @if let Some(floor) = person.floor {
            // A light edge, to be seen on a bar too.
            @for (colour, width) in [("#FFFFFF", 4.0), (INK, 2.0)] {
                (line((axis.x(floor), top - 2.0), (axis.x(floor), bottom + 1.0), colour, width))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Score;
    use crate::metric::summary::SubjectScore;

    /// Score with these balanced accuracies of people `x/1`, `x/2`...
    fn score(values: &[Option<f64>]) -> Score {
        let subject = |(at, &balanced_accuracy): (usize, &Option<f64>)| SubjectScore {
            subject: format!("x/{}", at + 1),
            recordings: 1,
            classes: 3,
            balanced_accuracy,
            raw_accuracy: None,
            correct: 0,
            events: 0,
            transition_accuracy: None,
            offsets: Vec::new(),
            offset: None,
        };
        Score::of_people(values.iter().enumerate().map(subject).collect(), Vec::new())
    }

    #[test]
    fn everybody_has_a_bar_for_each_entry_that_evaluates_them() {
        let (a, b) = (score(&[Some(0.75), Some(0.25)]), score(&[Some(1.0), None]));
        let floor = score(&[Some(0.5), Some(0.5)]);
        let [a, b, floor] = [&a, &b, &floor].map(Row::new);
        let svg = bars(&[("a", vec![&a]), ("b", vec![&b])], &[&floor])
            .unwrap()
            .0;
        // A square for each entry in the legend, and three bars.
        assert_eq!(svg.matches("<rect").count(), 2 + 3);
        assert!(svg.contains("the lowest x/2.") && svg.contains("0.25"));
    }

    #[test]
    fn many_people_stand_in_columns() {
        let score = score(&[Some(0.5); 100]);
        let score = Row::new(&score);
        assert_eq!(columns(100), 3);
        let svg = bars(&[("a", vec![&score])], &[]).unwrap().0;
        assert_eq!(svg.matches("<rect").count(), 101);
        assert!(bars(&[("a", Vec::new())], &[]).is_none());
    }
}
