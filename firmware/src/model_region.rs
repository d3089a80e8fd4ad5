//! The part of flash that holds the model file (`MODEL` in `memory.x`).
//!
//! It is flashed apart from the program, so it may be erased, or hold an old model or noise.

use shared::model::file::ModelError;
use shared::stream::smoother::SettingsError;

/// Why the region's content cannot be run.
#[derive(Clone, Copy, Debug, thiserror::Error)]
pub enum ModelRefused {
    /// It is no model file, or a damaged one, or one too large for the device.
    #[error("model refused: {0}")]
    Model(#[from] ModelError),
    /// Its header asks for smoother settings that are out of range.
    #[error("model refused: {0}")]
    Smoother(#[from] SettingsError),
}

#[cfg(target_os = "none")]
pub use flash::bytes;
#[cfg(not(target_os = "none"))]
pub use simulated::{bytes, insert};

#[cfg(target_os = "none")]
mod flash {
    use core::{ptr, slice};

    /// The whole region.
    #[expect(
        unsafe_code,
        reason = "only the linker script knows where the region lies"
    )]
    pub fn bytes() -> &'static [u8] {
        // SAFETY: memory.x defines both symbols, as the two ends of its region MODEL. Only their
        // addresses are used; nothing is read through them.
        unsafe extern "C" {
            static _model_start: u8;
            static _model_end: u8;
        }
        let start = (&raw const _model_start).addr();
        let length = (&raw const _model_end).addr() - start;
        let start = ptr::with_exposed_provenance(start);
        // SAFETY: the addresses from `start` on, `length` of them, are flash that every board has and
        // that no section of the program is placed in, so no other Rust object overlaps them. Any byte
        // is a valid `u8`, and alignment is 1. This program never writes flash, so the bytes stay
        // constant for `'static`. The region is 160 KiB, far below `isize::MAX`.
        unsafe { slice::from_raw_parts(start, length) }
    }
}

#[cfg(not(target_os = "none"))]
mod simulated {
    use std::sync::OnceLock;

    static REGION: OnceLock<Vec<u8>> = OnceLock::new();

    /// Writes the region, once, before it is read.
    pub fn insert(bytes: Vec<u8>) {
        // A second writing would be that of flash in use.
        let _ = REGION.set(bytes);
    }

    /// The whole region.
    pub fn bytes() -> &'static [u8] {
        REGION.get_or_init(Vec::new)
    }
}
