//! The page: which tables there are, of which variants.

use super::ablation::{pre_training, sizes, window, windows};
use super::differences::differences;
use super::events::events;
use super::folds::folds;
use super::heading::{Heading, ModelRow};
use super::offsets::offsets;
use super::scores::{ACCURACY, BY_BUFFER, Metric, scores};
use super::section::{Section, TRUTHS};
use super::sheet::Sheet;
use crate::baselines::Baseline;
use crate::comparison::results::{StudyResults, VariantResults};
use crate::comparison::variant::Variant;
use myointent::evaluation::{CONSTANT, ENERGY, Truth};
use myointent::run::evaluate::{INTEGER, INTEGER_LABELS_ONLY, LABELS_ONLY, STUDENT, TEACHER};

/// The tables of a study, in the order of the page.
#[derive(Clone, Debug)]
pub(crate) struct Page {
    /// Name of the study.
    study: String,
    /// Tables, and empty places of missing ones.
    sections: Vec<Section>,
}

/// Models in the order of their rows: the floors, the paper's baselines, then ours. Other models come last.
const MODELS: [&str; 12] = [
    CONSTANT,
    ENERGY,
    Baseline::Lda.name(),
    Baseline::Mlp.name(),
    Baseline::Lstm.name(),
    Baseline::EdTcn.name(),
    Baseline::TraHgr.name(),
    TEACHER,
    STUDENT,
    INTEGER,
    LABELS_ONLY,
    INTEGER_LABELS_ONLY,
];
/// Pairs of models whose differences are shown.
const PAIRS: [(&str, &str); 8] = [
    (INTEGER, CONSTANT),
    (INTEGER, ENERGY),
    (INTEGER, Baseline::EdTcn.name()),
    (INTEGER, TEACHER),
    (STUDENT, TEACHER),
    (INTEGER, STUDENT),
    (STUDENT, LABELS_ONLY),
    (INTEGER, INTEGER_LABELS_ONLY),
];
const INTRODUCTION: &str = "\
Every score is a mean over subjects, `[a, b]` its 95 % interval (bootstrap over subjects), `(s)` the sample
standard deviation. Each subject is held out in one fold, and no model of that fold was trained or validated
on it. `balanced`: mean recall of the classes present. `TA`: transition accuracy, the share of transitions
followed within the buffer around them, 200 samples unless the column says otherwise. `recognised`: share of
gestures whose label is emitted and held, and no other. `raw`: share of samples classified correctly. `n`:
subjects / transitions. The floors, a constant `relax` and an energy detector fitted to the training
subjects, need no model. Look-ahead 0 uses the newest row of logits only; 0.25 s is shown with the
aggregation mode that was chosen on validation subjects, or with the paper's (all rows) where folds chose
different ones. A model that classifies its newest sample only has no numbers with look-ahead (`-`).
docs/metrics.md has the definitions.

The labels of these recordings are cues, and the muscles follow later. *Lag-compensated labels* are
shifted by one constant per data set, estimated on training subjects. *Labels as published* are scored
unchanged, as in the paper.
";
const MAIN: Heading<'_> = Heading {
    name: "main",
    title: "Main results, 3 classes",
    caption: "All models on the held-out subjects.",
    rows: "model",
};
const WRIST: Heading<'_> = Heading {
    name: "wrist",
    title: "Main results, 4 or 5 classes",
    caption: "Four classes in ss-stm and myo-readings (relax, close, wave-in, wave-out), also open \
        in cote-allard; pinch is in none of the recordings. The static holds of cote-allard have no \
        transitions.",
    rows: "model",
};
const OFFSETS: Heading<'_> = Heading {
    name: "offsets",
    title: "Prediction offsets, 3 classes",
    caption: "Predicted minus true time of the transitions that were followed, in ms, mean (sample \
        standard deviation) over transitions; positive is late. As in the paper, a label counts from the \
        time that it refers to: the look-ahead is not included. n: followed / transitions.",
    rows: "model",
};
const EVENTS: Heading<'_> = Heading {
    name: "events",
    title: "Events, 3 classes",
    caption: "Labels count from the time at which they are emitted, look-ahead included. Share of \
        gestures recognised; median / 90th percentile of the latency from the onset of a gesture to its \
        label, missed gestures counted as infinitely late; false activations a minute of rest; label \
        changes a minute beyond the true ones. n: recognised / gestures.",
    rows: "model",
};
const BUFFER: Heading<'_> = Heading {
    name: "buffer",
    title: "Width of the transition buffer, 3 classes",
    caption: "Transition accuracy with a buffer of 60, 120 and 200 samples (300, 600 and 1000 ms) \
        around each transition, both sides together.",
    rows: "model",
};
const DIFFERENCES: Heading<'_> = Heading {
    name: "differences",
    title: "Differences of models, 3 classes",
    caption: "Paired differences: one subject's scores under two models, mean [95 % interval of the mean] \
        over n subjects. Where the interval contains zero, or n is below 6, no difference is shown. The scores \
        themselves are in the main table.",
    rows: "difference",
};

