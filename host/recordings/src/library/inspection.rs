//! Contents of a library by data set, and its findings: `myointent data inspect`.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use shared::units::SAMPLE_RATE_HZ;

use super::Library;
use crate::catalogue::DataSet;
use crate::examiner::electrodes::saturation;
use crate::examiner::finding::{Finding, Group, grouped};
use crate::labels::lag::{self, LabelLag, LagEstimate};
use crate::labels::runs::{Run, runs};
use crate::labels::set_lag::Lag;
use crate::readers::error::LoadError;
use crate::recording::{Recording, by_data_set};
use crate::split::predefined;

/// Contents of one data set.
#[derive(Clone, PartialEq, Debug, serde::Serialize)]
pub struct SetInspection {
    /// The data set.
    pub data_set: DataSet,
    /// Number of people.
    pub subjects: usize,
    /// Number of recordings.
    pub recordings: usize,
    /// Seconds of all recordings.
    pub seconds: f64,
    /// Seconds by intent; an intent that does not occur is left out.
    pub seconds_by_intent: BTreeMap<&'static str, f64>,
    /// Seconds of movement that is none of the six intents.
    pub seconds_other_movement: f64,
    /// Seconds without a label, other movement not counted.
    pub seconds_unlabelled: f64,
    /// Changes from one labelled intent straight to another.
    pub transitions: usize,
    /// Largest share of one channel's samples in one recording at the ends of the range.
    pub worst_saturation: f64,
    /// Lag of the muscle after the labels, over all subjects; none without a transition to measure it at.
    pub label_lag: Option<LagEstimate>,
    /// Lag compensation of the labels in an evaluation.
    pub labels: Lag,
}

/// Files of one kind: of a data set, or not read for one reason.
#[derive(Clone, PartialEq, Eq, Debug, serde::Serialize)]
pub struct Files {
    /// The data set whose reader took them, or why none did.
    pub what: String,
    /// Properties that they are recognised by; empty for files that are not read.
    pub recognised_by: &'static str,
    /// Their number.
    pub files: usize,
    /// The first of them in path order.
    #[serde(serialize_with = "lossy")]
    pub first: PathBuf,
}

/// A path as text: one that is no Unicode is no reason to tell nothing.
fn lossy<S: serde::Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&path.display())
}

/// Contents of a library, and its findings.
#[derive(Clone, PartialEq, Debug, serde::Serialize)]
pub struct Inspection {
    /// Contents by data set.
    pub sets: Vec<SetInspection>,
    /// Findings in the recordings, grouped.
    pub findings: Vec<Group>,
    /// Messages on files that are left out: damaged, unreadable or without meaning.
    pub skipped: Vec<String>,
    /// Files by the reader that took them.
    pub taken: Vec<Files>,
    /// Files that no reader took, by reason.
    pub ignored: Vec<Files>,
    /// Sentences on how people were named.
    pub people: Vec<String>,
}

impl Inspection {
    /// Counts and findings of a library.
    pub fn new(library: &Library) -> Self {
        Self {
            sets: by_data_set(&library.recordings)
                .into_iter()
                .map(|(set, recordings)| inspect(set, &recordings))
                .collect(),
            findings: groups(library),
            skipped: library.skipped.iter().map(LoadError::line).collect(),
            taken: taken(library),
            ignored: ignored(library),
            people: library.people.clone(),
        }
    }
}

fn taken(library: &Library) -> Vec<Files> {
    let recordings = library.recordings.iter();
    let paths = recordings.map(|own| (own.data_set, &*own.path));
    files(paths, |set| (set.name().to_owned(), set.recognised_by()))
}

/// Files that no reader took, by reason.
pub(super) fn ignored(library: &Library) -> Vec<Files> {
    let paths = library.ignored.iter().map(|own| (own.reason, &*own.path));
    files(paths, |why| (why.name().to_owned(), ""))
}

