//! Presets: the settings of a whole run, from recordings to a model file, as TOML.

#![deny(missing_docs)]

pub mod augmentation;
mod check;
pub mod config;
pub mod distillation;
#[cfg(feature = "testing")]
pub mod invariants;
pub mod lineage;
pub mod masking;
mod operating_point;
pub mod resolve;
mod source;
pub mod teacher;
pub mod training;

use serde::{Deserialize, Serialize};
use shared::intent::Vocabulary;
use shared::model::file::SmootherDefaults;
use shared::stream::preprocess::{Median, Preprocessing};
use shared::stream::smoother::AggregationMode;
use shared::units::{HOLD, LOOK_AHEAD};

use crate::distillation::{Distillation, StudentConfig};
use crate::teacher::{LoraConfig, TeacherConfig, TeacherTraining};
use crate::training::LrSchedule;
use recordings::DataSet;
pub use recordings::labels::lag::LabelLag;
use recordings::movement::OtherMovement;

pub use operating_point::OperatingPoint;
pub use source::{BUILT_IN, PresetError};

/// The settings of a whole run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// Name in reports.
    pub name: String,
    /// Seed of every random draw.
    pub seed: u64,
    /// Number of intents: 3, 5 or 6.
    pub classes: usize,
    /// Recordings to use, and subjects to hold out.
    pub data: DataSelection,
    /// The teacher's dimensions.
    pub teacher: TeacherConfig,
    /// Settings of the teacher's training.
    pub teacher_training: TeacherTraining,
    /// Settings of a trained teacher's fine-tuning on other recordings.
    pub fine_tuning: FineTuning,
    /// The student's dimensions.
    pub student: StudentConfig,
    /// Settings of the student's training.
    pub distillation: Distillation,
    /// Smoothing of the model file's labels.
    #[serde(default, skip_serializing_if = "is_default")]
    pub smoother: Smoothing,
}

/// Smoother of a model file; look-ahead and hold are the paper's.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Smoothing {
    /// Rows that are summed; `None`: the mode that follows more transitions of the validation subjects.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub aggregation: Option<Aggregation>,
    /// Operating point; if not given, every label waits for the look-ahead and needs no margin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reaction: Option<OperatingPoint>,
}

/// Rows that the smoother sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Aggregation {
    /// All rows from the instant on.
    AllRows,
    /// The row of the instant alone.
    SameInstant,
}

/// Settings of fine-tuning; all others are those of the teacher's training.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FineTuning {
    /// Passes over all examples; 0 uses the teacher without fine-tuning.
    pub epochs: usize,
    /// Learning rate, constant.
    pub learning_rate: f64,
    /// Rank and scale of LoRA adapters, for a run that uses them.
    pub lora: LoraConfig,
    /// Learning rate of LoRA adapters, constant.
    pub lora_learning_rate: f64,
}

