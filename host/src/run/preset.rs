//! What was asked and what will run: presets as TOML, unknown keys refused.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use shared::intent::Vocabulary;
use shared::units::{LOOK_BACK, PATCH, WINDOW, WINDOW_PATCHES};
use thiserror::Error;

use crate::dataset::DataSet;
use crate::student::distillation::Distillation;
use crate::student::model::StudentConfig;
use crate::teacher::model::TeacherConfig;
use crate::teacher::training::{LoraConfig, TeacherTraining};
use crate::training::schedule::LrSchedule;

/// Presets that come with the program: name and text.
pub const BUILT_IN: [(&str, &str); 3] = [
    ("quickstart", include_str!("../../presets/quickstart.toml")),
    ("cpu", include_str!("../../presets/cpu.toml")),
    ("paper", include_str!("../../presets/paper.toml")),
];

/// A whole run, from recordings to a model file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// Name in reports and model files.
    pub name: String,
    /// Seed of everything drawn.
    pub seed: u64,
    /// Number of intents: 3 or 6.
    pub classes: usize,
    /// What is trained on and what is left out.
    pub data: DataChoice,
    /// The teacher's dimensions.
    pub teacher: TeacherConfig,
    /// How the teacher is trained.
    pub teacher_training: TeacherTraining,
    /// How a teacher that has learnt from other recordings is trained on.
    pub fine_tuning: FineTuning,
    /// The student's dimensions.
    pub student: StudentConfig,
    /// How the student is trained.
    pub distillation: Distillation,
}

/// How a trained teacher is trained on; whatever is not here is as in its first training.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FineTuning {
    /// Passes over all examples; 0 takes the teacher as it is.
    pub epochs: usize,
    /// Learning rate, the same for every step.
    pub learning_rate: f64,
    /// Ranks and scale of low-rank additions, for a run that asks for them.
    pub lora: LoraConfig,
    /// Learning rate of low-rank additions.
    pub lora_learning_rate: f64,
}

/// What is trained on and what is left out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DataChoice {
    /// Data sets to use, where any of them is at hand; all if empty.
    pub data_sets: Vec<DataSet>,
    /// Subjects never trained on nor validated with, as `data-set/subject`; those that are not
    /// among the recordings are passed over.
    pub held_out: Vec<String>,
    /// Where none of a data set's subjects is listed: the share of them that the seed leaves out.
    pub held_out_share: f64,
    /// Subjects of the training side that choose the checkpoint, as `data-set/subject`.
    pub validation: Vec<String>,
    /// Likewise where none is listed.
    pub validation_share: f64,
    /// Where the labels of each training recording lie in time.
    pub label_lag: LabelLag,
    /// Whether data sets that wear the band turned are turned into the common frame.
    pub align_electrodes: bool,
    /// Seconds of spliced recordings made for each subject and data set, in random order and rhythm.
    pub spliced_seconds: f64,
    /// How far smaller data sets are made up for: the seconds grow with the ratio of the largest set's number of
    /// subjects to the set's own, to this power. 0 not at all, 1 wholly.
    #[serde(default)]
    pub balance: f64,
    /// Whether recordings are also used as published, order and rhythm included.
    pub as_published: bool,
    /// Most subjects of a data set to train on; 0 takes all. A quick run needs no crowd.
    pub most_subjects: usize,
}

/// How training labels, which are cues, are moved to where the muscles answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LabelLag {
    /// By each data set's median lag, estimated on its training subjects.
    Estimated,
    /// Not at all, as the paper does.
    None,
}

/// Why a preset cannot run.
#[derive(Debug, Error)]
pub enum PresetError {
    /// Neither a built-in name nor a readable file.
    #[error("preset {name}: no built-in preset of that name (there are {known}) and no such file")]
    Missing {
        /// What was asked for.
        name: String,
        /// Built-in names.
        known: String,
        /// The cause.
        source: std::io::Error,
    },
    /// Not TOML, or a key that is unknown or missing.
    #[error("preset {name}: {reason}")]
    Syntax {
        /// Which preset.
        name: String,
        /// What the parser says, with the line.
        reason: String,
    },
    /// A number that cannot be run with.
    #[error("preset {name}: {key} is {found}, expected {expected}")]
    Value {
        /// Which preset.
        name: String,
        /// The key.
        key: &'static str,
        /// Its value.
        found: String,
        /// What would do.
        expected: &'static str,
    },
}

