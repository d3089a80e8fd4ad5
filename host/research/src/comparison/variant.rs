//! What a study compares: variants of one preset, each trained and evaluated for every fold.

use std::collections::BTreeSet;
use std::fmt;
use std::str::FromStr;

use shared::model::dimensions::usual_span;
use shared::units::WINDOW_PATCHES;
use thiserror::Error;

use myointent::dataset::DataSet;
use myointent::run::preset::Preset;

/// One variant of a study's preset.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Variant {
    /// The preset unchanged: teacher, distilled student, student trained on labels only, baselines.
    Main,
    /// The same with six classes, on the data sets with wrist intents. Their recordings have 4 or 5 of the
    /// classes; pinch is in none.
    Wrist,
    /// A teacher trained on every data set but [`TARGET`]. One run without folds: it sees no subject of
    /// the target.
    Pretraining,
    /// The teacher of [`Variant::Pretraining`], evaluated on [`TARGET`] without further training.
    Pretrained,
    /// The same teacher, fine-tuned on [`TARGET`].
    FineTuned,
    /// The same teacher, fine-tuned on [`TARGET`] with LoRA.
    Lora,
    /// A teacher trained on [`TARGET`] only.
    Scratch,
    /// A teacher with a shorter window, in samples.
    Window(usize),
    /// A student of another size, trained on the labels of all data sets, without a teacher.
    Student {
        /// Model width.
        width: usize,
        /// Encoder layers.
        layers: usize,
    },
}

/// The data set that the pre-training ablation is evaluated on.
const TARGET: DataSet = DataSet::Roshambo;
/// The other data sets, those with wrist intents.
const OTHERS: [DataSet; 3] = [DataSet::SsStm, DataSet::MyoReadings, DataSet::CoteAllard];