/// Recordings to use, and subjects to hold out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DataSelection {
    /// Data sets to use, if recordings of any of them are found; all if empty.
    pub data_sets: Vec<DataSet>,
    /// Held-out subjects, for evaluation alone, as `data-set/subject`, or whole data sets. Where a set has none,
    /// `host/recordings/people.toml` says who is held out.
    pub held_out: Vec<String>,
    /// Fraction of a data set's subjects that is held out at random, where neither list nor
    /// `host/recordings/people.toml` names any.
    pub held_out_share: f64,
    /// Validation subjects, which select the checkpoint, as [`held_out`](Self::held_out).
    pub validation: Vec<String>,
    /// Fraction of a data set's subjects that validates, drawn at random, where neither list nor
    /// `host/recordings/people.toml` names any.
    pub validation_share: f64,
    /// Lag compensation of the labels.
    pub label_lag: LabelLag,
    /// Whether electrodes are rotated to the common orientation in data sets whose armband is worn rotated.
    pub align_electrodes: bool,
    /// Whether samples are normalized to the wearer ([`Normalizer`](shared::stream::normalizer::Normalizer)): teacher
    /// and students are trained with it, and the model file says so.
    #[serde(default, skip_serializing_if = "is_default")]
    pub normalize: bool,
    /// The filter over time before rectification, of teacher and students; the model file says which.
    #[serde(default, skip_serializing_if = "is_default")]
    pub median: Median,
    /// Seconds of spliced recordings per subject and data set: gestures in random order, of random duration.
    pub spliced_seconds: f64,
    /// Balance between data sets: the seconds are multiplied by the ratio of the largest set's number of subjects to
    /// that of the set, to this power. 0: the same for every subject; 1: the same for every data set.
    #[serde(default)]
    pub balance: f64,
    /// Role in training of movement outside the vocabulary.
    #[serde(default, skip_serializing_if = "is_default")]
    pub other_movement: OtherMovement,
    /// Share of daily life among what a student learns from; 0: daily life is not used.
    #[serde(default, skip_serializing_if = "is_default")]
    pub daily_life: f64,
    /// Whether recordings are also used as published.
    pub as_published: bool,
    /// Maximum number of training subjects per data set; 0: all.
    pub most_subjects: usize,
}

/// Whether a preset need not name a value.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

impl Preset {
    /// The preset of a run that starts from a trained teacher.
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

    /// Preprocessing between the armband and a model's input.
    pub const fn preprocessing(&self) -> Preprocessing {
        Preprocessing {
            normalized: self.data.normalize,
            median: self.data.median,
        }
    }

    /// Whether movement outside the vocabulary is a class of its own for the student.
    pub fn other(&self) -> bool {
        self.data.other_movement == OtherMovement::Class
    }

    /// Smoother of the preset's model files. There is a margin over movement outside the vocabulary if the student knows it.
    pub fn smoother_defaults(&self, aggregation: AggregationMode) -> SmootherDefaults {
        let point = self.smoother.reaction.unwrap_or_default();
        SmootherDefaults {
            aggregation,
            look_ahead: LOOK_AHEAD,
            hold: HOLD,
            margins: point.margins(self.other()),
        }
    }

    /// The classes that labels are taken from.
    pub fn vocabulary(&self) -> Vocabulary {
        Vocabulary::with_classes(self.classes).unwrap_or(Vocabulary::Three)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reaction_has_margins_and_those_that_are_given_come_first() {
        let text = Preset::find("cpu").unwrap().to_toml();
        let reaction = "reaction = \"balanced\"";
        assert!(text.contains(reaction));
        let with = |line: &str| Preset::parse("changed", &text.replace(reaction, line));
        for (line, entry, other, is_early) in [
            ("", 0.0, 0.0, false),
            (reaction, 1.5, -1.5, true),
            ("reaction = \"entry=1\"", 1.0, 0.0, false),
            ("reaction = \"fast,entry=2.5,other=1\"", 2.5, 1.0, true),
        ] {
            let preset = with(line).unwrap();
            let margins = preset
                .smoother_defaults(AggregationMode::AllRowsFrom)
                .margins;
            assert_eq!(margins.entry, entry, "{line}");
            assert_eq!(margins.other, Some(other), "{line}");
            assert_eq!(margins.early.is_some(), is_early, "{line}");
        }
        assert!(with("reaction = \"slow\"").is_err());
    }

    #[test]
    fn the_paper_preset_is_the_papers() {
        let paper = Preset::find("paper").unwrap();
        let (teacher, training) = (&paper.teacher, &paper.teacher_training);
        assert_eq!((teacher.patch, teacher.d_model, teacher.heads), (1, 128, 4));
        assert_eq!((teacher.layers, teacher.feed_forward), (2, 512));
        assert_eq!((training.epochs, training.batch), (12, 128));
        assert_eq!((training.stride, paper.seed), (30, 42));
        assert_eq!(training.augmentation, None);
    }
}
