//! The part of flash that holds the model file (`MODEL` in `memory.x`).
//!
//! It is flashed apart from the program, so it may be erased, or hold an old model or noise; or the program exchanges it
//! ([`installation`](crate::installation)), and power may have failed meanwhile.

use shared::installation::journal::{self, Journal};
use shared::model::encoder::DeviceEncoder;
use shared::model::file::{Model, ModelError};
use shared::pipeline::{Input, Smoother};
use shared::stream::smoother::SettingsError;

use crate::flash::Region;

/// Why the region's content cannot be run.
#[derive(Clone, Copy, Debug, thiserror::Error)]
pub enum ModelRefused {
    /// The file is not a model, is damaged, or is too large for the device.
    #[error("model refused: {0}")]
    Model(#[from] ModelError),
    /// The header has smoother settings that are out of range.
    #[error("model refused: {0}")]
    Smoother(#[from] SettingsError),
    /// The model is being exchanged.
    #[error(
        "no model: an installation is not complete; `myointent board --port PATH install FILE` with the same file goes on with it"
    )]
    Incomplete,
}

/// A model that can be run.
pub struct Loaded {
    /// Encoder of the model.
    pub encoder: DeviceEncoder<'static>,
    /// Smoother with the model's settings.
    pub smoother: Smoother,
    /// Input that the model requires.
    pub input: Input,
    /// CRC-32 of its file.
    pub checksum: u32,
}

/// Reads the region and hands over what is in it, which may not be used once an installation has asked for its end.
///
/// # Errors
/// Says why the model cannot be run.
// Handed over, not returned: what is read and what takes it are large, and are not on the stack at the same time. Not
// inlined: its stack frame is released before anything else runs.
#[inline(never)]
pub fn load(take: &mut dyn FnMut(Loaded)) -> Result<(), ModelRefused> {
    let bytes = bytes();
    let model = Model::parse(bytes)?;
    // The file ends with it.
    let checksum = bytes[..model.length].last_chunk();
    let encoder = DeviceEncoder::new(&model)?;
    let settings = model.header.smoother.in_patches();
    take(Loaded {
        smoother: Smoother::new(settings, encoder.classes())?,
        encoder,
        input: Input {
            preprocessing: model.header.preprocessing,
            template: model.header.template,
        },
        checksum: checksum.map_or(0, |bytes| u32::from_le_bytes(*bytes)),
    });
    Ok(())
}

/// Journal of an installation that is not complete.
pub fn journal() -> Option<Journal> {
    journal::read(&Region::Journal.read(0))
}

#[cfg(target_os = "none")]
use flash::bytes;

/// The whole region, as it is now.
#[cfg(not(target_os = "none"))]
fn bytes() -> &'static [u8] {
    crate::flash::contents(Region::Model).leak()
}

#[cfg(target_os = "none")]
mod flash {
    use core::{ptr, slice};

    use crate::flash::Region;

    /// The whole region.
    #[expect(
        unsafe_code,
        reason = "only the linker script knows where the region lies"
    )]
    pub fn bytes() -> &'static [u8] {
        let start = ptr::with_exposed_provenance(Region::Model.address(0) as usize);
        // SAFETY: the addresses of the region are flash that every board has and that no section of the program is placed
        // in, so no other Rust object overlaps them. Any byte is a valid `u8`, and alignment is 1. The program writes it in
        // one place, `installation`, and there only after the inference has given up what it borrowed and for as long as no
        // model is in use; a slice that was given before is not read then, and a fresh one is made after. The region is
        // 160 KiB, far below `isize::MAX`.
        unsafe { slice::from_raw_parts(start, Region::Model.length() as usize) }
    }
}
