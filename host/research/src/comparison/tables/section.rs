//! The sections of the page: tables, or the command that fills an empty place.

use super::sheet::Sheet;
use crate::comparison::variant::Variant;
use myointent::evaluation::Truth;

/// Every table exists for both kinds of labels.
pub(super) const TRUTHS: [Truth; 2] = [Truth::LagCompensated, Truth::Published];

/// A table or its empty place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Section {
    /// A table.
    Sheet(Sheet),
    /// No runs for a table.
    Absent {
        /// Its headline.
        title: String,
        /// Which command would fill it.
        reason: String,
    },
}

impl Section {
    /// An empty place, with the variants that would fill it.
    pub(super) fn absent(title: &str, variants: &[&str]) -> Self {
        let commands: Vec<String> = variants.iter().map(|name| command(name)).collect();
        Self::Absent {
            title: title.to_owned(),
            reason: format!("Missing: run {}.", commands.join("; ")),
        }
    }
}

/// The command that runs a missing variant, and what the variant is.
pub(super) fn command(variant: &str) -> String {
    let what = variant.parse::<Variant>().map_or_else(
        |_| String::new(),
        |known| format!(" ({})", known.description()),
    );
    format!("`myointent-research study --variant {variant}`{what}")
}
