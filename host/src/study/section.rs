//! The places of a page, and what fills those that are empty.

use super::Sheet;
use super::variant::Variant;
use crate::evaluation::judge::Truth;

pub(super) const MAIN: &str = "main";
pub(super) const WRIST: &str = "wrist";
/// Every table comes twice.
pub(super) const TRUTHS: [Truth; 2] = [Truth::Moved, Truth::Published];

/// What the variants are, as far as the tables know them.
const KNOWN: [(&str, &str); 8] = [
    (MAIN, "3 classes on roshambo and ss-stm"),
    (
        WRIST,
        "the wrist's classes too, on ss-stm, myo-readings and cote-allard",
    ),
    ("scratch", "a teacher trained on roshambo alone"),
    (
        "pretrained",
        "a teacher trained on all other sets, never on roshambo",
    ),
    ("fine-tuned", "that teacher, fine-tuned on roshambo"),
    ("lora", "that teacher, fine-tuned on roshambo with LoRA"),
    ("window-100", "a teacher that sees 100 samples"),
    ("window-300", "a teacher that sees 300 samples"),
];

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
    let what = KNOWN
        .iter()
        .find(|(known, _)| *known == variant)
        .map_or_else(String::new, |(_, what)| format!(" ({what})"));
    format!("`myointent study --variant {variant}`{what} would fill it")
}
