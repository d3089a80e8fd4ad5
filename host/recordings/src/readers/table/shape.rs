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

impl Shape {
    /// The shape of most of the first rows; none if they are no rows of numbers. Words may stand beside eight numbers.
    pub fn of(text: &str) -> Option<Self> {
        let rows: Vec<&str> = table::rows(text)
            .map(|(_, row)| row)
            .skip_while(|row| table::is_note(row))
            .take(FIRST)
            .collect();
        let most = |count: usize| 2 * count > rows.len();
        let rows: Vec<(Separator, usize, Vec<f64>)> = rows
            .iter()
            .map(|row| fields_and_numbers(row))
            .filter(|(_, fields, numbers)| numbers.len() == *fields || numbers.len() >= CHANNELS)
            .collect();
        let shape = |(separator, fields, numbers): &(Separator, usize, Vec<f64>)| {
            (*separator, *fields, numbers.len())
        };
        let (separator, columns, numbers) = rows
            .iter()
            .map(shape)
            .find(|own| most(rows.iter().filter(|row| shape(row) == *own).count()))?;
        let is_decimal = |(_, _, row): &&(Separator, usize, Vec<f64>)| {
            row.len() == columns
                && row.iter().all(|v| v.abs() <= 1.0)
                && row.iter().any(|v| v.fract() != 0.0)
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
    pub(crate) fn without_clocks(self, text: &str) -> Option<usize> {
        let rows = table::rows(text).map(|(_, row)| fields_and_numbers(row).2);
        let rows = rows.filter(|row| row.len() == self.columns);
        let rows: Vec<Vec<f64>> = rows.take(RISING).collect();
        let rises = |column: usize| {
            let values: Vec<f64> = rows.iter().map(|row| row[column]).collect();
            rises_evenly(&values)
        };
        let start = (0..self.columns)
            .take_while(|&column| rises(column))
            .count();
        let end = start + CHANNELS;
        let others = (end..self.columns).all(rises);
        (end <= self.columns && others).then_some(start)
    }
}

/// Numbers of the first rows of the usual number of fields.
pub(crate) fn first_numbers(text: &str) -> Vec<Vec<f64>> {
    let Some(shape) = Shape::of(text) else {
        return Vec::new();
    };
    let rows = table::rows(text).map(|(_, row)| fields_and_numbers(row).2);
    let rows = rows.take(RISING);
    rows.filter(|row| row.len() == shape.numbers).collect()
}

/// Separator of a row, number of its fields, and the numbers among them.
fn fields_and_numbers(row: &str) -> (Separator, usize, Vec<f64>) {
    let separator = Separator::of(row);
    let fields = separator.fields(row);
    let numbers = fields.iter().filter_map(|field| {
        let value = separator.number(field).parse::<f64>().ok();
        value.filter(|value| value.is_finite())
    });
    (separator, fields.len(), numbers.collect())
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
