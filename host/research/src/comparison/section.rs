//! The places of a page, and what fills those that are empty.

use super::Sheet;
use super::variant::Variant;
use myointent::evaluation::Truth;

pub(super) const MAIN: &str = "main";
pub(super) const WRIST: &str = "wrist";
/// Every table comes twice.
pub(super) const TRUTHS: [Truth; 2] = [Truth::LagCompensated, Truth::Published];

/// A table or its place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Section {
    /// A table.
    Sheet(Sheet),
    /// No runs for a table.
    Absent {
        /// Its headline.
        title: String,
        /// What would fill it.
        reason: String,
    },
}

impl Section {
    /// The line in a table's place: the variants that would fill it.
    pub(super) fn absent(title: &str, variants: &[&str]) -> Self {
        let reasons: Vec<String> = variants.iter().map(|name| would_fill(name)).collect();
        Self::Absent {
            title: title.to_owned(),
            reason: format!("Not there: {}.", reasons.join("; ")),
        }
    }
}

/// Whether the tables have a place for a variant of this name.
pub(super) fn is_known(variant: &str) -> bool {
    variant.parse::<Variant>().is_ok()
}

/// What a variant that is not there would be.
pub(super) fn would_fill(variant: &str) -> String {
    let what = variant.parse::<Variant>().map_or_else(
        |_| String::new(),
        |known| format!(" ({})", known.description()),
    );
    format!("`myointent study --variant {variant}`{what} would fill it")
}
