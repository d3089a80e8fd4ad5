//! What a study compares: variants of one preset, each trained and judged for every fold.

use std::fmt;
use std::str::FromStr;

use shared::model::dimensions::usual_span;
use shared::units::WINDOW_PATCHES;

use myointent::dataset::DataSet;
use myointent::run::preset::Preset;

/// One variant of a study's preset.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Variant {
    /// The preset as it is: teacher, students with and without it, baselines.
    Main,
    /// The same with the wrist's intents, on the data sets that have them: 4 or 5 classes are in the
    /// recordings, pinch is in none.
    Wrist,
    /// A teacher of every set but [`TARGET`]; one run without folds, for no subject of the target is in it.
    Pretraining,
    /// [`Variant::Pretraining`]'s teacher, judged on [`TARGET`] as it is.
    Pretrained,
    /// The same, trained on with [`TARGET`].
    FineTuned,
    /// The same with low-rank additions alone.
    Lora,
    /// A teacher of [`TARGET`] alone.
    Scratch,
    /// A teacher of a shorter window, in samples.
    Window(usize),
    /// A student of another size, of all sets and the labels alone: what a device's cycles buy.
    Student {
        /// Width of a patch's token.
        width: usize,
        /// Encoder layers.
        layers: usize,
    },
}

/// The set whose subjects the ablation of pre-training is judged on.
pub const TARGET: DataSet = DataSet::Roshambo;

impl Variant {
    /// All of a study, in an order in which each finds what it starts from.
    pub const ALL: [Self; 9] = [
        Self::Main,
        Self::Pretraining,
        Self::Scratch,
        Self::Pretrained,
        Self::FineTuned,
        Self::Lora,
        Self::Window(100),
        Self::Window(300),
        Self::Wrist,
    ];

    /// Students by size; no part of [`Variant::ALL`], to be asked for by name.
    pub const STUDENTS: [Self; 8] = [
        Self::student(48, 2),
        Self::student(64, 2),
        Self::student(96, 2),
        Self::student(128, 2),
        Self::student(48, 3),
        Self::student(64, 3),
        Self::student(96, 3),
        Self::student(128, 3),
    ];

    const fn student(width: usize, layers: usize) -> Self {
        Self::Student { width, layers }
    }

    /// What it is, for whoever lacks its results.
    #[must_use]
    pub fn description(self) -> String {
        let target = TARGET.name();
        match self {
            Self::Main => "3 classes on roshambo and ss-stm".to_owned(),
            Self::Wrist => {
                "the wrist's classes too, on ss-stm, myo-readings and cote-allard".to_owned()
            }
            Self::Pretraining => format!("a teacher of all sets but {target}, to start from"),
            Self::Scratch => format!("a teacher trained on {target} alone"),
            Self::Pretrained => format!("a teacher trained on all other sets, never on {target}"),
            Self::FineTuned => format!("that teacher, fine-tuned on {target}"),
            Self::Lora => format!("that teacher, fine-tuned on {target} with LoRA"),
            Self::Window(samples) => format!("a teacher that sees {samples} samples"),
            Self::Student { width, layers } => {
                format!("a student {width} wide with {layers} layers, on all sets")
            }
        }
    }

    /// Whether everybody is left out in turn.
    #[must_use]
    pub fn has_folds(self) -> bool {
        self != Self::Pretraining
    }

    /// Whether students with and without a teacher, and baselines, are trained too; most other variants ask about the
    /// teacher alone.
    #[must_use]
    pub fn has_students(self) -> bool {
        matches!(self, Self::Main | Self::Wrist)
    }

    /// Whether there is a student and nothing else.
    #[must_use]
    pub fn is_student(self) -> bool {
        matches!(self, Self::Student { .. })
    }

    /// Whether training starts from [`Variant::Pretraining`].
    #[must_use]
    pub fn is_pretrained(self) -> bool {
        matches!(self, Self::Pretrained | Self::FineTuned | Self::Lora)
    }

    /// The study's preset as this variant runs it.
    #[must_use]
    pub fn preset(self, base: &Preset) -> Preset {
        let mut preset = base.clone();
        preset.data.data_sets = match self {
            Self::Main | Self::Window(_) => return self.with_window(preset),
            Self::Scratch | Self::Pretrained | Self::FineTuned | Self::Lora => vec![TARGET],
            Self::Student { width, layers } => return sized(preset, width, layers),
            Self::Pretraining => vec![DataSet::SsStm, DataSet::MyoReadings, DataSet::CoteAllard],
            Self::Wrist => {
                preset.classes = 6;
                vec![DataSet::SsStm, DataSet::MyoReadings, DataSet::CoteAllard]
            }
        };
        match self {
            Self::Pretraining => {
                preset.data.held_out.clear();
                preset.data.held_out_share = 0.0;
            }
            Self::Pretrained => {
                preset.fine_tuning.epochs = 0;
                preset = preset.fine_tuned(false);
            }
            Self::FineTuned => preset = preset.fine_tuned(false),
            Self::Lora => preset = preset.fine_tuned(true),
            _ => {}
        }
        preset
    }

    fn with_window(self, mut preset: Preset) -> Preset {
        if let Self::Window(samples) = self {
            preset.teacher.window = samples;
        }
        preset
    }
}

/// A student of this size, trained as the one that the project ships (preset `cpu`) is.
fn sized(mut preset: Preset, width: usize, layers: usize) -> Preset {
    preset.student.d_model = width;
    preset.student.layers = layers;
    preset.student.span = usual_span(layers);
    preset.data.data_sets.clear();
    preset.data.balance = 0.5;
    preset.distillation.patches = 2 * WINDOW_PATCHES;
    preset.distillation.ema_decay = 0.998;
    preset.distillation.teacher_share = 0.0;
    preset
}

impl fmt::Display for Variant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Main => f.write_str("main"),
            Self::Wrist => f.write_str("wrist"),
            Self::Pretraining => f.write_str("pretraining"),
            Self::Pretrained => f.write_str("pretrained"),
            Self::FineTuned => f.write_str("fine-tuned"),
            Self::Lora => f.write_str("lora"),
            Self::Scratch => f.write_str("scratch"),
            Self::Window(samples) => write!(f, "window-{samples}"),
            Self::Student { width, layers } => write!(f, "student-{width}x{layers}"),
        }
    }
}

impl FromStr for Variant {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let all = || Self::ALL.into_iter().chain(Self::STUDENTS);
        all()
            .find(|variant| variant.to_string() == text)
            .ok_or_else(|| {
                let known: Vec<String> = all().map(|variant| variant.to_string()).collect();
                format!("expected one of {}, found {text:?}", known.join(", "))
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_variants_preset_can_run_and_names_are_read_back() {
        let base = Preset::find("study").unwrap();
        for variant in Variant::ALL.into_iter().chain(Variant::STUDENTS) {
            let preset = variant.preset(&base);
            // A teacher that is taken as it is has no epochs, which a preset of its own must have.
            if variant != Variant::Pretrained {
                Preset::parse("variant", &preset.to_toml()).unwrap();
            }
            assert_eq!(variant.to_string().parse(), Ok(variant));
        }
        assert!("window-200".parse::<Variant>().is_err());
    }

    #[test]
    fn nobody_of_the_target_is_in_the_pretraining() {
        let base = Preset::find("study").unwrap();
        let sets = Variant::Pretraining.preset(&base).data.data_sets;
        assert!(!sets.contains(&TARGET) && !sets.is_empty());
    }
}
