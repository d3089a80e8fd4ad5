//! Output of `predict`: a table of numbers with named columns.

use std::path::Path;

use anyhow::bail;

use recordings::npy;
use recordings::readers::path::ending;

/// File format of a matrix.
#[derive(Clone, Copy)]
pub(in crate::cli) enum Format {
    /// Binary array (`.npy`), f32, without column names.
    Npy,
    /// CSV with the column names in the first row.
    Csv,
}

impl Format {
    /// Format by the extension of a file.
    pub fn of(path: &Path) -> anyhow::Result<Self> {
        match ending(path).as_deref() {
            Some("npy") => Ok(Self::Npy),
            Some("csv") => Ok(Self::Csv),
            _ => bail!(
                "{}: expected a name that ends in .npy or .csv",
                path.display()
            ),
        }
    }
}

/// Rows of numbers, with the names of their columns.
pub struct Matrix {
    /// Column names: at least one, without commas.
    pub columns: Vec<String>,
    /// Values row by row; the length is a multiple of the number of columns.
    pub values: Vec<f32>,
}

impl Matrix {
    /// Encodes the matrix as a file.
    pub fn encode(&self, format: Format) -> Vec<u8> {
        let rows = self.values.chunks_exact(self.columns.len());
        match format {
            Format::Npy => {
                let shape = [rows.len(), self.columns.len()];
                let data: Vec<u8> = self.values.iter().flat_map(|v| v.to_le_bytes()).collect();
                npy::encode("<f4", &shape, &data)
            }
            Format::Csv => {
                let mut text = self.columns.join(",") + "\n";
                for row in rows {
                    let cells: Vec<_> = row.iter().map(f32::to_string).collect();
                    text += &(cells.join(",") + "\n");
                }
                text.into_bytes()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use recordings::npy::Values;

    #[test]
    fn both_formats_hold_every_value() {
        let matrix = Matrix {
            columns: vec!["label".into(), "logit_relax".into()],
            values: vec![-1.0, 0.25, 2.0, f32::NAN],
        };
        let text = String::from_utf8(matrix.encode(Format::Csv)).unwrap();
        assert_eq!(text, "label,logit_relax\n-1,0.25\n2,NaN\n");
        let array = npy::parse(&matrix.encode(Format::Npy)).unwrap();
        assert_eq!(
            (&array.shape[..], array.descr.as_str()),
            (&[2, 2][..], "<f4")
        );
        let Values::Numbers(values) = array.values else {
            panic!("{array:?}");
        };
        assert_eq!(values[..3], [-1.0, 0.25, 2.0]);
        assert!(values[3].is_nan());
    }

    #[test]
    fn another_ending_is_refused() {
        assert!(Format::of(Path::new("labels.txt")).is_err());
        assert!(Format::of(Path::new("npy")).is_err());
    }
}
