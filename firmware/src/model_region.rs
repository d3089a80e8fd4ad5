//! The part of flash that holds the model file (`MODEL` in `memory.x`).
//!
//! It is flashed apart from the program, so it may hold nothing, an old model or noise.

/// The whole region, in place.
#[expect(
    unsafe_code,
    reason = "the linker script is the only one who knows where it lies"
)]
pub fn bytes() -> &'static [u8] {
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
