//! Fingerprints of what the files of a run are made from.
//!
//! A file is bound to what decides its content and to no more: another `teacher_share` makes another student, not
//! another teacher. Paths and the program's revision decide nothing.

use std::collections::BTreeMap;
use std::path::Path;

use rayon::prelude::*;
use serde::Serialize;
use shared::intent::Intent;

use crate::config::{CONFIG, Fold, ResolvedConfig};
use crate::distillation::{self, Distillation, StudentConfig};
use crate::teacher::{self, TeacherConfig, TeacherTraining};
use crate::{DataSelection, Smoothing};
use execution::bounded_read;
use execution::fingerprint::Fingerprint;
use execution::run_folder::{RunError, RunFolder};
use recordings::labels::compensation::Compensation;
use recordings::split::Split;
use recordings::{DataSet, Library, Recording};

/// Inputs that decide the streams that models are trained and evaluated on.
#[derive(Serialize)]
struct Streams<'a> {
    seed: u64,
    classes: usize,
    data: &'a DataSelection,
    split: &'a Split,
    lags: BTreeMap<DataSet, Compensation>,
    /// Constant lags of sets of which a part is compensated by one.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    constants: BTreeMap<DataSet, usize>,
    recordings: Fingerprint,
}

/// Inputs that decide a teacher's weights.
#[derive(Serialize)]
struct TeacherInputs<'a> {
    streams: Streams<'a>,
    teacher: &'a TeacherConfig,
    training: &'a TeacherTraining,
    start: Option<Fingerprint>,
}

/// Inputs that decide a student's weights.
#[derive(Serialize)]
struct StudentInputs<'a> {
    streams: Streams<'a>,
    student: &'a StudentConfig,
    distillation: &'a Distillation,
    /// Seed of the student's weights and batches.
    seed: u64,
    /// Weights of the teacher that it learns from; none if from the labels alone.
    teacher: Option<Fingerprint>,
}

/// Inputs that decide the scores of a run's models.
#[derive(Serialize)]
struct ResultInputs<'a> {
    variant: &'a str,
    fold: Option<Fold>,
    teacher: TeacherInputs<'a>,
    student: &'a StudentConfig,
    distillation: &'a Distillation,
    smoother: &'a Smoothing,
}

impl ResolvedConfig {
    /// Fingerprint of what results are made from: the whole configuration.
    pub fn fingerprint(&self) -> Fingerprint {
        Fingerprint::of(&ResultInputs {
            variant: &self.variant,
            fold: self.fold,
            teacher: self.teacher_inputs(),
            student: &self.preset.student,
            distillation: &self.preset.distillation,
            smoother: &self.preset.smoother,
        })
    }

    /// Fingerprint of what a model that is neither teacher nor student is made from: the streams.
    pub fn streams_lineage(&self) -> Fingerprint {
        Fingerprint::of(&self.streams())
    }

    /// Refuses to go on with a run by another configuration.
    ///
    /// # Errors
    /// [`RunError::OtherConfiguration`] if they differ in anything that decides the outcome.
    pub fn must_equal(&self, other: &Self, run: &RunFolder) -> Result<(), RunError> {
        if self.fingerprint() == other.fingerprint() {
            return Ok(());
        }
        Err(RunError::OtherConfiguration {
            path: run.file(CONFIG),
            difference: difference(self, other).unwrap_or_default(),
        })
    }

    /// The settings that the student or a member of its ensemble is trained with, by the name of its files.
    pub fn distillation(&self, name: &str) -> Distillation {
        let settings = &self.preset.distillation;
        if name == distillation::NAME {
            return settings.clone();
        }
        let mut own = settings.on_labels();
        if let Some(ensemble) = settings.ensemble {
            own.epochs = ensemble.epochs;
        }
        own
    }

    /// The seed of a student's weights and batches, by the name of its files: each member of an ensemble has its own.
    pub fn student_seed(&self, name: &str) -> u64 {
        let member = distillation::MEMBERS.iter().position(|own| *own == name);
        let offset = member.map_or(0, |member| member as u64 + 1);
        // Members' seeds are far from the seeds that a user would give to other runs.
        self.preset.seed.wrapping_add(offset << 32)
    }

    /// Fingerprint of the weights that the run's student learns from, the teacher's.
    pub fn teaching_weights(&self, run: &RunFolder) -> Result<Fingerprint, RunError> {
        run.weights_fingerprint(teacher::NAME, self.teacher_lineage())
    }

    /// Fingerprint of what the teacher is made from.
    pub fn teacher_lineage(&self) -> Fingerprint {
        Fingerprint::of(&self.teacher_inputs())
    }

