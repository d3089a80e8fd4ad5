//! Ablations: tables with one model and a row per variant.

use shared::units::WINDOW;

use super::heading::{Heading, ModelRow};
use super::scores::{ACCURACY, scores};
use super::section::{Section, TRUTHS, command};
use crate::comparison::results::StudyResults;
use crate::comparison::variant::Variant;
use myointent::run::evaluate::{INTEGER, TEACHER};

const PRE_TRAINING: [Variant; 4] = [
    Variant::Scratch,
    Variant::Pretrained,
    Variant::FineTuned,
    Variant::Lora,
];
/// Start of the name of a variant with another window.
const WINDOW_PREFIX: &str = "window-";

/// The effect of pre-training.
pub(super) fn pre_training(study: &StudyResults) -> Vec<Section> {
    let heading = Heading {
        name: "pre-training",
        title: "Pre-training ablation, 3 classes",
        caption: "The teacher on roshambo: trained on roshambo only; pre-trained on the other data \
            sets; pre-trained and fine-tuned on roshambo; the same with LoRA.",
        rows: "training",
    };
    let rows = PRE_TRAINING.map(|variant| (variant.to_string(), variant.to_string()));
    by_variant(study, &heading, &rows, TEACHER)
}

/// The effect of the length of the window.
pub(super) fn windows(study: &StudyResults) -> Vec<Section> {
    let heading = Heading {
        name: "window",
        title: "Window length of the teacher, 3 classes",
        caption: "The teacher by window length in samples of 5 ms.",
        rows: "window",
    };
    let mut sizes: Vec<usize> = study
        .variants
        .keys()
        .filter_map(|name| window(name))
        .collect();
    if sizes.is_empty() {
        return vec![Section::absent(
            heading.title,
            &["window-100", "window-300"],
        )];
    }
    sizes.extend([100, 300]);
    sizes.sort_unstable();
    sizes.dedup();
    let mut rows: Vec<(String, String)> = sizes
        .into_iter()
        .map(|size| (size.to_string(), format!("{WINDOW_PREFIX}{size}")))
        .collect();
    // The paper's window is that of the main variant.
    rows.push((WINDOW.to_string(), Variant::Main.to_string()));
    by_variant(study, &heading, &rows, TEACHER)
}

/// The effect of the size of the student; nothing in a study without such variants.
pub(super) fn sizes(study: &StudyResults) -> Vec<Section> {
    let heading = Heading {
        name: "sizes",
        title: "Size of the student, 3 classes",
        caption: "The integer student by width and number of layers, trained on the labels of all data \
            sets, without a teacher.",
        rows: "width x layers",
    };
    let rows: Vec<(String, String)> = Variant::STUDENTS
        .iter()
        .map(ToString::to_string)
        .filter(|name| study.variants.contains_key(name))
        .map(|name| (name.trim_start_matches("student-").to_owned(), name))
        .collect();
    if rows.is_empty() {
        return Vec::new();
    }
    by_variant(study, &heading, &rows, INTEGER)
}

/// One model of several variants, a row per `(label, variant)`. Missing variants become warnings.
fn by_variant(
    study: &StudyResults,
    heading: &Heading<'_>,
    rows: &[(String, String)],
    model: &str,
) -> Vec<Section> {
    let (mut models, mut missing): (_, Vec<&str>) = (Vec::new(), Vec::new());
    for (label, name) in rows {
        match study.variants.get(name) {
            Some(variant) => models.push(ModelRow {
                label: label.clone(),
                variant,
                model,
            }),
            None => missing.push(name),
        }
    }
    if models.is_empty() {
        return vec![Section::absent(heading.title, &missing)];
    }
    TRUTHS
        .map(|truth| {
            let mut sheet = scores(heading, &models, &ACCURACY, truth);
            sheet.warnings.extend(
                missing
                    .iter()
                    .map(|name| format!("missing row: run {}", command(name))),
            );
            Section::Sheet(sheet)
        })
        .to_vec()
}

/// The window length in the name of a variant.
pub(super) fn window(name: &str) -> Option<usize> {
    name.strip_prefix(WINDOW_PREFIX)?.parse().ok()
}
