//! One table of a study: rounded cells in Markdown, every number as a field of its own in CSV.

use myointent::report::Table;
use myointent::report::cell::{Cell, Parts};

/// A column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Column {
    /// Its name.
    name: String,
    /// Its fields in CSV, named `NAME PART`.
    parts: Parts,
}

/// A row and the runs that it comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Row {
    /// One cell per column.
    pub(super) cells: Vec<Cell>,
    /// The runs behind the cells, in one line.
    pub(super) source: String,
}

/// A table with its caption, warnings and sources.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Sheet {
    /// Name of its CSV file, without the extension.
    pub(crate) name: String,
    /// Headline.
    pub(super) title: String,
    /// What is shown.
    pub(super) caption: String,
    /// Columns.
    pub(super) columns: Vec<Column>,
    /// Rows.
    pub(super) rows: Vec<Row>,
    /// Limits of the numbers.
    pub(super) warnings: Vec<String>,
}

impl Column {
    /// A column with these fields.
    pub(super) fn new(name: impl Into<String>, parts: Parts) -> Self {
        Self {
            name: name.into(),
            parts,
        }
    }

    fn fields(&self) -> impl Iterator<Item = String> {
        self.parts
            .iter()
            .map(|part| format!("{} {part}", self.name).trim_end().to_owned())
    }
}

impl Sheet {
    /// The table alone, with rounded cells.
    pub(crate) fn table(&self) -> Table {
        let header = self.columns.iter().map(|column| column.name.as_str());
        let mut table = Table::new("", header);
        for row in &self.rows {
            table.push(row.cells.iter().map(|cell| cell.shown.as_str()));
        }
        table
    }

    /// Headline, warnings, caption, table and the runs behind it.
    pub(super) fn markdown(&self) -> String {
        let mut text = format!("## {}\n\n", self.title);
        for warning in &self.warnings {
            text += &format!("**Note:** {warning}.\n\n");
        }
        text += &format!("{}\n\n{}\n", self.caption, self.table().markdown());
        for source in self.sources() {
            text += &format!("- {source}\n");
        }
        text + &format!("- every number: {}.csv\n", self.name)
    }

    /// The fields of every cell; the last column is the runs behind the row.
    ///
    /// # Errors
    /// Never in practice: it writes to memory.
    pub(crate) fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let header = self.columns.iter().flat_map(Column::fields);
        writer.write_record(header.chain(["runs".to_owned()]))?;
        for row in &self.rows {
            let mut record = Vec::new();
            for (column, cell) in self.columns.iter().zip(&row.cells) {
                let end = record.len() + column.parts.len();
                record.extend_from_slice(&cell.fields);
                record.resize(end, String::new());
            }
            record.push(row.source.clone());
            writer.write_record(record)?;
        }
        writer
            .into_inner()
            .map_err(|error| csv::Error::from(error.into_error()))
    }

    /// The runs behind the rows, each once, in the order of the rows.
    fn sources(&self) -> Vec<&str> {
        let mut sources: Vec<&str> = Vec::new();
        for row in &self.rows {
            if !sources.contains(&row.source.as_str()) {
                sources.push(&row.source);
            }
        }
        sources
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use myointent::report::cell::{MEAN_SD, ONE, SUPPORT, none, share, support, text};
    use myointent::statistics::MeanSd;

    #[test]
    fn an_empty_cell_keeps_its_fields_in_csv() {
        let raw = MeanSd {
            mean: 0.5,
            sd: Some(0.1),
            n: 2,
        };
        let row = |cells| Row {
            cells,
            source: "`main`: seed 1, 2 of 2 folds".to_owned(),
        };
        let sheet = Sheet {
            name: "small".to_owned(),
            title: "Small".to_owned(),
            caption: "What is shown.".to_owned(),
            columns: vec![
                Column::new("model", ONE),
                Column::new("raw", MEAN_SD),
                Column::new("n", SUPPORT),
            ],
            rows: vec![
                row(vec![text("a"), share(Some(raw)), support(2, 30)]),
                row(vec![text("b"), none(), none()]),
            ],
            warnings: vec!["look twice".to_owned()],
        };
        let csv = String::from_utf8(sheet.csv().unwrap()).unwrap();
        let expected = "\
model,raw mean,raw sd,n subjects,n transitions,runs
a,0.500,0.10,2,30,\"`main`: seed 1, 2 of 2 folds\"
b,,,,,\"`main`: seed 1, 2 of 2 folds\"
";
        assert_eq!(csv, expected);
        let expected = "\
## Small

**Note:** look twice.

What is shown.

| model |          raw |      n |
| ----- | -----------: | -----: |
| a     | 0.500 (0.10) | 2 / 30 |
| b     |            - |      - |

- `main`: seed 1, 2 of 2 folds
- every number: small.csv
";
        assert_eq!(sheet.markdown(), expected);
    }
}
