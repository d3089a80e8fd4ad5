//! All recordings below a path.

pub mod inspection;
mod names;
mod people;
pub(crate) mod session;

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use shared::stream::normalizer::Normalizer;

use super::catalogue::DataSet;
use super::description::{Described, FILE_NAME};
use super::examiner::copies::{self, Repeat};
use super::examiner::examine;
use super::labels::timing;
use super::readers::error::excerpt::excerpt;
use super::readers::error::{Damage, LoadError};
use super::readers::open::{Found, OpenRequest, SkipReason, of_bytes, open};
use super::readers::path::{ending, left_arm};
use super::recording::Recording;
use crate::examiner::finding::{Finding, grouped};
use execution::printable::printable;

/// Options of [`load`].
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct LoadOptions {
    /// Whether to stop at the first damaged file, rather than leave damaged files out and list them.
    pub strict: bool,
    /// Data sets to read, files of others are ignored; all if empty.
    pub data_sets: Vec<DataSet>,
    /// Whether the channels of published sets stay in their own order, rather than be turned into the
    /// [common frame](Library::frames), in which models are trained.
    pub as_recorded: bool,
}

/// Recordings below one path, and what was found beside them.
#[derive(Debug, Default)]
pub struct Library {
    /// The recordings, ordered by path.
    pub recordings: Vec<Recording>,
    /// Errors of the damaged or unreadable files that were left out; empty with [`LoadOptions::strict`].
    pub skipped: Vec<LoadError>,
    /// Recordings left out because another holds the same samples.
    pub repeats: Vec<Repeat>,
    /// Files that are not read: no recordings (licences, notes, settings), or of no wanted data set.
    pub ignored: Vec<Ignored>,
    /// Sentences on how people were named if no publication names them.
    pub people: Vec<String>,
    /// Whether channels were turned into the common frame.
    pub in_common_frame: bool,
}

/// A file that is not read.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Ignored {
    /// The file.
    pub path: PathBuf,
    /// Reason why it is not read.
    pub reason: SkipReason,
}

/// Reads every recording at or below a path: a folder of many sets, one set, or one file.
///
/// A single file of eight channels is read whatever set it is of; in a folder, a file is read only if its layout
/// says what it is, or a [description](crate::description) in the folder or above it. The path may be a description's
/// own. No file of more than 128 MiB is read, and nothing but regular files.
///
/// # Errors
/// [`LoadError::Description`] for a description that cannot be used; [`LoadError::Damaged`] or [`LoadError::Io`] at the first damaged or unreadable file in path order with
/// [`LoadOptions::strict`]; [`LoadError::NoRecordings`] if none is found; [`LoadError::Io`] if the path
/// itself cannot be read.
pub fn load(path: &Path, options: &LoadOptions) -> Result<Library, LoadError> {
    load_all(&[path], options)
}

/// Reads what lies at or below several paths as [`load`] reads one. Copies and wearers are found across all, as if one
/// folder held them.
///
/// # Errors
/// Errors of [`load`] for each path; of several, also if all of one is left out.
pub fn load_all(paths: &[impl AsRef<Path>], options: &LoadOptions) -> Result<Library, LoadError> {
    let mut library = Library::default();
    for path in paths {
        let own = read(path.as_ref(), options)?;
        if paths.len() > 1 {
            own.not_empty(path.as_ref())?;
        }
        library.recordings.extend(own.recordings);
        library.skipped.extend(own.skipped);
        library.repeats.extend(own.repeats);
        library.ignored.extend(own.ignored);
        library.people.extend(own.people);
    }
    if paths.len() > 1 {
        // A folder and a file in it.
        let mut seen = HashSet::new();
        let recordings = &mut library.recordings;
        recordings.retain(|own| seen.insert((own.path.clone(), own.full_name())));
        for own in &mut *recordings {
            own.findings
                .retain(|found| found.kind != copies::OVERLAP_KIND);
        }
        library.repeats.extend(copies::leave_out(recordings));
    }
    library.finish(options);
    Ok(library)
}

