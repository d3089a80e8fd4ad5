//! Movement of the armband beside a recording of the wearer's own: `anna_1.imu` beside `anna_1.csv`, comma-separated values.
//! No reader of recordings takes it for one.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use shared::myo::Imu;

use crate::readers::error::{self, Damage, LoadError};
use crate::readers::{self, table};

/// Number of columns.
pub const COLUMNS: usize = 11;

/// The columns: row of the recording that was due when the movement came, 0 first; unit quaternion; g; degrees a second.
const HEAD: &str = "row,w,x,y,z,acceleration_x,acceleration_y,acceleration_z,turn_x,turn_y,turn_z";

/// Path of the movement beside a recording.
pub fn beside(recording: &Path) -> PathBuf {
    recording.with_extension("imu")
}

/// Formats the movement at rows of a recording.
pub fn text(rows: &[(usize, Imu)]) -> String {
    let mut text = format!("{HEAD}\n");
    for (row, imu) in rows {
        text += &row.to_string();
        let (orientation, acceleration) = (imu.quaternion(), imu.acceleration());
        for value in [&orientation[..], &acceleration, &imu.turn_rate()].concat() {
            // Writing to a string cannot fail.
            let _ = write!(text, ",{}", f64::from(value));
        }
        text.push('\n');
    }
    text
}

/// Reads the movement beside a recording; `None` without such a file.
///
/// # Errors
/// [`LoadError::Damaged`] if the file is none of these; [`LoadError::Io`] if it cannot be read.
pub fn read(recording: &Path) -> Result<Option<Vec<[f64; COLUMNS]>>, LoadError> {
    let path = beside(recording);
    if !path.exists() {
        return Ok(None);
    }
    let rows = parse(&String::from_utf8_lossy(&readers::read(&path)?));
    rows.map(Some).map_err(|damage| damage.in_file(&path))
}

fn parse(text: &str) -> Result<Vec<[f64; COLUMNS]>, Damage> {
    let mut lines = table::lines(text);
    let found = lines.next().map_or("", |(_, head)| head);
    if found != HEAD {
        return Err(Damage::at_line(1, error::array(HEAD, found)));
    }
    let row = |(line, text): (usize, &str)| {
        let numbers = text.split(',').enumerate();
        let numbers = numbers.map(|(field, text)| table::number(field + 1, text));
        let numbers: Result<Vec<f64>, String> = numbers.collect();
        let whole = numbers.and_then(|numbers| {
            let fields = error::fields(COLUMNS, numbers.len());
            numbers.try_into().map_err(|_| fields)
        });
        whole.map_err(|fault| Damage::at_line(line, fault))
    };
    lines.map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_other_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let recording = folder.path().join("anna_1.csv");
        assert_eq!(read(&recording).unwrap(), None);
        let imu = Imu([16_384, -8192, 1, 0, 2048, -1024, 0, 16, -24, 1]);
        let written = text(&[(0, imu), (4, imu)]);
        std::fs::write(beside(&recording), &written).unwrap();
        let turn = 1.0 / 16_384.0;
        let movement = [1.0, -0.5, turn, 0.0, 1.0, -0.5, 0.0, 1.0, -1.5, 0.0625];
        let rows = read(&recording).unwrap().unwrap();
        assert_eq!(rows.len(), 2);
        for (row, at) in rows.iter().zip([0.0, 4.0]) {
            assert_eq!((row[0], &row[1..]), (at, &movement[..]));
        }
        for (from, to, line) in [("row", "rows", 1), (",-0.5", "", 2), ("4,1", "4,one", 3)] {
            std::fs::write(beside(&recording), written.replacen(from, to, 1)).unwrap();
            let error = read(&recording).unwrap_err().to_string();
            assert!(error.contains(&format!("line {line}:")), "{error}");
        }
    }
}
