//! Published sets that are read by description: `published.toml`, which says what each field means.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use shared::units::{CHANNELS, Sample};

use super::Description;
use super::pattern::{Field, Fields, Pattern};
use super::reader::timed;
use super::repetitions;
use super::rows::Rows;
use super::stretched;
use super::values::counts;
use super::words::Words;
use crate::catalogue::{self, DataSet};
use crate::examiner::rows::JudgedRows;
use crate::labels::motion::Motion;
use crate::readers::error::{Damage, LoadError};
use crate::readers::mat;
use crate::readers::npy::{self, Array, Values};
use crate::readers::path::{ending, is_number};
use crate::readers::table::separator::Separator;
use crate::readers::table::shape::Shape;
use crate::recording::Recording;
use crate::seed::fnv_1a;
use execution::file_kind::FileKind;

/// Layout of files of a published set.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Layout {
    description: Description,
    person: Pattern,
    name: Option<Pattern>,
    #[serde(default)]
    names: BTreeMap<String, String>,
    #[serde(default)]
    more: Vec<Pattern>,
    #[serde(default)]
    any_person: bool,
    #[serde(default)]
    notes: Vec<[String; 2]>,
    note: Option<String>,
    short: Option<(usize, String)>,
    #[serde(default)]
    unlabelled: Vec<String>,
    begins: Option<(String, usize)>,
    #[serde(default)]
    others_alone: bool,
    #[serde(default)]
    polled: bool,
    #[serde(default)]
    stretched: bool,
    #[serde(default)]
    repetitions: bool,
    #[serde(default)]
    damaged: Vec<PathBuf>,
    #[serde(default)]
    checksums: Vec<String>,
    span: Option<[usize; 2]>,
    apart: Option<usize>,
    #[serde(default)]
    variables: Vec<String>,
    pulses: Option<Pulses>,
    #[serde(default)]
    copies: Vec<String>,
}

/// Marks of gestures in a MATLAB file, numbered by their order.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Pulses {
    variable: String,
    of_each: usize,
    count: usize,
}

/// Whether a file has the labels of another one.
pub(crate) fn has_labels(path: &Path) -> bool {
    catalogue::layouts().any(|(_, own)| {
        let labels = own.description.label_files.as_ref();
        labels.is_some_and(|labels| own.fields_of(labels, path).is_some())
    })
}

impl Layout {
    fn fields_of(&self, pattern: &Pattern, path: &Path) -> Option<Fields> {
        let accepts = |field, text: &str| match field {
            Field::Gesture => self.description.labels.has(text),
            Field::Person => self.any_person || is_number(text),
            _ => true,
        };
        pattern.fields_of_end(path, &accepts)
    }

    fn fits(&self, path: &Path, bytes: &[u8]) -> bool {
        match (ending(path).as_deref(), FileKind::of(bytes)) {
            (Some("npy"), FileKind::Npy) | (Some("mat"), FileKind::Mat) | (Some("dat"), _) => true,
            (Some("json"), FileKind::Json) => {
                self.repetitions && str::from_utf8(bytes).is_ok_and(repetitions::looks_like)
            }
            (Some("csv" | "txt"), FileKind::Table | FileKind::Text) => {
                let Ok(text) = str::from_utf8(bytes) else {
                    return false;
                };
                if self.description.header == Some(true) {
                    return self.description.columns(text).is_ok();
                }
                let columns = CHANNELS + usize::from(self.description.label.is_some());
                let shape = Shape::of(text);
                let is_alike = shape.is_some_and(|shape| {
                    (shape.separator, shape.columns, shape.numbers)
                        == (Separator::Comma, columns, columns)
                        && shape.is_decimal == (self.description.scale != counts())
                });
                is_alike && (self.checksums.is_empty() || self.has_checksum(bytes))
            }
            _ => false,
        }
    }

    /// Whether the samples of a file are published ones.
    fn has_checksum(&self, bytes: &[u8]) -> bool {
        let rows = self.description.rows(bytes);
        rows.is_ok_and(|rows| self.checksums.contains(&checksum(&rows.samples)))
    }

