//! Kind of a file by its first bytes, in the words with which a wrong one is refused.

use std::fmt;

shared::names! {
    /// Kind of a file.
    #[expect(missing_docs, reason = "the names say it")]
    pub enum FileKind {
        Empty = "an empty file",
        Model = "a model file",
        Npy = "an npy array",
        Mat = "a MATLAB file",
        Hdf5 = "an HDF5 file (MATLAB 7.3 writes such)",
        Edf = "an EDF or BDF file",
        Xdf = "an XDF file",
        Zip = "a zip archive",
        Gzip = "a gzip archive",
        Tar = "a tar archive",
        LfsPointer = "a Git LFS pointer without the content",
        Html = "an HTML page",
        Json = "JSON",
        Utf16 = "UTF-16 text",
        Table = "a table of numbers (csv)",
        Text = "text",
        Binary = "binary data of no known kind",
    }
}

const EXAMINED: usize = 4096;

impl FileKind {
    /// Kind of a file with these bytes.
    pub fn of(bytes: &[u8]) -> Self {
        let starts = |magic: &[u8]| bytes.starts_with(magic);
        match bytes {
            [] => Self::Empty,
            _ if starts(&shared::model::file::MAGIC) => Self::Model,
            _ if starts(b"\x93NUMPY") => Self::Npy,
            _ if starts(b"MATLAB 5.0") => Self::Mat,
            _ if starts(b"\x89HDF\r\n\x1a\n") || starts(b"MATLAB 7.3") => Self::Hdf5,
            _ if is_edf(bytes) => Self::Edf,
            _ if starts(b"XDF:") => Self::Xdf,
            _ if starts(b"PK\x03\x04") || starts(b"PK\x05\x06") => Self::Zip,
            [0x1f, 0x8b, ..] => Self::Gzip,
            _ if bytes.get(257..262) == Some(b"ustar") => Self::Tar,
            [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => Self::Utf16,
            [0x21..=0x7e, 0, 0x09..=0x7e, 0, ..] | [0, 0x21..=0x7e, 0, 0x09..=0x7e, ..] => {
                Self::Utf16
            }
            _ => Self::of_text(&bytes[..bytes.len().min(EXAMINED)]),
        }
    }

    fn of_text(bytes: &[u8]) -> Self {
        let end = match std::str::from_utf8(bytes) {
            Ok(_) => bytes.len(),
            // A character that the cut divides is left out.
            Err(error) if error.error_len().is_none() => error.valid_up_to(),
            Err(_) => return Self::Binary,
        };
        let Ok(text) = std::str::from_utf8(&bytes[..end]) else {
            return Self::Binary;
        };
        let text = text.trim_start_matches('\u{feff}').trim_start();
        let begins = |word: &str| {
            let start = text.get(..word.len());
            start.is_some_and(|start| start.eq_ignore_ascii_case(word))
        };
        if text.contains('\0') {
            Self::Binary
        } else if begins("version https://git-lfs") {
            Self::LfsPointer
        } else if begins("<!doctype html") || begins("<html") || begins("<head") {
            Self::Html
        } else if text.starts_with(['{', '[']) {
            Self::Json
        } else if is_table(text) {
            Self::Table
        } else {
            Self::Text
        }
    }

    /// Advice for such a file; empty if there is none.
    pub const fn advice(self) -> &'static str {
        match self {
            Self::Empty => "copy or download it again",
            Self::Zip | Self::Gzip | Self::Tar => "unpack it",
            Self::LfsPointer => "run `git lfs pull` in its repository",
            Self::Html => {
                "a page of a web site was saved instead of the file: download the raw file"
            }
            Self::Utf16 => "save it as UTF-8",
            Self::Hdf5 => "save it as csv, npy or, in MATLAB, with `-v7`",
            Self::Edf => {
                "save its eight channels of EMG as csv or npy, in Python with the package `pyedflib`, and describe them: \
                 `myointent data describe`"
            }
            Self::Xdf => {
                "save its stream of EMG as csv or npy, in Python with the package `pyxdf`, and describe it: \
                 `myointent data describe`"
            }
            _ => "",
        }
    }
}

