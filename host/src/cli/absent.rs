//! Commands of features that this program was built without: their error says what to build.

use clap::error::{ContextKind, ContextValue};

/// Advice for what needs the training feature.
pub(crate) const WITHOUT_TRAINING: &str = "this program was built without training; `cargo run --release -- COMMAND` builds and runs all of it";
/// Advice for `data fetch`.
const WITHOUT_DOWNLOADS: &str = "this program was built without downloads; to build and run it with them:\n\
     cargo run --release --package myointent --no-default-features --features fetch -- data fetch NAME";

/// Advice for a command line that names such a command.
pub(super) fn advice(error: &clap::Error) -> Option<&'static str> {
    let Some(ContextValue::String(name)) = error.get(ContextKind::InvalidSubcommand) else {
        return None;
    };
    match name.as_str() {
        "quickstart" | "train" | "quantize" | "export" | "personalize" => Some(WITHOUT_TRAINING),
        "fetch" => Some(WITHOUT_DOWNLOADS),
        _ => None,
    }
}
