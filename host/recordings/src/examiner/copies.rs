//! Copies: the same samples in several recordings are counted once.
//!
//! A recording is cut where two rows have a certain hash, so that equal samples are cut at equal places wherever they
//! begin. A piece that another recording has too is a repeat: equal rows of that length never occur by chance. Pieces
//! of which most rows do not change are dropped, so constant recordings are no copies.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::ops::Range;
use std::path::{Path, PathBuf};

use shared::units::{SAMPLE_RATE_HZ, Sample};

use crate::examiner::finding::Finding;
use crate::recording::Recording;

/// Average number of pairs of rows from one cut to the next.
const PAIRS: u64 = 64;
/// Minimum number of rows of a piece.
const LEAST: usize = 16;
/// Share of a recording's rows in pieces that others have too, from which it is a copy.
const COPY: f64 = 0.8;
/// Minimum number of rows in pieces that are needed to judge a copy.
const ENOUGH: usize = 150;
/// Rows in common with another recording from which an overlap is reported.
const OVERLAP: usize = 400;
/// Kind of the finding of an overlap.
pub(crate) const OVERLAP_KIND: &str = "overlap";
/// Parts of names in lower case that mark a copy's path.
#[rustfmt::skip]
const MARKS: [&str; 8] = [
    "copy", "kopie", "backup", "conflict", "checkpoint", "(1)", "~", "trash",
];

/// A recording left out because its samples are another one's.
#[derive(Clone, PartialEq, Debug)]
pub struct Repeat {
    /// The file left out.
    pub path: PathBuf,
    /// Finding that names the file kept and the differences.
    pub finding: Finding,
}

/// Leaves out copies, and adds findings of overlaps. The order of the other recordings stays.
pub(crate) fn leave_out(recordings: &mut Vec<Recording>) -> Vec<Repeat> {
    let mut order: Vec<usize> = (0..recordings.len()).collect();
    order.sort_by_cached_key(|&at| {
        let recording = &recordings[at];
        (
            !recording.has_labels(),
            std::cmp::Reverse(recording.samples.len()),
            marks(&recording.path),
            recording.path.components().count(),
            at,
        )
    });
    let mut owners: HashMap<u64, usize> = HashMap::new();
    let mut left_out: HashMap<usize, Finding> = HashMap::new();
    for at in order {
        let pieces = pieces(&recordings[at].samples);
        let rows: usize = pieces.iter().map(|(piece, _)| piece.len()).sum();
        let mut shared: HashMap<usize, usize> = HashMap::new();
        for (piece, hash) in &pieces {
            let owner = *owners.entry(*hash).or_insert(at);
            if owner != at {
                *shared.entry(owner).or_default() += piece.len();
            }
        }
        let all: usize = shared.values().sum();
        let Some((&owner, &most)) = shared
            .iter()
            .max_by_key(|(owner, rows)| (**rows, std::cmp::Reverse(**owner)))
        else {
            continue;
        };
        if rows >= ENOUGH && all as f64 >= COPY * rows as f64 {
            let finding = copy(&recordings[at], &recordings[owner]);
            left_out.insert(at, finding);
        } else if most >= OVERLAP {
            let what = format!(
                "{:.0} s of its samples are also in {}",
                most as f64 / f64::from(SAMPLE_RATE_HZ),
                recordings[owner].path.display()
            );
            let advice = "remove one of the two: a gesture would count twice";
            let finding = Finding::warning(OVERLAP_KIND, what, advice);
            recordings[at].findings.push(finding);
        }
    }
    let mut repeats = Vec::new();
    let mut at = 0;
    recordings.retain(|recording| {
        let finding = left_out.remove(&at);
        at += 1;
        let keep = finding.is_none();
        repeats.extend(finding.map(|finding| Repeat {
            path: recording.path.clone(),
            finding,
        }));
        keep
    });
    repeats
}

fn copy(copy: &Recording, kept: &Recording) -> Finding {
    let has_other_labels = copy.samples == kept.samples && copy.labels != kept.labels;
    let is_of_other = person(copy) != person(kept) && marks(&copy.path) <= marks(&kept.path);
    let labels = has_other_labels.then_some(", with other labels");
    let person = is_of_other.then_some(", under another person's name");
    let what = format!(
        "the same samples as in {}{}{}, left out",
        kept.path.display(),
        labels.unwrap_or_default(),
        person.unwrap_or_default()
    );
    let advice = if is_of_other {
        "one of the names is wrong: remove the copy that is"
    } else {
        "remove the copy"
    };
    Finding::warning("copy", what, advice).serious_if(is_of_other)
}

/// Last folder of a person's name: `anna` of `backup/anna`.
fn person(recording: &Recording) -> Option<&str> {
    recording.subject.rsplit('/').next()
}

/// Number of names in a path that mark a copy: hidden ones, and those with one of the marks.
fn marks(path: &Path) -> usize {
    let marked = |name: &&OsStr| {
        let name = name.to_string_lossy().to_lowercase();
        name.starts_with('.') || MARKS.iter().any(|mark| name.contains(mark))
    };
    path.iter().filter(|name| marked(name)).count()
}

/// Pieces that lie whole in a recording, and their hashes.
fn pieces(samples: &[Sample]) -> Vec<(Range<usize>, u64)> {
    let mut ends = (1..samples.len()).filter(|&row| {
        let pair = [samples[row - 1], samples[row]];
        pair[0] != pair[1] && hash(&pair).is_multiple_of(PAIRS)
    });
    let mut pieces = Vec::new();
    let Some(mut from) = ends.next() else {
        return pieces;
    };
    for end in ends {
        let rows = &samples[from..end];
        let changes = rows.windows(2).filter(|pair| pair[0] != pair[1]).count();
        if rows.len() >= LEAST && 2 * changes >= rows.len() {
            pieces.push((from..end, hash(rows)));
        }
        from = end;
    }
    pieces
}

fn hash(rows: &[Sample]) -> u64 {
    let mut hasher = DefaultHasher::new();
    rows.hash(&mut hasher);
    hasher.finish()
}
