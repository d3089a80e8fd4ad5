//! The part of flash that holds the model file (`MODEL` in `memory.x`).
//!
//! It is flashed apart from the program, so it may hold nothing, an old model or noise.

/// The whole region: where it lies, or a copy in RAM, if the feature `model-in-ram` asks for one.
///
/// No cache hides what a word of data from flash waits; a copy costs 160 KiB of RAM (docs/budgets.md). To be
/// called once.
pub fn bytes() -> &'static [u8] {
    #[cfg(feature = "model-in-ram")]
    return in_ram(in_flash());
    #[cfg(not(feature = "model-in-ram"))]
    in_flash()
}

#[cfg(feature = "model-in-ram")]
fn in_ram(region: &[u8]) -> &'static [u8] {
    use shared::model::Aligned;
    use static_cell::ConstStaticCell;

    /// As long as the region is in `memory.x`.
    const ROOM: usize = 160 * 1024;
    static COPY: ConstStaticCell<Aligned<[u8; ROOM]>> = ConstStaticCell::new(Aligned([0; ROOM]));

    let copy = &mut COPY.take().0;
    // Of another length only if memory.x was changed: what is cut off is then missed by the checksum.
    let length = region.len().min(ROOM);
    copy[..length].copy_from_slice(&region[..length]);
    copy
}

#[expect(
    unsafe_code,
    reason = "the linker script is the only one who knows where it lies"
)]
fn in_flash() -> &'static [u8] {
    unsafe extern "C" {
        static _model_start: u8;
        static _model_end: u8;
    }
    let start = &raw const _model_start;
    let end = &raw const _model_end;
    // SAFETY: memory.x sets both symbols to the ends of one region of flash that holds no other
    // section, and this program never writes flash, so the bytes are readable and constant.
    unsafe { core::slice::from_raw_parts(start, end.addr() - start.addr()) }
}
