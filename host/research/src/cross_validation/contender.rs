//! Contenders of a cross-validation.

use clap::ValueEnum as _;

use evaluation::{CONSTANT, ENERGY};
use presets::Preset;

use crate::baselines::Baseline;

/// Contender: a preset's integer student, or a model to compare it with.
#[derive(Clone, Debug)]
pub(crate) struct Contender {
    /// Preset; for a baseline or a floor, it gives the recordings, the people and the seed.
    pub(crate) preset: Preset,
    pub(crate) kind: ContenderKind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ContenderKind {
    /// Integer student of the preset.
    Student,
    /// Baseline.
    Baseline(Baseline),
    /// Floor: the constant label relax.
    Constant,
    /// Floor: an energy detector, which uses only the amplitude, fitted to the training people.
    EnergyDetector,
}

impl Contender {
    /// Name in tables.
    pub(crate) fn name(&self) -> &str {
        match self.kind {
            ContenderKind::Student => &self.preset.name,
            ContenderKind::Baseline(baseline) => baseline.name(),
            ContenderKind::Constant => CONSTANT,
            ContenderKind::EnergyDetector => ENERGY,
        }
    }

    /// Name on the command line.
    pub(crate) fn argument(&self) -> String {
        match self.kind {
            ContenderKind::Student => self.preset.name.clone(),
            ContenderKind::Baseline(baseline) => baseline
                .to_possible_value()
                .map_or_else(String::new, |value| value.get_name().to_owned()),
            ContenderKind::Constant | ContenderKind::EnergyDetector => {
                self.name().replace(' ', "-")
            }
        }
    }

    pub(crate) fn folder(&self) -> String {
        match self.kind {
            ContenderKind::Student => self.preset.name.clone(),
            _ => format!("{}-{}", self.preset.name, self.argument()),
        }
    }

    pub(crate) fn with_seed(&self, seed: u64) -> Self {
        Self {
            preset: Preset {
                seed,
                ..self.preset.clone()
            },
            kind: self.kind,
        }
    }

    /// Whether it is a trained model, whose logits allow a confidence gate. A floor's logits only express its label.
    pub(crate) const fn is_trained(&self) -> bool {
        !matches!(
            self.kind,
            ContenderKind::Constant | ContenderKind::EnergyDetector
        )
    }
}
