//! Names of the people in a user's own recordings: the folder is the person.
//!
//! The path below the requested folder names the person, without what all paths begin with. Folders that are named like
//! a session belong to the folder above them, and so does everything below a folder with recordings; but a folder after
//! which `myointent record` named its files is a person's. Files directly in
//! the requested folder belong to a person of its name. Every choice is reported.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use super::session::{SessionName, session};
use crate::catalogue::DataSet;
use crate::readers::path::{is_number, stem};
use crate::recording::Recording;

/// Maximum number of names in one sentence.
const SHOWN: usize = 6;

/// Names the people of the user's own recordings in or below a folder, but of files that `is_named`; returns sentences on
/// the choices.
pub(super) fn by_folder(
    base: &Path,
    recordings: &mut [Recording],
    is_named: &dyn Fn(&Path) -> bool,
) -> Vec<String> {
    let own: Vec<usize> = (0..recordings.len())
        .filter(|&at| is_own(recordings[at].data_set) && !is_named(&recordings[at].path))
        .collect();
    let mut places: Vec<Folders> = own
        .iter()
        .map(|&at| Folders::of(base, &recordings[at].path))
        .collect();
    if places.is_empty() {
        return Vec::new();
    }
    let shared = without_shared(&mut places);
    places.iter_mut().for_each(Folders::leave_sessions);
    join_below(&mut places);
    let taken: BTreeSet<String> = places.iter().map(Folders::person).collect();
    let top = base.join(shared);
    let is_named = |place: &Folders| place.person.is_empty() && place.names_files;
    let own_name = top.file_name().filter(|_| places.iter().any(is_named));
    let top = name_of(&top, own_name, &taken);
    let prefixes = prefixes(&places, own.iter().map(|&at| &recordings[at]));
    for (&at, place) in own.iter().zip(&places) {
        let recording = &mut recordings[at];
        let set = recording.data_set.name();
        let person = match (place.person(), prefix(&recording.path)) {
            (folder, _) if !folder.is_empty() => folder,
            (_, Some(prefix)) if prefixes && place.sessions.is_empty() => prefix.to_owned(),
            _ => top.clone(),
        };
        recording.subject = format!("{set}/{person}");
        let file = recording.path.file_stem().unwrap_or_default();
        // The number of a piece behind a gap.
        let whole = recording.name.rsplit('/').next().unwrap_or_default();
        let piece = whole.strip_prefix(&*file.to_string_lossy());
        let file = text(file) + piece.unwrap_or_default();
        recording.name = place.name(&file);
    }
    let people: BTreeSet<&str> = own.iter().map(|&at| person(&recordings[at])).collect();
    told(&people, &places, prefixes)
}

/// Whether no publication names the people of a set's recordings.
fn is_own(set: DataSet) -> bool {
    matches!(set, DataSet::OWN | DataSet::SYNTHETIC)
}

fn above(path: &Path) -> &Path {
    path.parent().unwrap_or(path)
}

/// A name as text. One that is no Unicode is escaped, so that two names never become one.
fn text(name: &OsStr) -> String {
    name.to_str()
        .map_or_else(|| format!("{name:?}"), str::to_owned)
}

/// Folders of a recording below the requested one.
struct Folders {
    /// Folders that name the person.
    person: Vec<String>,
    /// Folders that name a session.
    sessions: Vec<String>,
    /// Whether the recorder named the file after its folder.
    names_files: bool,
}

impl Folders {
    fn of(base: &Path, path: &Path) -> Self {
        let below = above(path).strip_prefix(base).unwrap_or(Path::new(""));
        Self {
            person: below.iter().map(text).collect(),
            sessions: Vec::new(),
            names_files: is_named_after_folder(path),
        }
    }

    /// Takes out the folders that are named like sessions.
    fn leave_sessions(&mut self) {
        let mut last = Vec::new();
        while let Some(name) = self.person.last().filter(|_| !self.names_files) {
            let leaves = match session(name) {
                Some(SessionName::Time | SessionName::Part | SessionName::Container) => true,
                // Numbers below a folder are sessions; at the top they are people.
                Some(SessionName::Number) => self.person.len() > 1,
                None => false,
            };
            if !leaves {
                break;
            }
            last.extend(self.person.pop());
        }
        let is_time = |name: &&String| session(name) == Some(SessionName::Time);
        let first = self.person.iter().take_while(is_time).count();
        self.sessions.extend(self.person.drain(..first));
        self.sessions.extend(last.into_iter().rev());
    }

    fn person(&self) -> String {
        self.person.join("/")
    }

    /// Name of a recording among the person's.
    fn name(&self, file: &str) -> String {
        let folders = self.sessions.iter().map(String::as_str);
        folders.chain([file]).collect::<Vec<_>>().join("/")
    }
}

/// Takes out the folders that all paths begin with, but for the last folder of a path, and returns them.
fn without_shared(places: &mut [Folders]) -> PathBuf {
    let mut shared = PathBuf::new();
    while let Some(first) = places[0].person.first().cloned() {
        let begins = |place: &Folders| place.person.len() > 1 && place.person[0] == first;
        if !places.iter().all(begins) {
            break;
        }
        shared.push(first);
        for place in &mut *places {
            place.person.remove(0);
        }
    }
    shared
}