impl Preset {
    /// A built-in preset by name, or else a TOML file.
    ///
    /// # Errors
    /// When there is neither, or what is there cannot run.
    pub fn find(name: &str) -> Result<Self, PresetError> {
        if let Some((_, text)) = BUILT_IN.iter().find(|(known, _)| *known == name) {
            return Self::parse(name, text);
        }
        let text = std::fs::read_to_string(PathBuf::from(name)).map_err(|source| {
            PresetError::Missing {
                name: name.to_owned(),
                known: BUILT_IN.map(|(known, _)| known).join(", "),
                source,
            }
        })?;
        Self::parse(name, &text)
    }

    /// Reads a preset's text.
    ///
    /// # Errors
    /// When a key is unknown or missing, or a number cannot be run with.
    pub fn parse(name: &str, text: &str) -> Result<Self, PresetError> {
        let preset: Self = toml::from_str(text).map_err(|error| PresetError::Syntax {
            name: name.to_owned(),
            reason: error.to_string(),
        })?;
        preset.check(name)?;
        Ok(preset)
    }

    /// The preset as TOML, for the run's folder.
    #[must_use]
    pub fn to_toml(&self) -> String {
        toml::to_string_pretty(self).unwrap_or_default()
    }

    /// The preset of a run that starts from a trained teacher.
    #[must_use]
    pub fn fine_tuned(mut self, with_lora: bool) -> Self {
        let tuning = self.fine_tuning;
        self.teacher_training = TeacherTraining {
            epochs: tuning.epochs,
            learning_rate: if with_lora {
                tuning.lora_learning_rate
            } else {
                tuning.learning_rate
            },
            lr_schedule: LrSchedule::Constant,
            lora: with_lora.then_some(tuning.lora),
            ..self.teacher_training
        };
        self
    }

    /// The classes that labels are taken from.
    #[must_use]
    pub fn vocabulary(&self) -> Vocabulary {
        Vocabulary::with_classes(self.classes).unwrap_or(Vocabulary::Three)
    }

