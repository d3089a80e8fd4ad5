//! Configuration words that the emulator's loader writes before the program runs. A reset keeps them.

/// A fault to inject.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// A task waits forever.
    TaskStops,
    /// A panic.
    Panic,
    /// An undefined instruction.
    UndefinedInstruction,
    /// A task loops and never returns to the executor.
    ExecutorStops,
    /// An interrupt that is pending again whenever it was handled: no task runs.
    InterruptStorm,
    /// The inference loops and never returns.
    InferenceLoops,
    /// A function that calls itself without end.
    Recursion,
    /// The timer of all deadlines interrupts no more.
    ClockStops,
    /// Nothing more is received from the Bluetooth controller.
    RadioStops,
    /// The inference takes too long for one packet, and goes on.
    InferencePauses,
}

/// Factor by which the clock runs slower than real time, 1 if nothing was set.
///
/// With 5, the 200 ms of silence are a second of real time, so that a busy host does not look silent.
pub fn time_scale() -> u64 {
    let [scale, _] = words();
    u64::from(scale).max(1)
}

/// The fault to inject, none if nothing was set.
pub fn fault() -> Option<Fault> {
    let [_, fault] = words();
    match fault {
        1 => Some(Fault::TaskStops),
        2 => Some(Fault::Panic),
        3 => Some(Fault::UndefinedInstruction),
        4 => Some(Fault::ExecutorStops),
        5 => Some(Fault::InterruptStorm),
        6 => Some(Fault::InferenceLoops),
        7 => Some(Fault::Recursion),
        8 => Some(Fault::ClockStops),
        9 => Some(Fault::RadioStops),
        10 => Some(Fault::InferencePauses),
        _ => None,
    }
}

#[expect(
    unsafe_code,
    reason = "written by the emulator's loader, at an address of the linker script"
)]
fn words() -> [u32; 2] {
    // SAFETY: memory.x defines the symbol, as the start of its region STRAPS, which has two words.
    unsafe extern "C" {
        static _straps: [u32; 2];
    }
    // SAFETY: the symbol is the word-aligned start of 8 bytes of memory that no section of the
    // program is placed in. The loader writes them before the program starts, and nothing does
    // afterwards; any value is a valid `u32`.
    unsafe { (&raw const _straps).read_volatile() }
}