    fn rows(&self, path: &Path, bytes: &[u8]) -> Result<Rows, Damage> {
        let description = &self.description;
        if ending(path).as_deref() == Some("dat") {
            return description.array(&npy::int16(CHANNELS, bytes)?);
        }
        if self.variables.is_empty() {
            let mut rows = description.rows(bytes)?;
            if self.stretched {
                stretched::stretch(&mut rows)?;
            }
            return Ok(rows);
        }
        let variables = mat::parse(bytes)?;
        let mut rows = description.array(variable(&variables, &self.variables)?)?;
        if let Some(pulses) = &self.pulses {
            rows.labels.words = Some(pulses.words(&variables, rows.samples.len())?);
        }
        Ok(rows)
    }
}

/// File of a published set.
pub(crate) struct PublishedFile<'p> {
    pub set: DataSet,
    layout: &'static Layout,
    path: &'p Path,
    /// Folder that the layout's paths lie below.
    folder: &'p Path,
    fields: Fields,
}

impl<'p> PublishedFile<'p> {
    /// The file of a path if a layout has its path and kind.
    pub(crate) fn of(path: &'p Path, bytes: &[u8]) -> Option<Self> {
        catalogue::layouts().find_map(|(set, layout)| {
            let mut patterns = [&layout.description.files].into_iter().chain(&layout.more);
            let (folder, fields) = patterns.find_map(|files| {
                let fields = layout.fields_of(files, path)?;
                Some((files.folder_of(path), fields))
            })?;
            layout.fits(path, bytes).then_some(Self {
                set,
                layout,
                path,
                folder,
                fields,
            })
        })
    }

    /// Whether a file is a copy of another person's.
    pub(crate) fn is_copy(&self) -> bool {
        let person = self.layout.person.path_of(&self.fields);
        self.layout
            .copies
            .iter()
            .any(|copy| person == Path::new(copy))
    }

    /// Reads the file.
    pub(crate) fn read(&self, bytes: &[u8]) -> Result<Vec<Recording>, LoadError> {
        let Self {
            layout,
            path,
            folder,
            fields,
            ..
        } = self;
        let labels = &layout.description.labels;
        let damage = |damage: Damage| {
            let as_published = layout.damaged.iter().any(|name| path.ends_with(name));
            Damage {
                as_published,
                ..damage
            }
            .in_file(path)
        };
        if layout.repetitions {
            let text = str::from_utf8(bytes).unwrap_or_default();
            let all = repetitions::of(text, labels).map_err(damage)?;
            let read = |(name, rows, note): repetitions::Named| {
                let mut own = self.recording(rows)?;
                own.name = name;
                own.notes.extend(note.map(str::to_owned));
                Ok(own)
            };
            return all.into_iter().map(read).collect();
        }
        let rows = layout.rows(path, bytes).map_err(damage)?;
        let description = &layout.description;
        let rows = description.with_labels(rows, folder, path, fields)?;
        Ok(vec![self.recording(rows)?])
    }

