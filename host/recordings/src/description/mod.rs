//! Description of anybody's recordings, `recordings.toml`: which files, which columns, which labels.
//!
//! A description stands in the folder that it describes, or names it as `folder`. It takes the place of a reader: what
//! it reads goes the way of all recordings, through the examiner, the naming of people and the timing of labels.
//! [`draft`] writes a first one.

pub mod draft;
pub mod own;
mod pattern;
pub(crate) mod published;
mod reader;
pub(crate) mod repetitions;
mod rows;
mod stretched;
mod values;
mod words;

use std::path::{Path, PathBuf};

use serde::Deserialize;
use shared::stream::alignment::Alignment;
use shared::units::SAMPLE_PERIOD_MS;

use crate::readers::error::LoadError;
use crate::readers::table::separator::Separator;
use execution::bounded_read;
use pattern::{Field, Fields, Pattern};
pub(crate) use rows::labels;
use values::{Arm, Channels, Column, LabelTiming};
use words::Labels;
pub(crate) use words::Labels as Meanings;

/// Name of a description in the folder that it describes.
pub const FILE_NAME: &str = "recordings.toml";
/// Folders above a path in which its description is looked for: person, session and two more.
const ABOVE: usize = 4;

/// Description of the recordings of a folder.
#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Description {
    /// Folder of the recordings, seen from the description's own; the same if not given.
    folder: Option<PathBuf>,
    /// Paths of the recordings.
    files: Pattern,
    /// Paths of files with a label for each sample.
    label_files: Option<Pattern>,
    #[serde(default, deserialize_with = "values::separator")]
    separator: Option<Separator>,
    /// Whether the first row is names; found if not given.
    header: Option<bool>,
    /// Columns of the channels; found by their names if not given.
    channels: Option<Channels>,
    /// Column of times or sample numbers; found by its name if not given.
    time: Option<Column>,
    label: Option<Column>,
    #[serde(default)]
    labels: Labels,
    #[serde(deserialize_with = "values::rate")]
    rate: (),
    #[serde(default = "values::counts", deserialize_with = "values::scale")]
    scale: f64,
    #[serde(default, deserialize_with = "values::rectified")]
    rectified: (),
    arm: Option<Arm>,
    #[serde(default, deserialize_with = "values::rotation")]
    rotation: u8,
    #[serde(default)]
    timing: LabelTiming,
    #[serde(default, deserialize_with = "values::cue_lag")]
    cue_lag_ms: Option<u32>,
}

impl Description {
    /// Parses the text of a description; `path` is for messages.
    fn parse(path: &Path, text: &str) -> Result<Self, LoadError> {
        let error = |line, problem: String| LoadError::description(path, line, problem);
        let description: Self = toml::from_str(text).map_err(|reason| {
            let before = reason.span().and_then(|span| text.get(..span.start));
            let line = before.map(|before| before.matches('\n').count() + 1);
            error(line, reason.message().to_owned())
        })?;
        match description.contradiction() {
            Some(problem) => Err(error(None, problem)),
            None => Ok(description),
        }
    }

    /// Fields that do not go together: what was expected, found, and what to do.
    fn contradiction(&self) -> Option<String> {
        let has_gesture = self.files.has(Field::Gesture);
        let has_words = self.label.is_some() || self.label_files.is_some() || has_gesture;
        let is_by_activity = self.timing == LabelTiming::FromActivity;
        let is_named = |column: &Column| matches!(column, Column::Named(_));
        let channels = self.channels.iter().flat_map(|channels| &channels.0);
        let mut columns = channels.chain(&self.time).chain(&self.label);
        let both =
            |one, other| format!("expected one of `{one}` and `{other}`, found both: remove one");
        let needs = |field, needs, advice| format!("`{field}` needs {needs}, found none: {advice}");
        let labels_file = self.label_files.as_ref();
        if self.label.is_some() && labels_file.is_some() {
            return Some(both("label", "label_files"));
        }
        if let Some(beyond) = labels_file.and_then(|own| own.beyond(&self.files)) {
            return Some(format!(
                "expected in `label_files` fields that `files` has, found {{{}}}: a file of labels is named after its recording",
                beyond.name()
            ));
        }
        let by_hand = self.separator.is_some() || self.header.is_some();
        Some(if has_words && self.labels.is_empty() {
            needs(
                "{gesture}, `label` or `label_files`",
                "`labels`",
                "say what the words mean, or write {any} for {gesture} and leave `label` out",
            )
        } else if !has_words && !self.labels.is_empty() {
            needs(
                "labels",
                "{gesture} in `files`, `label` or `label_files`",
                "say where the words are",
            )
        } else if is_by_activity && !has_gesture {
            needs(
                "timing = \"from-activity\"",
                "{gesture} in `files`",
                "it labels one gesture a file",
            )
        } else if is_by_activity && (self.label.is_some() || labels_file.is_some()) {
            both("timing = \"from-activity\"", "label")
        } else if self.cue_lag_ms.is_some() && self.timing != LabelTiming::Cues {
            needs(
                "cue_lag_ms",
                "timing = \"cues\"",
                "other labels are not late",
            )
        } else if by_hand && self.channels.is_none() {
            needs(
                "separator` and `header",
                "`channels`",
                "without it, columns are found by their names",
            )
        } else if self.header == Some(false) && columns.any(is_named) {
            needs(
                "header = false",
                "columns by number",
                "without a header they have no names",
            )
        } else {
            return None;
        })
    }

