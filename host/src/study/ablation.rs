//! Tables of what one choice does to the teacher: a row for each variant.

use super::Outcomes;
use super::scores::{ACCURACY, Heading, Line, scores};
use super::section::{MAIN, Section, TRUTHS, would_fill};
use crate::stage::TEACHER;

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
    teachers(study, &heading, &rows)
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
    teachers(study, &heading, &rows)
}

/// The teachers of several variants, a row each `(label, variant)`; what is missing is told.
fn teachers(study: &Outcomes, heading: &Heading<'_>, rows: &[(String, String)]) -> Vec<Section> {
    let (mut lines, mut missing): (_, Vec<&str>) = (Vec::new(), Vec::new());
    for (label, name) in rows {
        match study.variants.get(name) {
            Some(variant) => lines.push(Line {
                label: label.clone(),
                variant,
                model: TEACHER,
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