/// Every table that the study has results for.
pub(crate) fn page(study: &StudyResults) -> Page {
    let (main, wrist) = (Variant::Main.to_string(), Variant::Wrist.to_string());
    let mut sections = Vec::new();
    sections.extend(all_models(study, &main, &MAIN, &ACCURACY));
    sections.extend(all_models(study, &wrist, &WRIST, &ACCURACY));
    sections.extend(both_labels(study, &main, &EVENTS, |variant, truth| {
        events(&EVENTS, &model_rows(variant), truth)
    }));
    sections.extend(both_labels(study, &main, &OFFSETS, |variant, truth| {
        offsets(&OFFSETS, &model_rows(variant), truth)
    }));
    sections.extend(pre_training(study));
    sections.extend(windows(study));
    sections.extend(sizes(study));
    sections.extend(all_models(study, &main, &BUFFER, &BY_BUFFER));
    sections.extend(both_labels(study, &main, &DIFFERENCES, |variant, truth| {
        differences(&DIFFERENCES, variant, &PAIRS, truth)
    }));
    let unknown = study
        .variants
        .keys()
        .filter(|name| window(name).is_none() && name.parse::<Variant>().is_err());
    for name in unknown {
        let heading = Heading {
            name: &format!("variant-{name}"),
            title: &format!("Variant `{name}`"),
            ..MAIN
        };
        sections.extend(all_models(study, name, &heading, &ACCURACY));
    }
    sections.push(Section::Sheet(folds(study.variants.values())));
    let full = std::path::absolute(&study.path).unwrap_or_else(|_| study.path.clone());
    Page {
        study: full
            .file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
        sections,
    }
}

impl Page {
    /// The page as Markdown.
    pub(crate) fn markdown(&self) -> String {
        let mut text = format!("# Tables of `{}`\n\n{INTRODUCTION}", self.study);
        for section in &self.sections {
            text += "\n";
            text += &match section {
                Section::Sheet(sheet) => sheet.markdown(),
                Section::Absent { title, reason } => format!("## {title}\n\n{reason}\n"),
            };
        }
        text
    }

    /// The tables, without the empty places.
    pub(crate) fn sheets(&self) -> impl Iterator<Item = &Sheet> {
        self.sections.iter().filter_map(|section| match section {
            Section::Sheet(sheet) => Some(sheet),
            Section::Absent { .. } => None,
        })
    }
}

/// A variant's table for both kinds of labels, or an empty place.
fn both_labels(
    study: &StudyResults,
    name: &str,
    heading: &Heading<'_>,
    sheet: impl Fn(&VariantResults, Truth) -> Sheet,
) -> Vec<Section> {
    match study.variants.get(name) {
        Some(variant) => TRUTHS
            .map(|truth| Section::Sheet(sheet(variant, truth)))
            .to_vec(),
        None => vec![Section::absent(heading.title, &[name])],
    }
}

fn all_models(
    study: &StudyResults,
    name: &str,
    heading: &Heading<'_>,
    metrics: &[Metric],
) -> Vec<Section> {
    both_labels(study, name, heading, |variant, truth| {
        scores(heading, &model_rows(variant), metrics, truth)
    })
}

/// One row per model, in the order of [`MODELS`].
fn model_rows(variant: &VariantResults) -> Vec<ModelRow<'_>> {
    let mut models = variant.models();
    models.sort_by_key(|model| {
        let known = MODELS.iter().position(|known| known == model);
        known.unwrap_or(MODELS.len())
    });
    models
        .into_iter()
        .map(|model| ModelRow {
            label: model.to_owned(),
            variant,
            model,
        })
        .collect()
}

#[cfg(test)]
mod tests;
