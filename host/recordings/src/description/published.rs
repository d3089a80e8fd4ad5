//! Published sets that are read by description: `published.toml`, which says what each field means.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use serde::Deserialize;
use shared::units::{CHANNELS, Sample};

use super::Description;
use super::pattern::{Field, Fields, Pattern};
use super::reader::{motions, timed};
use super::repetitions;
use super::rows::{At, Rows};
use super::stretched;
use super::values::counts;
use super::words::Words;
use crate::catalogue::{self, DataSet};
use crate::examiner::rows::JudgedRows;
use crate::labels::motion::{GroundTruth, Motion};
use crate::readers::error::{Damage, Fault, LoadError};
use crate::readers::mat::{self, Matrix};
use crate::readers::path::{ending, is_number};
use crate::readers::table::separator::Separator;
use crate::readers::table::shape::Shape;
use crate::readers::table::{matrix, sample};
use crate::recording::Recording;
use crate::seed::fnv_1a;
use execution::file_kind::FileKind;

const ROW_BYTES: usize = 2 * CHANNELS;

/// Layout of files of a published set.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Layout {
    /// The set; known by where the layout stands.
    #[serde(skip, default = "unknown")]
    pub set: DataSet,
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

/// Set of a layout until it is looked up.
const fn unknown() -> DataSet {
    DataSet::named("")
}

/// Marks of gestures in a MATLAB file, numbered by their order.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Pulses {
    variable: String,
    of_each: usize,
    count: usize,
}

/// Layouts of all sets, one for each pattern of paths.
static LAYOUTS: LazyLock<Vec<Layout>> = LazyLock::new(|| {
    let mut all = Vec::new();
    for (set, layout) in catalogue::layouts() {
        let patterns = [&layout.description.files].into_iter().chain(&layout.more);
        all.extend(patterns.map(|files| {
            let mut own = Layout {
                set,
                ..layout.clone()
            };
            own.description.files = files.clone();
            own
        }));
    }
    all
});

impl Layout {
    /// Layout of a file by its path and kind, and the fields of the path.
    pub(crate) fn of(path: &Path, bytes: &[u8]) -> Option<(&'static Self, Fields)> {
        let mut all = LAYOUTS.iter();
        all.find_map(|own| {
            let fields = own.fields_of(&own.description.files, path)?;
            own.fits(path, bytes).then_some((own, fields))
        })
    }

    /// Whether a file has the labels of another one.
    pub(crate) fn is_of_labels(path: &Path) -> bool {
        LAYOUTS.iter().any(|own| {
            let labels = own.description.label_files.as_ref();
            labels.is_some_and(|labels| own.fields_of(labels, path).is_some())
        })
    }

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

    /// Whether a file is a copy of another person's.
    pub(crate) fn is_copy(&self, fields: &Fields) -> bool {
        let person = self.person.path_of(fields);
        self.copies.iter().any(|copy| person == Path::new(copy))
    }

    /// Reads a file.
    pub(crate) fn read(
        &self,
        path: &Path,
        bytes: &[u8],
        fields: &Fields,
    ) -> Result<Vec<Recording>, LoadError> {
        let description = &self.description;
        let folder = description.files.folder_of(path);
        let damage = |damage: Damage| {
            let as_published = self.damaged.iter().any(|name| path.ends_with(name));
            Damage {
                as_published,
                ..damage
            }
            .in_file(path)
        };
        if self.repetitions {
            let text = str::from_utf8(bytes).unwrap_or_default();
            let all = repetitions::of(text, &description.labels).map_err(damage)?;
            let read = |(name, rows, note): repetitions::Named| {
                let mut own = self.recording(path, fields, rows)?;
                own.name = name;
                own.notes.extend(note.map(str::to_owned));
                Ok(own)
            };
            return all.into_iter().map(read).collect();
        }
        let rows = self.rows(path, bytes).map_err(damage)?;
        let rows = description.with_labels(rows, folder, path, fields)?;
        Ok(vec![self.recording(path, fields, rows)?])
    }