    /// Order of the channels.
    const fn placement(&self) -> Alignment {
        values::placement(self.rotation, self.arm)
    }

    /// Lag of the muscle after the cues, in samples; none if it is to be estimated.
    fn lag_samples(&self) -> Option<usize> {
        self.cue_lag_ms.map(|lag| (lag / SAMPLE_PERIOD_MS) as usize)
    }
}

/// A description and the folder that it describes.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Described {
    /// The description's file.
    pub file: PathBuf,
    /// The folder, absolute.
    pub folder: PathBuf,
    description: Description,
    /// Names before a person's, where the folder lies within the one that was asked for.
    above: String,
}

impl Described {
    /// Descriptions of files: the one that was given, or those in the folders and above them.
    pub(crate) fn of_files(
        given: Option<Self>,
        root: &Path,
        files: &[Result<PathBuf, LoadError>],
    ) -> Result<Vec<Self>, LoadError> {
        if let Some(given) = given {
            return Ok(vec![given]);
        }
        let files = files.iter().flatten();
        let within = files.filter(|file| file.ends_with(FILE_NAME));
        let above = Self::above(root);
        let all = within
            .chain(&above)
            .map(|file| Ok(Self::read(file)?.seen_from(root)));
        all.collect()
    }

    /// The description of a file: of those whose folder it is in, the deepest.
    pub(crate) fn governing<'d>(all: &'d [Self], file: &Path) -> Option<&'d Self> {
        let own = all.iter().filter(|own| file.starts_with(&own.folder));
        own.max_by_key(|own| own.folder.components().count())
    }

    /// Reads a description.
    pub fn read(file: &Path) -> Result<Self, LoadError> {
        let text = bounded_read::read_text(file, bounded_read::PRESET);
        let text = text.map_err(|source| LoadError::io(file, source))?;
        let description = Description::parse(file, &text)?;
        let own = file.parent().unwrap_or(file);
        let given = description.folder.as_ref();
        let folder = given.map_or(own.to_owned(), |folder| own.join(folder));
        let real = dunce::canonicalize(&folder).ok();
        let missing = || {
            let at = folder.display();
            let problem = format!("expected `folder` to be a folder, found none at {at}");
            LoadError::description(file, None, problem)
        };
        let folder = real.filter(|real| real.is_dir()).ok_or_else(missing)?;
        Ok(Self {
            file: file.to_owned(),
            ..Self::new(&folder, description)
        })
    }

    /// Description in the folder that it describes.
    fn new(folder: &Path, description: Description) -> Self {
        Self {
            file: folder.join(FILE_NAME),
            folder: folder.to_owned(),
            description,
            above: String::new(),
        }
    }

    /// The description with people named as seen from a folder: `lab/anna` where it describes the folder `lab` in it.
    pub fn seen_from(self, root: &Path) -> Self {
        let below = self.folder.strip_prefix(root).unwrap_or(Path::new(""));
        let above = below.iter().map(|name| name.to_string_lossy() + "/");
        Self {
            above: above.collect(),
            ..self
        }
    }

    /// The description nearest above a path.
    pub fn above(path: &Path) -> Option<PathBuf> {
        let folders = path.ancestors().skip(1).take(ABOVE);
        folders
            .map(|folder| folder.join(FILE_NAME))
            .find(|file| file.is_file())
    }

    /// Fields of a file's path; none if the description is not about it.
    pub fn fields_of(&self, path: &Path) -> Option<Fields> {
        let below = path.strip_prefix(&self.folder).ok()?;
        let is_known = |word: &str| self.description.labels.has(word);
        self.description.files.fields_of(below, is_known)
    }

    /// Whether the path of a file names its person.
    pub fn names_person_of(&self, path: &Path) -> bool {
        let fields = self.fields_of(path);
        fields.is_some_and(|fields| fields.get(Field::Person).is_some())
    }
}

#[cfg(test)]
mod tests;