/// Reads one file from its bytes, as [`load`] reads a single file; its set is known by its name and content alone.
///
/// # Errors
/// [`LoadError::Damaged`] if it is damaged or a recording in it has no meaning; [`LoadError::NoRecordings`] if none is found.
pub fn load_bytes(name: &Path, bytes: &[u8], options: &LoadOptions) -> Result<Library, LoadError> {
    let request = OpenRequest {
        data_sets: &options.data_sets,
        alone: true,
    };
    let mut library = Library::default();
    match of_bytes(name, bytes, &request)? {
        Found::Recordings(recordings) => library.recordings = recordings,
        Found::Part => {}
        Found::Nothing(reason) => library.ignored.push(Ignored {
            path: name.to_owned(),
            reason,
        }),
    }
    if library.recordings.is_empty() {
        return Err(no_recordings(name, &library));
    }
    library.examine(true)?;
    library.finish(options);
    Ok(library)
}

/// Reads what lies at or below a path, each recording by itself.
fn read(path: &Path, options: &LoadOptions) -> Result<Library, LoadError> {
    let is_description = ending(path).as_deref() == Some("toml");
    let given = is_description.then(|| Described::read(path)).transpose()?;
    let (root, files) = files(given.as_ref().map_or(path, |given| &given.folder))?;
    let described = Described::of_files(given, &root, &files)?;
    let alone = !root.is_dir();
    let request = OpenRequest {
        data_sets: &options.data_sets,
        alone,
    };
    let found: Vec<Result<_, LoadError>> = files
        .into_par_iter()
        .filter(|file| !file.as_ref().is_ok_and(|file| file.ends_with(FILE_NAME)))
        .map(|file| {
            let file = file?;
            let found = match Described::governing(&described, &file) {
                Some(described) => described.open(&file, &request)?,
                None => open(&file, &request)?,
            };
            Ok((file, found))
        })
        .collect();
    let mut library = Library::default();
    for found in found {
        match found {
            Ok((_, Found::Recordings(recordings))) => library.recordings.extend(recordings),
            Ok((_, Found::Part)) => {}
            Ok((path, Found::Nothing(reason))) => library.ignored.push(Ignored { path, reason }),
            Err(error) if !(options.strict || alone && error.is_refusal()) => {
                library.skipped.push(error);
            }
            Err(error) => return Err(error),
        }
    }
    if library.recordings.is_empty() && library.skipped.is_empty() {
        return Err(no_recordings(path, &library));
    }
    let folder = if alone { root.parent() } else { None };
    let folder = folder.unwrap_or(&root);
    // By the description where its pattern has the person, else by folder.
    let is_named = |file: &Path| {
        Described::governing(&described, file).is_some_and(|own| own.names_person_of(file))
    };
    people::by_folder(folder, &mut library.recordings, &is_named);
    library.repeats = copies::leave_out(&mut library.recordings);
    library.examine(options.strict)?;
    // Named again without the copies, so that nobody is named after one.
    library.people = people::by_folder(folder, &mut library.recordings, &is_named);
    let told = described.iter().filter_map(|described| {
        let own = |own: &&Recording| described.fields_of(&own.path).is_some();
        people::described(&described.file, library.recordings.iter().filter(own))
    });
    library.people.extend(told.collect::<Vec<_>>());
    names::make_unique(&mut library.recordings);
    Ok(library)
}

impl Library {
    /// Does what needs all recordings. Copies are found before, among samples as they were recorded, in whatever set.
    fn finish(&mut self, options: &LoadOptions) {
        if !options.as_recorded {
            self.turn();
        }
        self.follow_wearers();
        timing::find(&mut self.recordings);
    }

    /// Subjects, each once, in alphabetical order.
    pub fn subjects(&self) -> Vec<String> {
        let mut subjects: Vec<_> = self.recordings.iter().map(|r| r.subject.clone()).collect();
        subjects.sort_unstable();
        subjects.dedup();
        subjects
    }

    /// Subjects of a name (`data-set/subject`, or the part after the slash); all without one.
    pub fn named(&self, name: Option<&str>) -> Vec<String> {
        let mut subjects = self.subjects();
        subjects.retain(|own| {
            let after = own.split_once('/').map(|(_, after)| after);
            name.is_none_or(|name| own == name || after == Some(name))
        });
        subjects
    }

