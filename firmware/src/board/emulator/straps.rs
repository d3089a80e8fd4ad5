//! What whoever starts the emulator may set before the program runs. A reset leaves it as it is.

/// A fault to be provoked.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// A task that waits for ever.
    TaskStops,
    /// A panic.
    Panic,
    /// An instruction that there is none of.
    BadInstruction,
}

/// How many times slower than the wall the clock runs, 1 if nothing was set.
///
/// A busy machine then looks like a short pause: 200 ms of silence are seconds of the wall.
pub fn time_scale() -> u64 {
    let [scale, _] = words();
    u64::from(scale).max(1)
}

/// The fault to be provoked, none if nothing was set.
pub fn fault() -> Option<Fault> {
    let [_, fault] = words();
    match fault {
        1 => Some(Fault::TaskStops),
        2 => Some(Fault::Panic),
        3 => Some(Fault::BadInstruction),
        _ => None,
    }
}

#[expect(
    unsafe_code,
    reason = "written by the emulator's loader, known to the linker script"
)]
fn words() -> [u32; 2] {
    unsafe extern "C" {
        static _straps: [u32; 2];
    }
    // SAFETY: the linker script sets the symbol to two aligned words of a region that holds no
    // section; they are written before the program starts and never by it.
    unsafe { (&raw const _straps).read_volatile() }
}
