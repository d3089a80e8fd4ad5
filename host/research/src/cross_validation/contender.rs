//! What a cross-validation trains and evaluates.

use clap::ValueEnum as _;

use evaluation::{CONSTANT, ENERGY};
use presets::Preset;

use super::teacher::PaperTeacher;
use crate::baselines::Baseline;

/// A preset's integer student, or what it is compared with.
#[derive(Clone, Debug)]
pub(crate) struct Contender {
    /// The preset; of a baseline and of a floor, that of the recordings, the people and the seed.
    pub(crate) preset: Preset,
    pub(crate) kind: Kind,
}

/// Kinds of models.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The integer student of the preset.
    Student,
    /// A teacher of the paper's tables.
    Teacher(PaperTeacher),
    /// A baseline.
    Baseline(Baseline),
    /// The label relax, always.
    Constant,
    /// Amplitude alone, fitted to the training people.
    EnergyDetector,
}

impl Contender {
    /// Name in tables.
    pub(crate) fn name(&self) -> &str {
        match self.kind {
            Kind::Student => &self.preset.name,
            Kind::Teacher(teacher) => teacher.name(),
            Kind::Baseline(baseline) => baseline.name(),
            Kind::Constant => CONSTANT,
            Kind::EnergyDetector => ENERGY,
        }
    }

    /// Name on the command line.
    pub(crate) fn argument(&self) -> String {
        match self.kind {
            Kind::Student => self.preset.name.clone(),
            Kind::Teacher(teacher) => teacher.name().to_owned(),
            Kind::Baseline(baseline) => baseline
                .to_possible_value()
                .map_or_else(String::new, |value| value.get_name().to_owned()),
            Kind::Constant | Kind::EnergyDetector => self.name().replace(' ', "-"),
        }
    }

    /// Name of its folder.
    pub(crate) fn folder(&self) -> String {
        match self.kind {
            Kind::Student => self.preset.name.clone(),
            _ => format!("{}-{}", self.preset.name, self.argument()),
        }
    }

    /// The same with another seed.
    pub(crate) fn with_seed(&self, seed: u64) -> Self {
        Self {
            preset: Preset {
                seed,
                ..self.preset.clone()
            },
            kind: self.kind,
        }
    }

    /// Whether it is a trained model, whose logits allow a confidence gate. Those of a floor say no more than its label.
    pub(crate) const fn is_trained(&self) -> bool {
        !matches!(self.kind, Kind::Constant | Kind::EnergyDetector)
    }
}
