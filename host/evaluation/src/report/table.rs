//! Tables, for the terminal, for Markdown and for HTML.

use execution::printable::printable;
use maud::{Markup, Render, html};

/// Columns of a terminal.
const TERMINAL: usize = 100;

/// Letters of a cell above which its line may break on a page.
const LONG: usize = 32;

/// Rows of text under a header. A row shorter than the header ends in empty cells. All text becomes printable.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// Caption, above the table in every format; may be empty.
    pub caption: String,
    /// Names of the columns.
    pub header: Vec<String>,
    /// Cells, row by row.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// An empty table with these columns.
    pub fn new<S: Into<String>>(
        caption: impl Into<String>,
        header: impl IntoIterator<Item = S>,
    ) -> Self {
        Self {
            caption: printable(&caption.into()),
            header: cells(header),
            rows: Vec::new(),
        }
    }

    /// Appends a row.
    pub fn push<S: Into<String>>(&mut self, row: impl IntoIterator<Item = S>) {
        self.rows.push(cells(row));
    }

    /// Text with aligned columns for a terminal: numbers to the right, the rest to the left.
    pub fn plain(&self) -> String {
        let rule = |column: &Column| "-".repeat(column.width);
        let lines = self.lines("|", rule, |cells| cells.join("  ").trim_end().to_owned());
        self.caption_line("\n") + &lines
    }

    /// [`plain`](Self::plain), or unless it is `wide`, for a terminal of 100 columns: the last columns are left out that do
    /// not fit, and named.
    pub fn text(&self, wide: bool) -> String {
        if wide {
            return self.plain();
        }
        let columns = self.columns();
        let mut end = columns.len();
        let taken = |end: usize| columns[..end].iter().map(|column| column.width + 2).sum();
        while end > 1 && TERMINAL + 2 < taken(end) {
            end -= 1;
        }
        let mut caption = wrapped(&self.caption);
        if end < columns.len() {
            let rest = format!("(not here: {})", self.header[end..].join(", "));
            caption = caption + "\n" + &wrapped(&rest);
        }
        let cut = |row: &Vec<String>| row.iter().take(end).cloned().collect();
        let shown = Self {
            caption,
            header: cut(&self.header),
            rows: self.rows.iter().map(cut).collect(),
        };
        shown.plain()
    }

    /// A table of GitHub's Markdown, aligned in the source too.
    pub fn markdown(&self) -> String {
        let rule = |column: &Column| {
            let end = if column.numeric { ":" } else { "-" };
            "-".repeat(column.width.max(2) - 1) + end
        };
        let line = |cells: Vec<String>| format!("| {} |", cells.join(" | "));
        self.caption_line("\n\n") + &self.lines("\\|", rule, line)
    }

    /// Header, rule and rows with padded cells, a line each; `bar` is written for `|` in a cell.
    fn lines(
        &self,
        bar: &str,
        rule: fn(&Column) -> String,
        line: impl Fn(Vec<String>) -> String,
    ) -> String {
        let columns = self.columns();
        let padded = |row: &Vec<String>| {
            let columns = columns.iter().enumerate();
            columns
                .map(|(i, column)| column.pad(&cell(row, i).replace('|', bar)))
                .collect()
        };
        let head = [padded(&self.header), columns.iter().map(rule).collect()];
        let lines = head.into_iter().chain(self.rows.iter().map(padded));
        lines.map(|cells| line(cells) + "\n").collect()
    }

    /// Header and rows as CSV.
    pub fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        for record in std::iter::once(&self.header).chain(&self.rows) {
            writer.write_record(record)?;
        }
        Ok(writer
            .into_inner()
            .map_err(csv::IntoInnerError::into_error)?)
    }

    fn caption_line(&self, end: &str) -> String {
        match &self.caption[..] {
            "" => String::new(),
            caption => caption.to_owned() + end,
        }
    }

    fn columns(&self) -> Vec<Column> {
        let column = |i: usize| {
            let cells = || self.rows.iter().map(move |row| cell(row, i));
            let widths = cells().chain([cell(&self.header, i)]).map(width);
            Column {
                width: widths.max().unwrap_or(0),
                numeric: !self.rows.is_empty() && cells().all(is_number_or_empty),
            }
        };
        (0..self.header.len()).map(column).collect()
    }
}