/// Whether bytes are the header of an EDF or BDF file: its version, and its own length in bytes.
fn is_edf(bytes: &[u8]) -> bool {
    let length = bytes
        .get(184..192)
        .and_then(|field| str::from_utf8(field).ok());
    let length = length.and_then(|field| field.trim_end().parse::<u32>().ok());
    (bytes.starts_with(b"0       ") || bytes.starts_with(b"\xffBIOSEMI"))
        && length.is_some_and(|length| length >= 256 && length.is_multiple_of(256))
}

/// Whether the first lines are rows of numbers, the first of them perhaps of names.
fn is_table(text: &str) -> bool {
    let is_separator = |c: char| matches!(c, ',' | ';' | '\t' | ' ');
    let is_row = |line: &str| {
        let mut fields = line.split(is_separator).filter(|field| !field.is_empty());
        fields
            .next()
            .is_some_and(|first| first.parse::<f64>().is_ok())
            && fields
                .next()
                .is_some_and(|second| second.parse::<f64>().is_ok())
    };
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let first = lines.next().unwrap_or_default();
    is_row(first) || first.contains(is_separator) && lines.next().is_some_and(is_row)
}

impl fmt::Display for FileKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.advice() {
            "" => f.write_str(self.name()),
            advice => write!(f, "{}: {advice}", self.name()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_told_apart_by_their_first_bytes() {
        let lfs = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 5\n";
        for (bytes, kind) in [
            (&b""[..], FileKind::Empty),
            (b"myointnt\x03", FileKind::Model),
            (b"\x93NUMPY\x01\x00", FileKind::Npy),
            (b"MATLAB 5.0 MAT-file", FileKind::Mat),
            (b"\x89HDF\r\n\x1a\n", FileKind::Hdf5),
            (b"PK\x03\x04", FileKind::Zip),
            (b"\x1f\x8b\x08", FileKind::Gzip),
            (&[&[b'a'; 257], &b"ustar"[..]].concat(), FileKind::Tar),
            (lfs.as_bytes(), FileKind::LfsPointer),
            (b"\n<!DOCTYPE html>\n<html>", FileKind::Html),
            (b"{\"a\": 1}", FileKind::Json),
            (b"g\0t\0,\0", FileKind::Utf16),
            (b"gt,emg_0\n0,1\n", FileKind::Table),
            (b"1;2;3\n4;5;6\n", FileKind::Table),
            (b"Dear reader,\nhello\n", FileKind::Text),
            (b"\x00\x01\x02\xff\xfe", FileKind::Binary),
        ] {
            assert_eq!(FileKind::of(bytes), kind, "{bytes:?}");
        }
    }

    #[test]
    fn a_biosignal_file_is_told_by_its_header_and_not_by_a_zero() {
        for start in [&b"0       "[..], b"\xffBIOSEMI"] {
            let mut bytes = [start, &[b' '; 248]].concat();
            bytes[184..188].copy_from_slice(b"2304");
            assert_eq!(FileKind::of(&bytes), FileKind::Edf);
        }
        let row = "0       1       2       3\n".repeat(20);
        assert_eq!(FileKind::of(row.as_bytes()), FileKind::Table);
        assert_eq!(FileKind::of(b"XDF:\x01\x04"), FileKind::Xdf);
        assert!(FileKind::Edf.to_string().contains("`pyedflib`"));
        assert!(FileKind::Html.to_string().contains("raw file"));
    }

    #[test]
    fn a_character_that_the_bound_divides_is_text() {
        let text = "a".repeat(EXAMINED - 1) + "é";
        assert_eq!(FileKind::of(text.as_bytes()), FileKind::Text);
    }
}
