//! Why a file is passed over without an error.

use std::fmt;

/// Why a file is not read.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Why {
    /// The ending is not that of recordings: licences, notes, settings.
    Ending,
    /// The content is in none of the layouts.
    Layout,
    /// Eight channels, but of no known set, and labels or person are unknown.
    UnknownSet,
    /// The data set is not wanted.
    NotWanted,
    /// It is another copy of what is read: untrimmed, or a copy of another person's file.
    Copy,
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Ending => "no npy, csv, txt, dat, json or mat",
            Self::Layout => "in none of the layouts",
            Self::UnknownSet => {
                "eight channels, but of no known set and without labels: give such a file by itself"
            }
            Self::NotWanted => "of a data set that is not asked for",
            Self::Copy => "a copy of another file",
        })
    }
}
