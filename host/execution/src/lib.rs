//! Infrastructure of long computations: run folder, progress, interrupt, parallel work, bounded reads, text for a terminal.
//!
//! A browser has neither folders nor signals: as WebAssembly the first four are left out.

#![deny(missing_docs)]

pub mod bounded_read;
pub mod file_kind;
pub mod fingerprint;
#[cfg(not(target_family = "wasm"))]
pub mod interrupt;
pub mod printable;
#[cfg(not(target_family = "wasm"))]
pub mod progress;
#[cfg(not(target_family = "wasm"))]
pub mod run_folder;
pub mod utc;

/// Revision of the source that the program was built from.
pub mod revision {
    use std::sync::OnceLock;

    static REVISION: OnceLock<Option<&'static str>> = OnceLock::new();

    /// Declares the Git revision of the program's source, for the files that it writes. The program knows it and not this
    /// crate, so that a new commit recompiles only one crate.
    pub fn declare(revision: Option<&'static str>) {
        // A second declaration is of the same program.
        let _ = REVISION.set(revision.filter(|revision| !revision.is_empty()));
    }

    /// Git revision of the source that this program was compiled from, `-dirty` at its end if that had changes; none if it
    /// was compiled outside its repository.
    pub fn revision() -> Option<&'static str> {
        *REVISION.get()?
    }
}