/// Files by their kind, given with their paths.
fn files<'p, K: Ord>(
    paths: impl Iterator<Item = (K, &'p Path)>,
    describe: impl Fn(K) -> (String, &'static str),
) -> Vec<Files> {
    let mut by_kind: BTreeMap<K, BTreeSet<&Path>> = BTreeMap::new();
    for (kind, path) in paths {
        by_kind.entry(kind).or_default().insert(path);
    }
    let files = |(kind, paths): (K, BTreeSet<&Path>)| {
        let (what, recognised_by) = describe(kind);
        Some(Files {
            what,
            recognised_by,
            files: paths.len(),
            first: paths.first()?.to_path_buf(),
        })
    };
    by_kind.into_iter().filter_map(files).collect()
}

fn inspect(data_set: DataSet, recordings: &[&Recording]) -> SetInspection {
    let mut counts: BTreeMap<&'static str, usize> = BTreeMap::new();
    let (mut unlabelled, mut other, mut transitions) = (0, 0, 0);
    for recording in recordings {
        let movements = recording.other_movement.iter();
        other += movements.map(|own| own.samples.len()).sum::<usize>();
        let runs = runs(&recording.labels);
        for run in &runs {
            match run.label {
                Some(intent) => *counts.entry(intent.name()).or_default() += run.samples(),
                None => unlabelled += run.samples(),
            }
        }
        let straight = |pair: &&[Run]| pair.iter().all(|run| run.label.is_some());
        transitions += runs.windows(2).filter(straight).count();
    }
    let seconds = |samples: usize| samples as f64 / f64::from(SAMPLE_RATE_HZ);
    let subjects: BTreeSet<&String> = recordings.iter().map(|own| &own.subject).collect();
    let saturation = recordings.iter().flat_map(|own| saturation(&own.samples));
    SetInspection {
        data_set,
        subjects: subjects.len(),
        recordings: recordings.len(),
        seconds: recordings.iter().map(|r| r.seconds()).sum(),
        seconds_by_intent: counts
            .into_iter()
            .map(|(intent, samples)| (intent, seconds(samples)))
            .collect(),
        seconds_other_movement: seconds(other),
        seconds_unlabelled: seconds(unlabelled.saturating_sub(other)),
        transitions,
        worst_saturation: saturation.fold(0.0, f64::max),
        label_lag: lag::estimate(recordings),
        labels: Lag::of(
            data_set,
            recordings,
            LabelLag::default(),
            &predefined::is_training,
        ),
    }
}

/// Findings in the recordings of a library and known limits of their sets, grouped: the worst first.
pub(crate) fn groups(library: &Library) -> Vec<Group> {
    let recordings = library.recordings.iter();
    let notes = recordings.flat_map(|recording| {
        let notes = recording.notes.iter();
        notes.map(|note| (recording.full_name(), Finding::known(note)))
    });
    let notes: Vec<(String, Finding)> = notes.collect();
    let known = notes.iter().map(|(whose, note)| (whose.clone(), note));
    grouped(library.findings().chain(known))
}

#[cfg(test)]
mod tests {
    use shared::units::CHANNELS;

    use super::*;
    use crate::fixture::{C, R};
    use crate::library::Ignored;
    use crate::readers::open::SkipReason;
    use crate::{Movement, MovementKind};

    fn ignored(path: &str, reason: SkipReason) -> Ignored {
        let path = path.into();
        Ignored { path, reason }
    }

    fn library() -> Library {
        let sample = |at: usize| {
            let mut sample = [at as i8 % 7; CHANNELS];
            sample[2] = 0;
            sample[5] = if at.is_multiple_of(10) { 127 } else { 1 };
            sample
        };
        let samples = (0..800).map(sample).collect();
        let labels = crate::fixture::labels(&[(R, 200), (C, 200), (R, 200), (None, 200)]);
        Library {
            recordings: vec![Recording {
                name: "a".into(),
                notes: vec!["known".into()],
                other_movement: vec![Movement::new(MovementKind::Point, 700..750)],
                ..Recording::new(DataSet::OWN, "own/s1", samples, labels)
            }],
            ignored: vec![
                ignored("LICENSE", SkipReason::Ending),
                ignored("notes.txt", SkipReason::Layout),
                ignored("README", SkipReason::Ending),
            ],
            ..Library::default()
        }
    }

    #[test]
    fn seconds_and_transitions_are_counted_by_label() {
        let inspection = Inspection::new(&library());
        let set = &inspection.sets[0];
        assert_eq!((set.subjects, set.recordings, set.seconds), (1, 1, 4.0));
        let expected = BTreeMap::from([("close", 1.0), ("relax", 2.0)]);
        assert_eq!(set.seconds_by_intent, expected);
        let others = (set.seconds_unlabelled, set.seconds_other_movement);
        assert_eq!(others, (0.75, 0.25));
        assert_eq!(set.transitions, 2);
        assert_eq!(set.worst_saturation, 0.1);
    }

    #[test]
    fn findings_and_notes_are_told_once_for_all_recordings() {
        let mut library = library();
        let recording = &mut library.recordings[0];
        let silent = Finding::warning("silent-channel", "channel 3 is silent", "");
        recording.findings.push(silent);
        let mut second = recording.clone();
        second.name = "b".into();
        library.recordings.push(second);
        let findings = Inspection::new(&library).findings;
        let told: Vec<_> = findings.iter().map(|f| &*f.finding.what).collect();
        assert_eq!(told, ["channel 3 is silent", "known"]);
        let both = ["own/s1/a", "own/s1/b"];
        assert!(findings.iter().all(|own| own.which == both));
    }

    #[test]
    fn every_file_is_told_with_who_took_it_or_why_nobody_did() {
        let inspection = Inspection::new(&library());
        let files = inspection.taken.iter().chain(&inspection.ignored);
        let told: Vec<_> = files
            .map(|f| (&*f.what, f.files, f.first.to_str()))
            .collect();
        let expected = [
            ("own", 1, Some("")),
            (SkipReason::Ending.name(), 2, Some("LICENSE")),
            (SkipReason::Layout.name(), 1, Some("notes.txt")),
        ];
        assert_eq!(told, expected);
        assert!(inspection.taken[0].recognised_by.contains("gt"));
    }

    #[cfg(unix)]
    #[test]
    fn a_name_that_is_no_unicode_is_told_in_json() {
        use std::os::unix::ffi::OsStrExt as _;
        let mut library = library();
        library.recordings[0].path = std::ffi::OsStr::from_bytes(b"a\xff.csv").into();
        let json = serde_json::to_string(&Inspection::new(&library)).unwrap();
        assert!(json.contains("\"first\":\"a\u{fffd}.csv\""), "{json}");
    }
}