    /// Recording of the rows of a file.
    fn recording(&self, rows: Rows) -> Result<Recording, LoadError> {
        let Self {
            set,
            layout,
            path,
            folder,
            fields,
        } = self;
        let description = &layout.description;
        let count = rows.samples.len();
        let mut motions = rows.motions(&description.labels, path)?;
        let is_other = |motion: &Motion| matches!(motion, Motion::Other(_));
        if layout.others_alone && motions.iter().any(is_other) {
            let rest = motions.iter_mut().filter(|own| **own == Motion::RELAX);
            rest.for_each(|own| *own = Motion::Unknown);
        }
        let gesture = fields.get(Field::Gesture);
        let motion = gesture.and_then(|word| description.labels.motion(word));
        if let (Some([start, end]), Some(motion)) = (layout.span, motion) {
            let after = match motion {
                Motion::Intent(_) => Motion::RELAX,
                _ => Motion::Unknown,
            };
            motions[..start.min(count)].fill(Motion::RELAX);
            motions[end.min(count)..].fill(after);
        }
        if let Some(least) = layout.apart {
            keep_apart(&mut motions, least);
        }
        let person = layout.person.path_of(fields);
        let name = match (&layout.name, gesture.and_then(|own| layout.names.get(own))) {
            (_, Some(name)) => name.into(),
            (Some(name), None) => name.path_of(fields),
            (None, None) => {
                let below = path.strip_prefix(folder).unwrap_or(path).with_extension("");
                below.strip_prefix(&person).unwrap_or(&below).to_owned()
            }
        };
        let (person, name) = (person.to_string_lossy(), name.to_string_lossy());
        let own = format!("{person}/{name}");
        if layout.unlabelled.iter().any(|of| own.starts_with(of)) {
            motions.fill(Motion::Unknown);
        }
        if let Some((_, begin)) = layout.begins.as_ref().filter(|(of, _)| own.starts_with(of)) {
            motions[..*begin.min(&count)].fill(Motion::Unknown);
        }
        let (recording, _) = rows.recording(description, path, motions);
        let recording = Recording {
            data_set: *set,
            subject: format!("{}/{person}", set.name()),
            name: name.clone().into_owned(),
            ..recording
        };
        let mut recording = timed(description, motion, recording);
        if layout.polled {
            recording = JudgedRows::polled(&recording.samples)
                .apply(recording)
                .remove(0);
        }
        recording.notes.extend(layout.note.clone());
        let note = layout.notes.iter().find(|[of, _]| own.starts_with(of));
        recording.notes.extend(note.map(|[_, note]| note.clone()));
        if let Some((_, note)) = layout.short.as_ref().filter(|(whole, _)| count < *whole) {
            recording.notes.push(note.clone());
        }
        Ok(recording)
    }
}

impl Pulses {
    /// Number of the gesture at each sample, 0 without a pulse. The pulse may go on after the last sample.
    fn words(&self, variables: &[Array], samples: usize) -> Result<Words, Damage> {
        let pulse = variable(variables, std::slice::from_ref(&self.variable))?;
        let columns = pulse.shape.get(1).copied().unwrap_or(1);
        let (mut pulses, mut before) = (0, false);
        let gesture = |at: usize| {
            let Values::Numbers(values) = &pulse.values else {
                return 0;
            };
            let first = values.get(at * columns);
            let on = first.is_some_and(|&value| value > 0.0);
            pulses += usize::from(on && !before);
            before = on;
            if on {
                (pulses - 1) / self.of_each + 1
            } else {
                0
            }
        };
        let gestures: Vec<usize> = (0..samples).map(gesture).collect();
        if pulses != self.count {
            let fault = format!("expected {} gestures marked, found {pulses}", self.count);
            return Err(Damage::of_file(fault));
        }
        Ok(gestures.iter().map(usize::to_string).collect())
    }
}

fn variable<'v>(variables: &'v [Array], names: &[String]) -> Result<&'v Array, Damage> {
    let found = variables.iter().find(|own| names.contains(&own.descr));
    let missing = || mat::fault(&format!("it has no {}", names.join(" or ")));
    found.ok_or_else(|| Damage::of_file(missing()))
}

/// FNV-1a of samples, 64 bits, in hexadecimal digits.
fn checksum(samples: &[Sample]) -> String {
    let values = samples.iter().flatten();
    let hash = fnv_1a(values.map(|value| value.cast_unsigned()));
    format!("{hash:016x}")
}

/// Makes rest unknown that is nearer than so many samples to another label; not at either end of the recording.
fn keep_apart(motions: &mut [Motion], least: usize) {
    let all = motions.to_vec();
    let mut start = 0;
    for run in all.chunk_by(|a, b| a == b) {
        let end = start + run.len();
        if run[0] == Motion::RELAX {
            let after = if start == 0 { 0 } else { least };
            let before = if end == all.len() { 0 } else { least };
            let rest = start + after..end.saturating_sub(before);
            for at in (start..end).filter(|at| !rest.contains(at)) {
                motions[at] = Motion::Unknown;
            }
        }
        start = end;
    }
}

#[cfg(test)]
mod tests;
