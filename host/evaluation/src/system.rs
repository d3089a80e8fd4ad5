//! Systems under evaluation: models and floors.

use std::borrow::Cow;
use std::fmt;

use serde::{Deserialize, Serialize};

/// A system under evaluation, by which rows of results are told apart. Tables and files have its name, which is no other
/// system's.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "String", into = "String")]
pub enum System {
    /// Floor: every label is relax.
    Constant,
    /// Floor: the energy detector.
    Energy,
    /// Teacher of a run.
    Teacher,
    /// Float student of a run.
    Student,
    /// Integer student of a run: what devices run.
    Integer,
    /// A model file of this name, or any other program that gives labels.
    Model(String),
    /// The model file of this name, after alignment.
    Aligned(String),
    /// The model file of this name, after calibration.
    Calibrated(String),
}

/// Name of [`System::Constant`].
pub const CONSTANT: &str = "constant relax";
/// Name of [`System::Energy`].
pub const ENERGY: &str = "energy detector";

/// Names of the systems that have a fixed one.
const NAMES: [(System, &str); 5] = [
    (System::Constant, CONSTANT),
    (System::Energy, ENERGY),
    (System::Teacher, "teacher"),
    (System::Student, "float student"),
    (System::Integer, "integer student"),
];
const ALIGNED: &str = ", aligned";
const CALIBRATED: &str = ", calibrated";

impl System {
    /// Whether it is a floor, which needs no model.
    pub const fn is_floor(&self) -> bool {
        matches!(self, Self::Constant | Self::Energy)
    }

    /// Name in tables.
    pub fn name(&self) -> Cow<'_, str> {
        self.remarked("")
    }

    /// Name of the model file; none for other systems.
    pub(crate) fn model(&self) -> Option<&str> {
        match self {
            Self::Model(name) | Self::Aligned(name) | Self::Calibrated(name) => Some(name),
            _ => None,
        }
    }

    /// Name in tables, with a remark behind the model file's name.
    pub(crate) fn remarked(&self, remark: &str) -> Cow<'_, str> {
        match self {
            Self::Model(name) if remark.is_empty() => name.into(),
            Self::Model(name) => format!("{name}{remark}").into(),
            Self::Aligned(name) => format!("{name}{remark}{ALIGNED}").into(),
            Self::Calibrated(name) => format!("{name}{remark}{CALIBRATED}").into(),
            fixed => {
                let mut names = NAMES.iter();
                let own = names.find(|(system, _)| system == fixed);
                own.map_or("", |(_, name)| name).into()
            }
        }
    }
}

impl fmt::Display for System {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.name())
    }
}

impl From<&str> for System {
    fn from(name: &str) -> Self {
        if let Some((system, _)) = NAMES.into_iter().find(|(_, own)| *own == name) {
            system
        } else if let Some(model) = name.strip_suffix(ALIGNED) {
            Self::Aligned(model.to_owned())
        } else if let Some(model) = name.strip_suffix(CALIBRATED) {
            Self::Calibrated(model.to_owned())
        } else {
            Self::Model(name.to_owned())
        }
    }
}

impl From<String> for System {
    fn from(name: String) -> Self {
        Self::from(&name[..])
    }
}

impl From<System> for String {
    fn from(system: System) -> Self {
        system.name().into_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_read_back() {
        let named = ["m", "m, aligned", "m, calibrated"].map(System::from);
        assert_eq!(named[1], System::Aligned("m".to_owned()));
        for system in NAMES.into_iter().map(|(system, _)| system).chain(named) {
            assert_eq!(System::from(&system.name()[..]), system);
        }
    }
}
