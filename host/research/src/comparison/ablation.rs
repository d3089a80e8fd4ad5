//! Tables of what one choice does to the teacher, or to the student: a row for each variant.

use super::Outcomes;
use super::scores::{ACCURACY, Heading, Line, scores};
use super::section::{MAIN, Section, TRUTHS, would_fill};
use super::variant::Variant;
use myointent::run::evaluate::{INTEGER, TEACHER};

const WINDOW: &str = "window-";
const PRE_TRAINING: [&str; 4] = ["scratch", "pretrained", "fine-tuned", "lora"];
/// The paper's window, in samples: that of `main`.
const PAPER_WINDOW: usize = 600;

/// What pre-training gives.
pub(super) fn pre_training(study: &Outcomes) -> Vec<Section> {
    let heading = Heading {
        name: "pre-training",
        title: "Pre-training ablation, 3 classes",
        caption: "The teacher on roshambo: trained on it alone, on all other sets, on them and \
            then on it, likewise with LoRA.",
        rows: "training",
    };
    let rows = PRE_TRAINING.map(|name| (name.to_owned(), name.to_owned()));
    by_variant(study, &heading, &rows, TEACHER)
}

/// What the length of the window gives.
pub(super) fn windows(study: &Outcomes) -> Vec<Section> {
    let heading = Heading {
        name: "window",
        title: "Window of the teacher, 3 classes",
        caption: "The teacher with windows of so many samples of 5 ms.",
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
        .map(|size| (size.to_string(), format!("{WINDOW}{size}")))
        .collect();
    rows.push((PAPER_WINDOW.to_string(), MAIN.to_owned()));
    by_variant(study, &heading, &rows, TEACHER)
}

/// What the size of the student gives; no place for it in a study without any.
pub(super) fn sizes(study: &Outcomes) -> Vec<Section> {
    let heading = Heading {
        name: "sizes",
        title: "Sizes of the student, 3 classes",
        caption: "The integer student, by width and layers, trained on the labels of all sets alone. \
            Without look-ahead the newest row decides by itself.",
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

/// A model of several variants, a row each `(label, variant)`; what is missing is told.
fn by_variant(
    study: &Outcomes,
    heading: &Heading<'_>,
    rows: &[(String, String)],
    model: &str,
) -> Vec<Section> {
    let (mut lines, mut missing): (_, Vec<&str>) = (Vec::new(), Vec::new());
    for (label, name) in rows {
        match study.variants.get(name) {
            Some(variant) => lines.push(Line {
                label: label.clone(),
                variant,
                model,
            }),
            None => missing.push(name),
        }
    }
    if lines.is_empty() {
        return vec![Section::absent(heading.title, &missing)];
    }
    TRUTHS
        .map(|truth| {
            let mut sheet = scores(heading, &lines, &ACCURACY, truth);
            sheet
                .warnings
                .extend(missing.iter().map(|name| would_fill(name)));
            Section::Sheet(sheet)
        })
        .to_vec()
}

/// Size of the window in the name of such a variant.
pub(super) fn window(name: &str) -> Option<usize> {
    name.strip_prefix(WINDOW)?.parse().ok()
}