    /// Findings in the recordings with their names, in path order; then those of the copies left out, with their paths.
    pub fn findings(&self) -> impl Iterator<Item = (String, &Finding)> {
        let recordings = self.recordings.iter();
        let found = recordings.flat_map(|recording| {
            let findings = recording.findings.iter();
            findings.map(|finding| (recording.full_name(), finding))
        });
        let repeats = self.repeats.iter();
        found.chain(repeats.map(|repeat| (repeat.path.display().to_string(), &repeat.finding)))
    }

    /// Refuses a library in which no recording is left.
    pub fn not_empty(&self, path: &Path) -> Result<(), LoadError> {
        match self.skipped.first() {
            Some(first) if self.recordings.is_empty() => Err(LoadError::NoneLeft {
                path: path.to_owned(),
                skipped: self.skipped.len(),
                first: first.line(),
            }),
            _ => Ok(()),
        }
    }

    /// Sentences on the files that were left out and on the doubts about the recordings, equal findings in one.
    pub fn doubts(&self) -> Vec<String> {
        let left_out = self.skipped.first().map(|first| {
            let count = self.skipped.len();
            let first = first.line();
            format!(
                "files left out: {count} (`myointent data inspect` lists them); the first: {first}"
            )
        });
        let findings = grouped(self.findings());
        let findings = findings.iter().map(|group| printable(&group.to_string()));
        left_out.into_iter().chain(findings).collect()
    }

    /// Examines each recording; one without meaning is left out.
    fn examine(&mut self, strict: bool) -> Result<(), LoadError> {
        let recordings = std::mem::take(&mut self.recordings).into_par_iter();
        let examined: Vec<Result<Recording, LoadError>> = recordings
            .map(|mut recording| match examine(&recording) {
                Ok(findings) => {
                    recording.findings.extend(findings);
                    Ok(recording)
                }
                Err(finding) => Err(Damage::from(finding).in_file(&recording.path)),
            })
            .collect();
        for recording in examined {
            match recording {
                Ok(recording) => self.recordings.push(recording),
                Err(error) if strict => return Err(error),
                Err(error) => self.skipped.push(error),
            }
        }
        Ok(())
    }

    /// Carries the normalization of a wearer from one recording to the next, in path order: many recordings last only a
    /// few seconds. A person's two arms are two wearers.
    fn follow_wearers(&mut self) {
        let mut wearers: HashMap<(String, bool), Normalizer> = HashMap::new();
        for recording in &mut self.recordings {
            let arm = (recording.subject.clone(), left_arm(&recording.path));
            let wearer = wearers.entry(arm).or_default();
            recording.wearer = *wearer;
            for &sample in &recording.samples {
                wearer.push(sample);
            }
        }
    }
}

/// Error of a library without recordings at a path: the files that were passed over, by reason.
fn no_recordings(path: &Path, library: &Library) -> LoadError {
    let ignored = inspection::ignored(library).into_iter();
    let told = ignored.map(|own| {
        let first = own.first.file_name().unwrap_or_default().to_string_lossy();
        format!("{} {}, such as {}", own.files, own.what, excerpt(&first))
    });
    let told: Vec<String> = told.collect();
    let found = match &told[..] {
        [] => "no file".to_owned(),
        told => told.join("; "),
    };
    LoadError::NoRecordings {
        path: path.to_owned(),
        found,
    }
}

/// The path, absolute so that folder names are known, and the files at or below it in path order, or why one cannot be
/// read.
pub(crate) fn files(path: &Path) -> Result<(PathBuf, Vec<Result<PathBuf, LoadError>>), LoadError> {
    let root = dunce::canonicalize(path).map_err(|source| LoadError::io(path, source))?;
    let mut files = Vec::new();
    for entry in walkdir::WalkDir::new(&root)
        .follow_links(true)
        .sort_by_file_name()
    {
        match entry {
            // Devices and pipes are listed too: reading refuses them by name.
            Ok(entry) if !entry.file_type().is_dir() => files.push(Ok(entry.into_path())),
            Ok(_) => {}
            // A dangling link, a circle of links, or an unreadable folder.
            Err(error) => {
                let path = error.path().unwrap_or(path).to_owned();
                files.push(Err(LoadError::Io {
                    path,
                    source: error.into(),
                }));
            }
        }
    }
    Ok((root, files))
}

#[cfg(test)]
pub(crate) mod tests;
