//! Rows of numbers without a header: the number of columns, and those that are no muscle activity.

use shared::units::CHANNELS;

use super::separator::Separator;
use crate::examiner::clock::rises_evenly;
use crate::readers::table;

/// Rows that are examined; one damaged row among the first must not hide the format.
const FIRST: usize = 20;
/// Rows over which a column of times or row numbers must rise: muscle activity never does so long.
const RISING: usize = 400;

/// Common properties of the first rows of a table without a header.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Shape {
    /// Separator of the values.
    pub separator: Separator,
    /// Fields in most rows.
    pub columns: usize,
    /// Numbers among them.
    pub numbers: usize,
    /// Whether most rows are decimals between -1 and 1.
    pub is_decimal: bool,
}

/// Row of a table by its own separator.
pub(crate) struct Row<'t> {
    /// Line of the row, 1 first.
    pub line: usize,
    separator: Separator,
    pub fields: Vec<&'t str>,
    /// The finite numbers among the fields.
    pub numbers: Vec<f64>,
}

/// The rows of a text behind the notes in front of them.
pub(crate) fn rows(text: &str) -> impl Iterator<Item = Row<'_>> {
    let rows = table::rows(text).skip_while(|(_, row)| table::is_note(row));
    rows.map(|(line, row)| {
        let separator = Separator::of(row);
        let fields = separator.fields(row);
        let numbers = fields.iter().filter_map(|field| {
            let value = separator.number(field).parse::<f64>().ok();
            value.filter(|value| value.is_finite())
        });
        Row {
            line,
            separator,
            numbers: numbers.collect(),
            fields,
        }
    })
}

/// Numbers of the first rows with so many.
pub(crate) fn first_numbers(text: &str, count: usize) -> Vec<Vec<f64>> {
    let numbers = rows(text).take(RISING).map(|row| row.numbers);
    numbers.filter(|own| own.len() == count).collect()
}

impl Shape {
    /// The shape of most of the first rows; none if they are no rows of numbers. Words may stand beside eight numbers.
    pub fn of(text: &str) -> Option<Self> {
        let rows: Vec<Row<'_>> = rows(text).take(FIRST).collect();
        let most = |count: usize| 2 * count > rows.len();
        let shape = |row: &Row<'_>| (row.separator, row.fields.len(), row.numbers.len());
        let is_own = |&(_, fields, numbers): &_| numbers == fields || numbers >= CHANNELS;
        let (separator, columns, numbers) = rows
            .iter()
            .map(shape)
            .filter(is_own)
            .find(|own| most(rows.iter().filter(|row| shape(row) == *own).count()))?;
        let is_decimal = |row: &&Row<'_>| {
            row.numbers.len() == columns
                && row.numbers.iter().all(|value| value.abs() <= 1.0)
                && row.numbers.iter().any(|value| value.fract() != 0.0)
        };
        Some(Self {
            separator,
            columns,
            numbers,
            is_decimal: most(rows.iter().filter(is_decimal).count()),
        })
    }

    /// First of the columns of the channels: eight numbers, beside others at the ends that rise from row to row.
    pub(crate) fn channels(self, text: &str) -> Option<usize> {
        match (self.columns, self.numbers) {
            (CHANNELS, CHANNELS) => Some(0),
            (columns, numbers) if columns == numbers => self.without_clocks(text),
            _ => None,
        }
    }

    /// First of eight columns, if the others rise from row to row.
    fn without_clocks(self, text: &str) -> Option<usize> {
        let rows = first_numbers(text, self.columns);
        let rises = |column: usize| {
            let values: Vec<f64> = rows.iter().map(|row| row[column]).collect();
            rises_evenly(&values)
        };
        let columns = 0..self.columns;
        let start = columns.take_while(|&column| rises(column)).count();
        let end = start + CHANNELS;
        let others = (end..self.columns).all(rises);
        (end <= self.columns && others).then_some(start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(text: &str) -> Option<(usize, bool)> {
        Shape::of(text).map(|shape| (shape.columns, shape.is_decimal))
    }

    #[test]
    fn tables_are_told_by_most_of_their_first_rows() {
        assert_eq!(shape("1,2,3,4,5,6,7,8,0\n"), Some((9, false)));
        assert_eq!(shape("-0.5,0,0,0,0,0,1,-1\n"), Some((8, true)));
        assert_eq!(shape("1\t2\t3\t4\t5\t6\t7\t8\r\n"), Some((8, false)));
        assert_eq!(shape("0,5;0;0;0;0;0;1;-1\n"), Some((8, true)));
        let damaged = format!("1,2,3,4\n{}", "1,2,3,4,5,6,7,8,0\n".repeat(9));
        assert_eq!(shape(&damaged), Some((9, false)));
        assert_eq!(shape("Sex,M,,\nAge,24,,\n"), None);
        assert_eq!(shape(""), None);
    }

    #[test]
    fn columns_that_rise_are_no_channels() {
        let noise = |at: usize| format!("{0},2,3,4,5,6,7,{0}", at % 2);
        let cases: [(&dyn Fn(usize) -> String, _); 4] = [
            (&|at| format!("{at},{}\n", noise(at)), Some(1)),
            (&|at| format!("{},{}\n", noise(at), 5 * at), Some(0)),
            (&|at| format!("{at},{},{at}.5\n", noise(at)), Some(1)),
            (&|at| format!("{},{}\n", at / 10, noise(at)), None),
        ];
        for (row, start) in cases {
            let text: String = (0..30).map(row).collect();
            let found = Shape::of(&text).unwrap().without_clocks(&text);
            assert_eq!(found, start, "{text}");
        }
    }
}