impl Render for Table {
    fn render(&self) -> Markup {
        let columns = self.columns();
        let in_columns = |row| {
            columns
                .iter()
                .enumerate()
                .map(move |(i, column)| (column, cell(&self.header, i), cell(row, i)))
        };
        html! {
            div.wide { table {
                @if !self.caption.is_empty() { caption { (self.caption) } }
                // A head that printed pages repeat.
                thead { tr { @for (column, text, _) in in_columns(&self.header) { th class=[column.class(text)] { (text) } } } }
                tbody { @for row in &self.rows { tr { @for (column, name, text) in in_columns(row) {
                    td class=[column.class(text)] data-name=(name) { (text) }
                } } } }
            } }
        }
    }
}

struct Column {
    width: usize,
    numeric: bool,
}

impl Column {
    /// Class of a cell: sentences may break, numbers may not.
    fn class(&self, text: &str) -> Option<&'static str> {
        match (self.numeric, width(text) > LONG) {
            (true, true) => Some("number long"),
            (true, false) => Some("number"),
            (false, true) => Some("long"),
            (false, false) => None,
        }
    }

    fn pad(&self, text: &str) -> String {
        let blanks = " ".repeat(self.width.saturating_sub(width(text)));
        if self.numeric {
            blanks + text
        } else {
            text.to_owned() + &blanks
        }
    }
}

fn cells<S: Into<String>>(texts: impl IntoIterator<Item = S>) -> Vec<String> {
    let texts = texts.into_iter().map(Into::into);
    texts.map(|text| printable(&text)).collect()
}

fn cell(row: &[String], i: usize) -> &str {
    row.get(i).map_or("", String::as_str)
}

/// Text in lines that fit a terminal.
fn wrapped(text: &str) -> String {
    let mut lines = String::new();
    let mut free = TERMINAL;
    for word in text.split_whitespace() {
        let needed = width(word) + 1;
        if needed > free {
            lines.push('\n');
            free = TERMINAL;
        } else if free < TERMINAL {
            lines.push(' ');
        }
        lines += word;
        free = free.saturating_sub(needed);
    }
    lines
}

fn width(text: &str) -> usize {
    text.chars().count()
}

/// Whether a cell belongs to a column of numbers: `0.91`, `+160 ms`, `0.75 ± 0.04`, `-`, `>50 % missed`, nothing.
fn is_number_or_empty(text: &str) -> bool {
    let unsigned = text.trim_start_matches(['+', '-', '−', '±', '>']);
    unsigned.is_empty() || unsigned.starts_with(|c: char| c.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scores() -> Table {
        let mut table = Table::new("Held-out subjects", ["system", "raw", "offset"]);
        table.push(["teacher", "0.81", "+160 ms"]);
        table.push(["student, i8", "0.8", "-"]);
        table
    }

    #[test]
    fn numbers_align_to_the_right_in_a_terminal() {
        let expected = "\
Held-out subjects
system        raw   offset
-----------  ----  -------
teacher      0.81  +160 ms
student, i8   0.8        -
";
        assert_eq!(scores().plain(), expected);
    }

    #[test]
    fn markdown_has_the_alignment_in_its_rule() {
        let expected = "\
Held-out subjects

| system      |  raw |  offset |
| ----------- | ---: | ------: |
| teacher     | 0.81 | +160 ms |
| student, i8 |  0.8 |       - |
";
        assert_eq!(scores().markdown(), expected);
    }

    #[test]
    fn a_bar_in_a_cell_does_not_open_a_column() {
        let mut table = Table::new("", ["a"]);
        table.push(["x|y"]);
        assert!(table.markdown().contains("x\\|y"));
    }

    #[test]
    fn short_rows_end_in_empty_cells() {
        let mut table = Table::new("", ["a", "b"]);
        table.push(["x"]);
        assert_eq!(table.plain(), "a  b\n-  -\nx\n");
        let html = table.render().0;
        assert!(
            html.contains(r#"<td data-name="a">x</td><td class="number" data-name="b"></td>"#),
            "{html}"
        );
    }

    #[test]
    fn no_text_steers_the_terminal() {
        let hostile = "\u{1b}[2J\r\n\u{9b}31m";
        let mut table = Table::new(hostile, [hostile]);
        table.push([hostile]);
        for text in [table.plain(), table.text(false), table.markdown()] {
            let raw = |c: char| c.is_control() && c != '\n';
            assert!(!text.contains(raw), "{text:?}");
        }
        assert_eq!(table.plain().lines().count(), 4, "{:?}", table.plain());
    }
}
