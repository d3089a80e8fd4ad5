//! Tables of the measurement.

use evaluation::report::Table;
use evaluation::{ALL, Difference, Measure};

use super::{Amount, MEASURES, Measured, Values};

const ROW: [&str; 4] = ["recordings", "classes", "seconds", "n"];

/// Values before and after, if a person has them.
type Pair = fn(&Measured, &Amount) -> Option<[Values; 2]>;

/// Tables of the gain of each amount, paired over people, by data set and over all: of tuning, of calibration, and of one beside
/// the other. People with all classes and people with fewer have rows of their own.
pub(crate) fn curves(people: &[Measured], amounts: &[f64]) -> [Table; 3] {
    let pairs: [(&str, Pair); 3] = [
        ("Tuned less shipped", |own, at| Some([own.before, at.tuned])),
        ("Calibrated less shipped", |own, at| {
            Some([own.before, at.calibrated?])
        }),
        ("Tuned less calibrated", |_, at| {
            Some([at.calibrated?, at.tuned])
        }),
    ];
    pairs.map(|(name, pair)| curve(people, amounts, name, pair))
}

fn curve(people: &[Measured], amounts: &[f64], name: &str, pair: Pair) -> Table {
    let caption = format!(
        "{name}, both on the same part held back; mean [95 % interval] over n people; worse: share of people whose value fell"
    );
    let names = MEASURES.iter().map(|measure| measure.name().to_owned());
    let header = ROW.map(str::to_owned).into_iter();
    let worse = ["balanced worse", "TA worse"].map(str::to_owned);
    let mut table = Table::new(caption, header.chain(names).chain(worse));
    for (set, group) in sets(people) {
        for (at, &seconds) in amounts.iter().enumerate() {
            let own = rows(people, (&set, &group), at).into_iter();
            let pairs = own.filter_map(|(person, amount)| {
                let [before, after] = pair(person, amount)?;
                Some((&person.subject[..], before, after))
            });
            let start = [set.clone(), group.clone(), named(seconds)];
            push(&mut table, start, &pairs.collect::<Vec<_>>());
        }
    }
    table
}

fn named(seconds: f64) -> String {
    if seconds.is_finite() {
        seconds.to_string()
    } else {
        ALL.to_owned()
    }
}

/// Table with a row for each person and amount.
pub(crate) fn people(people: &[Measured], amounts: &[f64]) -> Table {
    let of = |what: &'static str| {
        let name = move |measure: &Measure| format!("{what} {}", measure.name());
        MEASURES.iter().map(name)
    };
    let start = ["subject", "classes", "judged seconds", "seconds"].map(str::to_owned);
    let header = start.into_iter();
    let header = header
        .chain(of("before"))
        .chain(of("tuned"))
        .chain(of("calibrated"));
    let mut table = Table::new("", header);
    let cell = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.4}"));
    for person in people {
        for (amount, &seconds) in person.amounts.iter().zip(amounts) {
            let Some(amount) = amount else {
                continue;
            };
            let start = [
                person.subject.clone(),
                person.group.clone(),
                format!("{:.1}", person.judged_seconds),
                named(seconds),
            ];
            let calibrated = amount.calibrated.unwrap_or([None; MEASURES.len()]);
            let values = [person.before, amount.tuned, calibrated];
            table.push(
                start
                    .into_iter()
                    .chain(values.into_iter().flatten().map(cell)),
            );
        }
    }
    table
}

fn data_set(person: &Measured) -> Option<&str> {
    Some(person.subject.split_once('/')?.0)
}

/// Data sets of the people, then all of them together; each with the groups of its people.
fn sets(people: &[Measured]) -> Vec<(String, String)> {
    let of = |set: fn(&Measured) -> Option<&str>| {
        let pair = move |person: &Measured| Some((set(person)?.to_owned(), person.group.clone()));
        let mut pairs: Vec<_> = people.iter().filter_map(pair).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    };
    [of(data_set), of(|_| Some(ALL))].concat()
}

/// People of a set and group who have the amount at this index.
fn rows<'m>(
    people: &'m [Measured],
    (set, group): (&str, &str),
    at: usize,
) -> Vec<(&'m Measured, &'m Amount)> {
    let inside =
        |person: &&Measured| person.group == group && (set == ALL || data_set(person) == Some(set));
    let own = people.iter().filter(inside);
    own.filter_map(|person| Some((person, person.amounts[at].as_ref()?)))
        .collect()
}

/// Appends a row of differences, after minus before, unless there are no people.
fn push<'p>(table: &mut Table, start: [String; 3], pairs: &[(&'p str, Values, Values)]) {
    if pairs.is_empty() {
        return;
    }
    let side = |at: usize, after: bool| -> Vec<(&'p str, f64)> {
        let value = |&(who, ref old, ref new): &(&'p str, Values, Values)| {
            let values = if after { new } else { old };
            Some((who, values[at]?))
        };
        pairs.iter().filter_map(value).collect()
    };
    let shown = |at: usize| match Difference::paired(&side(at, true), &side(at, false)) {
        None => String::new(),
        Some(own) => {
            let mean = own.mean.mean;
            let interval = own.interval.map_or_else(String::new, |interval| {
                format!(" [{:+.3}, {:+.3}]", interval.low, interval.high)
            });
            let mark = if own.is_shown() { " *" } else { "" };
            format!("{mean:+.3}{interval}{mark}")
        }
    };
    let worse = |at: usize| {
        let both = pairs
            .iter()
            .filter_map(|(_, old, new)| Some((old[at]?, new[at]?)));
        let both: Vec<_> = both.collect();
        let fell = both.iter().filter(|(old, new)| new < old).count();
        if both.is_empty() {
            String::new()
        } else {
            format!("{fell} of {}", both.len())
        }
    };
    let cells = (0..MEASURES.len()).map(shown).chain([worse(0), worse(1)]);
    let count = [pairs.len().to_string()];
    table.push(start.into_iter().chain(count).chain(cells));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn measured(subject: &str, group: &str, gain: f64) -> Measured {
        let value = |value| [Some(value); MEASURES.len()];
        Measured {
            subject: subject.to_owned(),
            group: group.to_owned(),
            judged_seconds: 60.0,
            before: value(0.5),
            amounts: vec![
                None,
                Some(Amount {
                    tuned: value(0.5 + gain),
                    calibrated: Some(value(0.6)),
                }),
            ],
        }
    }

    #[test]
    fn people_with_fewer_classes_have_rows_of_their_own() {
        let people = [
            measured("one/a", "all 3", 0.1),
            measured("one/b", "all 3", 0.1),
            measured("two/a", "fewer", 0.3),
            measured("two/b", "fewer", 0.3),
        ];
        let amounts = [30.0, f64::INFINITY];
        let [tuned, calibrated, both] = curves(&people, &amounts);
        for table in [&tuned, &calibrated, &both] {
            let names: Vec<_> = table.rows.iter().map(|row| &row[..4]).collect();
            let expected = [
                ["one", "all 3", "all", "2"],
                ["two", "fewer", "all", "2"],
                ["all", "all 3", "all", "2"],
                ["all", "fewer", "all", "2"],
            ];
            assert_eq!(names, expected);
        }
        let gains = |table: &Table| -> Vec<String> {
            let rows = table.rows.iter();
            rows.map(|row| row[4][..6].to_owned()).collect()
        };
        assert_eq!(gains(&tuned), ["+0.100", "+0.300", "+0.100", "+0.300"]);
        assert_eq!(gains(&calibrated), ["+0.100"; 4]);
        assert_eq!(gains(&both), ["+0.000", "+0.200", "+0.000", "+0.200"]);
    }
}
