//! Which tables there are, of which variants, and what to say of those that are not there.

use super::ablation::{pre_training, sizes, window, windows};
use super::difference::differences;
use super::offsets::offsets;
use super::scores::{ACCURACY, BY_BUFFER, Heading, Line, Measure, scores};
use super::section::{MAIN, Section, TRUTHS, WRIST, is_known};
use super::{Outcome, Outcomes, Sheet, folds};
use crate::baselines::Baseline;
use myointent::evaluation::Truth;
use myointent::run::evaluate::{INTEGER, INTEGER_LABELS_ONLY, LABELS_ONLY, STUDENT, TEACHER};

/// The tables of a study, in the order of the page.
#[derive(Clone, Debug)]
pub struct Tables {
    /// Name of the study.
    pub study: String,
    /// Tables, and lines where one is not there.
    pub sections: Vec<Section>,
}

/// Rows in the order of the paper: its baselines, then ours; models that are not here come last.
const MODELS: [&str; 10] = [
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
const OURS: [(&str, &str); 5] = [
    (INTEGER, TEACHER),
    (STUDENT, TEACHER),
    (INTEGER, STUDENT),
    (STUDENT, LABELS_ONLY),
    (INTEGER, INTEGER_LABELS_ONLY),
];
const INTRODUCTION: &str = "\
Every score is mean (sample deviation) over people, each of whom one fold leaves out and no model of
that fold has seen. `raw`: share of right samples. `TA`: transition accuracy, the share of changes
followed within the buffer around them, 200 samples unless the column says otherwise. `n`: subjects /
transitions. Look-ahead 0 takes the newest row alone; 0.25 s is shown in the reading that was chosen
on validation subjects, or in the paper's (all rows) where folds chose differently. A model that
answers about its newest sample alone has no numbers with look-ahead (`-`).

Labels of these recordings are cues, and muscles follow later. *Labels moved*: by one constant a data
set, estimated on training subjects. *Labels as published*: as the paper scores.
";

/// Makes every table that the study has runs for.
#[must_use]
pub fn tables(study: &Outcomes) -> Tables {
    let mut sections = Vec::new();
    let main = Heading {
        name: MAIN,
        title: "Main results, 3 classes",
        caption: "All models on the people left out.",
        rows: "model",
    };
    let wrist = Heading {
        name: WRIST,
        title: "Main results, 4 or 5 classes",
        caption: "Four classes in ss-stm and myo-readings (relax, close, wave-in, wave-out), open \
            too in cote-allard; pinch is recorded in none. The steady holds of cote-allard have \
            no transitions.",
        rows: "model",
    };
    let late = Heading {
        name: "offsets",
        title: "Prediction offsets, 3 classes",
        caption: "Predicted minus true instant of the changes that were followed, in ms, mean \
            (sample deviation) over changes; positive is late. Spoken: booked at the instant a \
            label speaks of, as the paper does; emitted: when it comes out, look-ahead included. \
            n: followed / transitions.",
        rows: "model",
    };
    let buffer = Heading {
        name: "buffer",
        title: "Width of the buffer, 3 classes",
        caption: "Transition accuracy with a buffer of 60, 120 and 200 samples (300, 600 and \
            1000 ms) around each change, both sides together.",
        rows: "model",
    };
    let ours = Heading {
        name: "ours",
        title: "Ours: what integers and distillation change, 3 classes",
        caption: "Differences of the same person's scores under two models, mean (sample \
            deviation) over n people; the scores themselves are in the main table.",
        rows: "difference",
    };
    sections.extend(all_models(study, MAIN, &main, &ACCURACY));
    sections.extend(all_models(study, WRIST, &wrist, &ACCURACY));
    sections.extend(of(study, MAIN, &late, |variant, truth| {
        offsets(&late, &lines(variant), truth)
    }));
    sections.extend(pre_training(study));
    sections.extend(windows(study));
    sections.extend(sizes(study));
    sections.extend(all_models(study, MAIN, &buffer, &BY_BUFFER));
    sections.extend(of(study, MAIN, &ours, |variant, truth| {
        differences(&ours, variant, &OURS, truth)
    }));
    let unknown = study
        .variants
        .keys()
        .filter(|name| window(name).is_none() && !is_known(name));
    for name in unknown {
        let other = Heading {
            name: &format!("variant-{name}"),
            title: &format!("Outcome `{name}`"),
            ..main
        };
        sections.extend(all_models(study, name, &other, &ACCURACY));
    }
    sections.push(Section::Sheet(folds(study.variants.values())));
    let full = std::path::absolute(&study.path).unwrap_or_else(|_| study.path.clone());
    Tables {
        study: full
            .file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
        sections,
    }
}

impl Tables {
    /// The page.
    #[must_use]
    pub fn markdown(&self) -> String {
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

    /// The tables that are there.
    pub fn sheets(&self) -> impl Iterator<Item = &Sheet> {
        self.sections.iter().filter_map(|section| match section {
            Section::Sheet(sheet) => Some(sheet),
            Section::Absent { .. } => None,
        })
    }
}

/// A variant's table under both truths, or the line in their place.
fn of(
    study: &Outcomes,
    name: &str,
    heading: &Heading<'_>,
    sheet: impl Fn(&Outcome, Truth) -> Sheet,
) -> Vec<Section> {
    match study.variants.get(name) {
        Some(variant) => TRUTHS
            .map(|truth| Section::Sheet(sheet(variant, truth)))
            .to_vec(),
        None => vec![Section::absent(heading.title, &[name])],
    }
}

fn all_models(
    study: &Outcomes,
    name: &str,
    heading: &Heading<'_>,
    measures: &[Measure],
) -> Vec<Section> {
    of(study, name, heading, |variant, truth| {
        scores(heading, &lines(variant), measures, truth)
    })
}

/// One row a model, in the order of the paper.
fn lines(variant: &Outcome) -> Vec<Line<'_>> {
    let mut models = variant.models();
    models.sort_by_key(|model| {
        let known = MODELS.iter().position(|known| known == model);
        known.unwrap_or(MODELS.len())
    });
    models
        .into_iter()
        .map(|model| Line {
            label: model.to_owned(),
            variant,
            model,
        })
        .collect()
}

#[cfg(test)]
mod tests;