/// Assigns everything below a folder with recordings to that folder's person.
fn join_below(places: &mut [Folders]) {
    let direct: BTreeSet<Vec<String>> = places.iter().map(|own| own.person.clone()).collect();
    for place in places {
        let end = (1..place.person.len()).find(|&end| direct.contains(&place.person[..end]));
        if let Some(end) = end {
            let below = place.person.split_off(end);
            place.sessions.splice(0..0, below);
        }
    }
}

/// Whether a file has the recorder's name, `anna_20261128T084900Z_quick_1.csv`, in a folder `anna`.
fn is_named_after_folder(path: &Path) -> bool {
    let folder = above(path).file_name().and_then(OsStr::to_str);
    let rest = folder.and_then(|folder| stem(path)?.strip_prefix(folder)?.strip_prefix('_'));
    let began = rest.and_then(|rest| rest.split('_').next()).unwrap_or("");
    began.len() == 16 && session(began) == Some(SessionName::Time)
}

/// Name of the person of the requested folder: `own_name`, or that of the nearest folder that may be a person's.
fn name_of(base: &Path, own_name: Option<&OsStr>, taken: &BTreeSet<String>) -> String {
    let names = base.ancestors().filter_map(Path::file_name).map(text);
    let is_person =
        |name: &String| !matches!(session(name), Some(SessionName::Time | SessionName::Part));
    let mut names = names.skip_while(|name| !is_person(name));
    let name = own_name.map(text).or_else(|| names.next());
    let name = name.unwrap_or_else(|| "unknown".to_owned());
    if taken.contains(&name) {
        return format!("{name}/.");
    }
    name
}

/// Whether the names of the files in the requested folder tell several people apart: `s3_grasp_1.csv`.
fn prefixes<'r>(places: &[Folders], recordings: impl Iterator<Item = &'r Recording>) -> bool {
    let loose = places.iter().zip(recordings);
    let loose = loose.filter(|(place, _)| place.person.is_empty() && place.sessions.is_empty());
    let found: Vec<Option<&str>> = loose.map(|(_, own)| prefix(&own.path)).collect();
    found.iter().all(Option::is_some) && found.iter().collect::<BTreeSet<_>>().len() > 1
}

/// Prefix that names a person: `s3` of `s3_grasp_1.csv`.
fn prefix(path: &Path) -> Option<&str> {
    let (first, _) = stem(path)?.split_once('_')?;
    let numbered = first.strip_prefix(['s', 'S']).is_some_and(is_number);
    numbered.then_some(first)
}

/// Sentences on the choices.
fn told(people: &BTreeSet<&str>, places: &[Folders], prefixes: bool) -> Vec<String> {
    let by = if prefixes { "file name" } else { "folder" };
    let mut told = vec![format!(
        "people: {}, by {by}: {}",
        people.len(),
        listed(people.iter().copied())
    )];
    let sessions = places.iter().flat_map(|place| &place.sessions);
    let sessions: BTreeSet<&str> = sessions.map(String::as_str).collect();
    if !sessions.is_empty() {
        told.push(format!(
            "folders taken as sessions, not as people: {}",
            listed(sessions.into_iter())
        ));
    }
    let mut last: BTreeMap<String, BTreeSet<&str>> = BTreeMap::new();
    let mut groups: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for &person in people {
        let (group, name) = person.rsplit_once('/').unwrap_or(("", person));
        last.entry(name.trim().to_lowercase())
            .or_default()
            .insert(person);
        if !group.is_empty() {
            groups.entry(group).or_default().insert(person);
        }
    }
    for same in last.into_values().filter(|same| same.len() > 1) {
        told.push(format!(
            "counted as different people, though their folders have one name: {}; if they are one person, put them \
             into one folder",
            listed(same.into_iter())
        ));
    }
    for (group, people) in groups.into_iter().filter(|(_, people)| people.len() > 1) {
        told.push(format!(
            "counted as different people, because {group} holds no recording itself: {}; if they are sessions of one \
             person, name the folders session_1, session_2 or by date",
            listed(people.into_iter())
        ));
    }
    told
}

/// Sentence on the recordings that a description describes; `None` without such recordings.
pub(super) fn described<'r>(
    file: &Path,
    recordings: impl Iterator<Item = &'r Recording>,
) -> Option<String> {
    let all: Vec<&str> = recordings.map(person).collect();
    let people: BTreeSet<&str> = all.iter().copied().collect();
    (!all.is_empty()).then(|| {
        format!(
            "as {} describes them: {} recordings of {} people: {}",
            file.display(),
            all.len(),
            people.len(),
            listed(people.into_iter())
        )
    })
}

/// Person of a recording, without the data set.
fn person(recording: &Recording) -> &str {
    let (_, person) = recording.subject.split_once('/').unwrap_or_default();
    person
}

fn listed<'n>(names: impl ExactSizeIterator<Item = &'n str>) -> String {
    let more = if names.len() > SHOWN { ", ..." } else { "" };
    let names: Vec<&str> = names.take(SHOWN).collect();
    names.join(", ") + more
}

#[cfg(test)]
mod tests;
