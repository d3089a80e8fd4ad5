//! First row of a table, and whether it is names: one rule for the readers, descriptions and `data describe`.

use shared::units::CHANNELS;

use super::columns::{Group, channels};
use super::separator::Separator;
use super::shape::{self, Row};
use crate::readers::table;

/// Rows that are compared with the first one.
const FIRST: usize = 20;

/// First row of a table, behind what stands in front of it.
pub(crate) struct Head<'t> {
    /// Line of the row, 1 first.
    pub line: usize,
    /// The row, without the mark of a comment.
    pub text: &'t str,
    /// Separator of its fields.
    pub separator: Separator,
    /// Fields of the row.
    pub fields: Vec<&'t str>,
    /// Whether it is names, not values.
    pub is_names: bool,
    /// Whether it is a comment that names channels.
    pub is_comment: bool,
    /// Whether rows of numbers follow.
    pub has_numbers: bool,
}

impl<'t> Head<'t> {
    /// The first row of a text, by a separator or its own; none if there is no row.
    pub fn of(text: &'t str, separator: Option<Separator>) -> Option<Self> {
        let mut rows = table::rows(text).skip_while(|(_, row)| is_preface(row));
        let (line, first) = rows.next()?;
        let text = first.trim_start_matches('#');
        let separator = separator.unwrap_or_else(|| Separator::of(text));
        let fields = separator.fields(text);
        let below: Vec<&str> = rows.take(FIRST).map(|(_, row)| row).collect();
        // Names stand over numbers.
        let over = numeric(separator, &below);
        let is_number = |at: &usize| separator.is_number(fields.get(*at).unwrap_or(&""));
        let numbers = (0..fields.len()).filter(is_number).count();
        let text_over_numbers = over.len() - over.iter().filter(|at| is_number(at)).count();
        // Columns may be called 0 to 7 beside one with a name; one damaged value makes no header.
        let names_channels = numbers < fields.len() && channels(&Group::all(&fields)).is_ok();
        let is_names = names_channels
            || counts_up(&fields) && below.first() != Some(&text)
            || if over.is_empty() {
                2 * numbers < fields.len()
            } else {
                2 * text_over_numbers > over.len()
            };
        Some(Self {
            line,
            text,
            separator,
            is_names,
            is_comment: first.len() > text.len(),
            has_numbers: !over.is_empty(),
            fields,
        })
    }
}

/// Columns that are numbers in most rows.
fn numeric(separator: Separator, rows: &[&str]) -> Vec<usize> {
    let mut counts: Vec<usize> = Vec::new();
    for row in rows {
        let fields = separator.fields(row);
        counts.resize(counts.len().max(fields.len()), 0);
        for (count, field) in counts.iter_mut().zip(fields) {
            *count += usize::from(separator.is_number(field));
        }
    }
    let most = |at: &usize| 2 * counts[*at] > rows.len();
    (0..counts.len()).filter(most).collect()
}

/// Lines in front of a table; a comment that names channels is its header.
fn is_preface(row: &str) -> bool {
    let names_channels = row.trim().strip_prefix('#').is_some_and(|comment| {
        let fields = Separator::of(comment).fields(comment);
        channels(&Group::all(&fields)).is_ok()
    });
    table::is_note(row) && !names_channels
}

/// Whether fields count up from 0 or 1, as columns without names are called.
fn counts_up(fields: &[&str]) -> bool {
    let from = |first: usize| {
        let mut numbered = fields.iter().enumerate();
        numbered.all(|(at, field)| field.parse() == Ok(at + first))
    };
    fields.len() >= CHANNELS && (from(0) || from(1))
}

/// Fault of a text whose first rows do not have one form: titles above the header, or rows of several kinds.
pub(super) fn form(text: &str) -> Option<String> {
    let rows: Vec<Row<'_>> = shape::rows(text).take(FIRST).collect();
    let first = rows.first()?.fields.len();
    let is_header = |row: &&Row<'_>| {
        row.numbers.len() < row.fields.len() && channels(&Group::all(&row.fields)).is_ok()
    };
    if let Some(Row { line, .. }) = rows[1..].iter().find(is_header) {
        return Some(format!(
            "expected the header in the first line, found it in line {line}: remove the lines before it, or begin each with #"
        ));
    }
    let is_other = |row: &&Row<'_>| row.fields.len() != first;
    let others = rows.iter().filter(is_other).count();
    // One row that is cut short is damage, and not another kind.
    let kinds = others > 1 && rows.len() > others + 1 || others + 1 == rows.len() && others > 0;
    let is_sample = |row: &&Row<'_>| row.numbers.len() >= CHANNELS;
    let is_meant = 4 * rows.iter().filter(is_sample).count() >= rows.len();
    let Row { line, fields, .. } = rows.iter().find(is_other)?;
    let found = format!("{first} values here and {} in line {line}", fields.len());
    (kinds && is_meant).then(|| {
        format!(
            "expected rows of one kind, found {found}: keep the rows of the EMG, with one header, in a file of their own"
        )
    })
}