    /// Fingerprint of what a student of `run` is made from, by the name of its files. If it learns from the teacher,
    /// that includes the teacher's weights in `run`. An ensemble is not included: it is made from the same inputs as
    /// its student.
    pub fn student_lineage(&self, name: &str, run: &RunFolder) -> Result<Fingerprint, RunError> {
        let distillation = self.distillation(name);
        let teacher = if distillation.needs_teacher() {
            Some(self.teaching_weights(run)?)
        } else {
            None
        };
        Ok(Fingerprint::of(&StudentInputs {
            streams: self.streams(),
            student: &self.preset.student,
            distillation: &distillation,
            seed: self.student_seed(name),
            teacher,
        }))
    }

    fn teacher_inputs(&self) -> TeacherInputs<'_> {
        TeacherInputs {
            streams: self.streams(),
            teacher: &self.preset.teacher,
            training: &self.preset.teacher_training,
            start: self.start_weights,
        }
    }

    fn streams(&self) -> Streams<'_> {
        Streams {
            seed: self.preset.seed,
            classes: self.preset.classes,
            data: &self.preset.data,
            split: &self.split,
            lags: self
                .lags
                .iter()
                .map(|(&data_set, lag)| (data_set, lag.compensation))
                .collect(),
            constants: self
                .lags
                .iter()
                .filter(|(_, lag)| lag.otherwise > 0)
                .map(|(&data_set, lag)| (data_set, lag.otherwise))
                .collect(),
            recordings: self.recordings,
        }
    }
}

/// Fingerprint of the recordings of everybody who has a role.
pub fn recordings(library: &Library, split: &Split) -> Fingerprint {
    let used: Vec<&Recording> = library
        .recordings
        .iter()
        .filter(|recording| split.role(&recording.subject).is_some())
        .collect();
    let each: Vec<_> = used
        .into_par_iter()
        .map(|recording| {
            let samples = recording.samples.iter().flatten();
            let samples: Vec<u8> = samples.map(|value| value.cast_unsigned()).collect();
            let label = |label: &Option<Intent>| label.map_or(u8::MAX, |intent| intent as u8);
            let labels: Vec<u8> = recording.labels.iter().map(label).collect();
            (
                &recording.subject,
                &recording.name,
                Fingerprint::of_bytes(&samples),
                Fingerprint::of_bytes(&labels),
                recording
                    .other_movement
                    .iter()
                    .map(|movement| &movement.samples)
                    .collect::<Vec<_>>(),
            )
        })
        .collect();
    Fingerprint::of(&each)
}

/// Fingerprint of the weights that a training starts from: another run's teacher, or a checkpoint's file.
///
/// # Errors
/// When they are missing, or not of the run in whose folder they are.
pub fn start_weights(start: &Path) -> Result<Fingerprint, RunError> {
    if start.is_dir() {
        let folder = RunFolder::existing(start)?;
        let origin = ResolvedConfig::load(&folder)?;
        return folder.weights_fingerprint(teacher::NAME, origin.teacher_lineage());
    }
    let bytes = bounded_read::read(start, bounded_read::CHECKPOINT)
        .map_err(|source| RunError::io(start, source))?;
    Ok(Fingerprint::of_bytes(&bytes))
}

/// The first setting in which two configurations differ, by dotted key: of the preset, or else of what follows from it.
fn difference(one: &ResolvedConfig, other: &ResolvedConfig) -> Option<String> {
    let value = |config: &ResolvedConfig| {
        let streams = serde_json::to_value(config.streams()).unwrap_or_default();
        let preset = serde_json::to_value(&config.preset).unwrap_or_default();
        let start = serde_json::to_value(config.start_weights).unwrap_or_default();
        [
            ("", preset),
            ("start_weights", start),
            ("split", streams["split"].clone()),
            ("lags", streams["lags"].clone()),
            ("constants", streams["constants"].clone()),
            ("recordings", streams["recordings"].clone()),
        ]
    };
    let pairs = value(one).into_iter().zip(value(other));
    let mut differences =
        pairs.filter_map(|((key, one), (_, other))| first_difference(key, &one, &other));
    differences.next()
}

fn first_difference(
    key: &str,
    one: &serde_json::Value,
    other: &serde_json::Value,
) -> Option<String> {
    use serde_json::Value::{Null, Object};
    if one == other {
        return None;
    }
    if let (Object(fields), Object(others)) = (one, other) {
        return fields.keys().chain(others.keys()).find_map(|name| {
            let dot = if key.is_empty() { "" } else { "." };
            let (one, other) = (fields.get(name), others.get(name));
            let key = format!("{key}{dot}{name}");
            first_difference(&key, one.unwrap_or(&Null), other.unwrap_or(&Null))
        });
    }
    Some(format!("{key} {one} / {other}"))
}