    /// Recording of the rows of a file.
    fn recording(&self, path: &Path, fields: &Fields, rows: Rows) -> Result<Recording, LoadError> {
        let description = &self.description;
        let folder = description.files.folder_of(path);
        let count = rows.samples.len();
        let motions = motions(description, &rows.labels, count);
        let labels_file = rows.labels_file.as_deref().unwrap_or(path);
        let mut motions = motions.map_err(|damage| damage.in_file(labels_file))?;
        let is_other = |motion: &Motion| matches!(motion, Motion::Other(_));
        if self.others_alone && motions.iter().any(is_other) {
            let rest = motions.iter_mut().filter(|own| **own == Motion::RELAX);
            rest.for_each(|own| *own = Motion::Unknown);
        }
        let gesture = fields.get(Field::Gesture);
        let motion = gesture.and_then(|word| description.labels.motion(word));
        if let (Some([start, end]), Some(motion)) = (self.span, motion) {
            let after = match motion {
                Motion::Intent(_) => Motion::RELAX,
                _ => Motion::Unknown,
            };
            motions[..start.min(count)].fill(Motion::RELAX);
            motions[end.min(count)..].fill(after);
        }
        if let Some(least) = self.apart {
            keep_apart(&mut motions, least);
        }
        let person = self.person.path_of(fields);
        let name = match (&self.name, gesture.and_then(|own| self.names.get(own))) {
            (_, Some(name)) => name.into(),
            (Some(name), None) => name.path_of(fields),
            (None, None) => {
                let below = path.strip_prefix(folder).unwrap_or(path).with_extension("");
                below.strip_prefix(&person).unwrap_or(&below).to_owned()
            }
        };
        let (person, name) = (person.to_string_lossy(), name.to_string_lossy());
        let own = format!("{person}/{name}");
        if self.unlabelled.iter().any(|of| own.starts_with(of)) {
            motions.fill(Motion::Unknown);
        }
        if let Some((_, begin)) = self.begins.as_ref().filter(|(of, _)| own.starts_with(of)) {
            motions[..*begin.min(&count)].fill(Motion::Unknown);
        }
        let truth: GroundTruth = motions.into_iter().collect();
        let subject = format!("{}/{person}", self.set.name());
        let recording = Recording {
            name: name.clone().into_owned(),
            path: path.to_owned(),
            other_movement: truth.other_movement,
            ..Recording::new(self.set, subject, rows.samples, truth.labels)
        };
        let mut recording = timed(description, motion, recording);
        if self.polled {
            recording = JudgedRows::polled(&recording.samples)
                .apply(recording)
                .remove(0);
        }
        recording.notes.extend(self.note.clone());
        let note = self.notes.iter().find(|[of, _]| own.starts_with(of));
        recording.notes.extend(note.map(|[_, note]| note.clone()));
        if let Some((_, note)) = self.short.as_ref().filter(|(whole, _)| count < *whole) {
            recording.notes.push(note.clone());
        }
        Ok(recording)
    }

    fn rows(&self, path: &Path, bytes: &[u8]) -> Result<Rows, Damage> {
        let (samples, words) = if !self.variables.is_empty() {
            let matrices = mat::parse(bytes)?;
            let samples = matrix(named(&matrices, &self.variables)?, self.description.scale)?;
            let words = self.pulses.as_ref();
            let words = words.map(|pulses| pulses.words(&matrices, samples.len()));
            (samples, words.transpose()?)
        } else if ending(path).as_deref() == Some("dat") {
            (int16(bytes)?, None)
        } else {
            let mut rows = self.description.rows(bytes)?;
            if self.stretched {
                stretched::stretch(&mut rows)?;
            }
            let placement = self.description.placement();
            for sample in &mut rows.samples {
                *sample = placement.apply(*sample);
            }
            return Ok(rows);
        };
        Ok(Rows::of(samples, words, At::File))
    }
}

impl Pulses {
    /// Number of the gesture at each sample, 0 without a pulse. The pulse may go on after the last sample.
    fn words(&self, matrices: &[Matrix], samples: usize) -> Result<Words, Damage> {
        let pulse = named(matrices, std::slice::from_ref(&self.variable))?;
        let (mut words, mut pulses, mut before) = (Words::default(), 0, false);
        for at in 0..samples {
            let on = pulse.values.get(at).is_some_and(|&value| value > 0.0);
            pulses += usize::from(on && !before);
            before = on;
            let gesture = if on {
                (pulses - 1) / self.of_each + 1
            } else {
                0
            };
            words.push(&gesture.to_string());
        }
        let fault = Fault::Gestures {
            expected: self.count,
            found: pulses,
        };
        let whole = pulses == self.count;
        whole.then_some(words).ok_or(Damage::of_file(fault))
    }
}

fn named<'m>(matrices: &'m [Matrix], names: &[String]) -> Result<&'m Matrix, Damage> {
    let found = matrices.iter().find(|own| names.contains(&own.name));
    let missing = || Damage::of_file(Fault::Mat(format!("it has no {}", names.join(" or "))));
    found.ok_or_else(missing)
}

/// Samples of interleaved little-endian numbers of two bytes.
fn int16(bytes: &[u8]) -> Result<Vec<Sample>, Damage> {
    let whole = bytes.len() / ROW_BYTES * ROW_BYTES;
    if whole != bytes.len() {
        let fault = Fault::Length {
            expected: (whole + ROW_BYTES) as u64,
            found: bytes.len() as u64,
        };
        return Err(Damage::at_byte(whole as u64, fault));
    }
    let rows = bytes.chunks_exact(ROW_BYTES).enumerate();
    rows.map(|(row, bytes)| {
        let at = |channel| i16::from_le_bytes([bytes[2 * channel], bytes[2 * channel + 1]]);
        let counts: [f64; CHANNELS] = std::array::from_fn(|channel| f64::from(at(channel)));
        sample(&counts, 1).map_err(|fault| Damage::at_byte((row * ROW_BYTES) as u64, fault))
    })
    .collect()
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