    fn check(&self, name: &str) -> Result<(), PresetError> {
        let refuse = |key, found: String, expected| {
            Err(PresetError::Value {
                name: name.to_owned(),
                key,
                found,
                expected,
            })
        };
        let (teacher, student) = (&self.teacher, &self.student);
        let (training, distillation) = (&self.teacher_training, &self.distillation);
        if Vocabulary::with_classes(self.classes).is_none() {
            return refuse("classes", self.classes.to_string(), "3 or 6");
        }
        if !(LOOK_BACK * PATCH..=WINDOW).contains(&teacher.window) {
            return refuse(
                "teacher.window",
                teacher.window.to_string(),
                "60 to 600 samples",
            );
        }
        if teacher.patch == 0 || !teacher.window.is_multiple_of(teacher.patch) {
            return refuse(
                "teacher.patch",
                teacher.patch.to_string(),
                "a divisor of the window",
            );
        }
        if teacher.heads == 0
            || teacher.d_model == 0
            || !teacher.d_model.is_multiple_of(teacher.heads)
        {
            return refuse(
                "teacher.heads",
                teacher.heads.to_string(),
                "a divisor of d_model",
            );
        }
        if training.stride == 0 || training.batch == 0 || training.epochs == 0 {
            return refuse(
                "teacher_training",
                "0".to_owned(),
                "stride, batch and epochs of 1 or more",
            );
        }
        if self.fine_tuning.lora.rank == 0 {
            return refuse("fine_tuning.lora.rank", "0".to_owned(), "1 or more");
        }
        if training.tasks.is_empty() {
            return refuse(
                "teacher_training.tasks",
                "[]".to_owned(),
                "one task or more",
            );
        }
        if student.heads == 0
            || student.d_model == 0
            || !student.d_model.is_multiple_of(student.heads)
        {
            return refuse(
                "student.heads",
                student.heads.to_string(),
                "a divisor of d_model",
            );
        }
        if student.span == 0
            || student.layers == 0
            || student.receptive_field() + LOOK_BACK - 1 > WINDOW_PATCHES
        {
            let field = student.receptive_field().to_string();
            return refuse(
                "student.span",
                field,
                "layers * (span - 1) + 1 of at most 55 patches",
            );
        }
        if distillation.patches <= student.span
            || distillation.batch == 0
            || distillation.steps == 0
            || distillation.epochs == 0
        {
            return refuse(
                "distillation",
                distillation.patches.to_string(),
                "patches above the span; batch, steps and epochs of 1 or more",
            );
        }
        if !(0.0..=1.0).contains(&distillation.teacher_share) {
            return refuse(
                "distillation.teacher_share",
                distillation.teacher_share.to_string(),
                "0 to 1",
            );
        }
        if !(distillation.temperature.is_finite() && distillation.temperature > 0.0) {
            return refuse(
                "distillation.temperature",
                distillation.temperature.to_string(),
                "a positive number",
            );
        }
        for augmentation in [&training.augmentation, &distillation.augmentation]
            .into_iter()
            .flatten()
        {
            if !(augmentation.gain.is_finite() && augmentation.gain >= 0.0)
                || augmentation.rotation > 3
            {
                return refuse(
                    "augmentation",
                    format!("{augmentation:?}"),
                    "a gain of 0 or more and a rotation of 0 to 3",
                );
            }
        }
        if !(0.0..1.0).contains(&self.data.held_out_share)
            || !(0.0..1.0).contains(&self.data.validation_share)
        {
            return refuse(
                "data.held_out_share",
                self.data.held_out_share.to_string(),
                "0 or more, below 1",
            );
        }
        if !(0.0..=1.0).contains(&self.data.balance) {
            return refuse("data.balance", self.data.balance.to_string(), "0 to 1");
        }
        for (key, average) in [
            (
                "teacher_training.ema_decay",
                self.teacher_training.ema_decay,
            ),
            ("distillation.ema_decay", self.distillation.ema_decay),
        ] {
            if !(0.0..1.0).contains(&average) {
                return refuse(key, average.to_string(), "0 or more, below 1");
            }
        }
        if !(self.data.spliced_seconds.is_finite() && self.data.spliced_seconds >= 0.0)
            || (self.data.spliced_seconds < 10.0 && !self.data.as_published)
        {
            return refuse(
                "data.spliced_seconds",
                self.data.spliced_seconds.to_string(),
                "10 or more, or as_published = true",
            );
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_preset_can_run_and_survives_being_written() {
        for (name, text) in BUILT_IN {
            let preset = Preset::parse(name, text).unwrap();
            assert_eq!(preset.name, name);
            assert_eq!(Preset::parse(name, &preset.to_toml()).unwrap(), preset);
        }
    }

    #[test]
    fn the_paper_preset_is_the_papers() {
        let paper = Preset::find("paper").unwrap();
        assert_eq!(
            (
                paper.teacher.patch,
                paper.teacher.d_model,
                paper.teacher.heads
            ),
            (1, 128, 4)
        );
        assert_eq!((paper.teacher.layers, paper.teacher.feed_forward), (2, 512));
        assert_eq!(
            (paper.teacher_training.epochs, paper.teacher_training.batch),
            (12, 128)
        );
        assert_eq!((paper.teacher_training.stride, paper.seed), (30, 42));
        assert_eq!(paper.teacher_training.augmentation, None);
    }

    #[test]
    fn an_unknown_key_is_refused_with_its_name() {
        let text = format!("nonsense = 1\n{}", BUILT_IN[0].1);
        let error = Preset::parse("mine", &text).unwrap_err().to_string();
        assert!(error.contains("nonsense"), "{error}");
    }

    #[test]
    fn a_receptive_field_beyond_the_window_is_refused() {
        let text = BUILT_IN[0].1.replace("span = 27", "span = 30");
        assert!(matches!(
            Preset::parse("mine", &text),
            Err(PresetError::Value {
                key: "student.span",
                ..
            })
        ));
    }
}