impl Variant {
    /// The paper's comparisons; pre-training comes before the variants that start from it.
    pub(crate) const ALL: [Self; 9] = [
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

    /// Students by size; not in [`Variant::ALL`], they run when named.
    pub(crate) const STUDENTS: [Self; 8] = [
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

    /// What it is, in a few words.
    pub(crate) fn description(self) -> String {
        let target = TARGET.name();
        match self {
            Self::Main => "3 classes on roshambo and ss-stm".to_owned(),
            Self::Wrist => "wrist intents too, on ss-stm, myo-readings and cote-allard".to_owned(),
            Self::Pretraining => format!("a teacher trained on all other data sets than {target}"),
            Self::Scratch => format!("a teacher trained on {target} only"),
            Self::Pretrained => format!("the pre-trained teacher, without training on {target}"),
            Self::FineTuned => format!("the pre-trained teacher, fine-tuned on {target}"),
            Self::Lora => format!("the pre-trained teacher, fine-tuned on {target} with LoRA"),
            Self::Window(samples) => format!("a teacher with a window of {samples} samples"),
            Self::Student { width, layers } => {
                format!("a student of width {width} with {layers} layers, trained on all data sets")
            }
        }
    }

    /// Whether it is run once per fold.
    pub(crate) fn has_folds(self) -> bool {
        self != Self::Pretraining
    }

    /// Whether a teacher is trained.
    pub(crate) const fn has_teacher(self) -> bool {
        !matches!(self, Self::Student { .. })
    }

    /// Whether a student is trained and quantized.
    pub(crate) const fn has_student(self) -> bool {
        matches!(self, Self::Main | Self::Wrist | Self::Student { .. })
    }

    /// Whether the baselines and a second student, without a teacher, are trained for comparison.
    pub(crate) const fn has_baselines(self) -> bool {
        matches!(self, Self::Main | Self::Wrist)
    }

    /// Whether training starts from [`Variant::Pretraining`].
    pub(crate) const fn starts_from_pretraining(self) -> bool {
        matches!(self, Self::Pretrained | Self::FineTuned | Self::Lora)
    }

    /// The study's preset, modified for this variant.
    pub(crate) fn preset(self, base: &Preset) -> Preset {
        let mut preset = base.clone();
        match self {
            Self::Main => {}
            Self::Window(samples) => preset.teacher.window = samples,
            Self::Wrist => {
                preset.classes = 6;
                preset.data.data_sets = OTHERS.to_vec();
            }
            Self::Pretraining => {
                preset.data.data_sets = OTHERS.to_vec();
                preset.data.held_out.clear();
                preset.data.held_out_share = 0.0;
            }
            Self::Pretrained | Self::FineTuned | Self::Lora => {
                preset.data.data_sets = vec![TARGET];
                if self == Self::Pretrained {
                    preset.fine_tuning.epochs = 0;
                }
                preset = preset.fine_tuned(self == Self::Lora);
            }
            Self::Scratch => preset.data.data_sets = vec![TARGET],
            Self::Student { width, layers } => preset = student_preset(preset, width, layers),
        }
        preset
    }
}

/// The data sets that these variants of a preset use; empty, as in a preset, where one of them uses all.
pub(crate) fn data_sets(variants: &[Variant], base: &Preset) -> Vec<DataSet> {
    let used: Vec<Vec<DataSet>> = variants
        .iter()
        .map(|variant| variant.preset(base).data.data_sets)
        .collect();
    if used.iter().any(Vec::is_empty) {
        return Vec::new();
    }
    used.concat()
        .into_iter()
        .collect::<BTreeSet<_>>()
        .into_iter()
        .collect()
}

/// A student of this size, trained like the shipped one (preset `cpu`).
fn student_preset(mut preset: Preset, width: usize, layers: usize) -> Preset {
    preset.student.d_model = width;
    preset.student.layers = layers;
    preset.student.span = usual_span(layers);
    // The question is what size gains, on whatever computer.
    preset.student.board = false;
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

/// A name that no variant has.
#[derive(Clone, PartialEq, Eq, Debug, Error)]
#[error("expected one of {known}, found {found:?}")]
pub(crate) struct UnknownVariant {
    found: String,
    known: String,
}

impl FromStr for Variant {
    type Err = UnknownVariant;

    fn from_str(text: &str) -> Result<Self, UnknownVariant> {
        let all = || Self::ALL.into_iter().chain(Self::STUDENTS);
        all()
            .find(|variant| variant.to_string() == text)
            .ok_or_else(|| {
                let known: Vec<String> = all().map(|variant| variant.to_string()).collect();
                UnknownVariant {
                    found: text.to_owned(),
                    known: known.join(", "),
                }
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baselines::settings::find_preset;

    #[test]
    fn every_variant_has_a_valid_preset_and_a_name_that_is_read_back() {
        let (base, _) = find_preset("study").unwrap();
        for variant in Variant::ALL.into_iter().chain(Variant::STUDENTS) {
            let preset = variant.preset(&base);
            // The pre-trained teacher has 0 epochs, which a preset file must not have.
            if variant != Variant::Pretrained {
                Preset::parse("variant", &preset.to_toml()).unwrap();
            }
            assert_eq!(variant.to_string().parse(), Ok(variant));
        }
        assert!("window-200".parse::<Variant>().is_err());
    }

    #[test]
    fn the_data_sets_of_variants_are_those_of_each() {
        let (base, _) = find_preset("study").unwrap();
        assert_eq!(data_sets(&[Variant::Main], &base), base.data.data_sets);
        let all_but_one = data_sets(&[Variant::Wrist, Variant::Scratch], &base);
        assert_eq!(all_but_one.len(), 1 + OTHERS.len());
        let sized = Variant::STUDENTS[0];
        assert!(data_sets(&[Variant::Main, sized], &base).is_empty());
    }

    #[test]
    fn the_target_is_not_in_the_pretraining() {
        let (base, _) = find_preset("study").unwrap();
        let sets = Variant::Pretraining.preset(&base).data.data_sets;
        assert!(!sets.contains(&TARGET) && !sets.is_empty());
    }
}
