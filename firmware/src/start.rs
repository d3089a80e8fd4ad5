//! From reset to running tasks, and from a panic back to reset.

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use embassy_executor::{SpawnError, SpawnToken, Spawner};

use crate::board;
use crate::tasks::{
    inference,
    output::{self, Line},
    radio, watchdog,
};

#[cfg(not(any(feature = "emulator", feature = "nrf52832", feature = "nrf52840")))]
compile_error!("choose a board: --features nrf52840, nrf52832 or emulator");
#[cfg(all(
    feature = "chip",
    not(any(feature = "radio-softdevice", feature = "radio-trouble"))
))]
compile_error!("choose a radio: --features radio-softdevice or radio-trouble");
#[cfg(all(feature = "model-in-ram", not(feature = "nrf52840")))]
compile_error!("model-in-ram needs the 256 KiB of an nRF52840");

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    // The outputs come first: from reset to here every pin floats.
    let board = board::start();
    output::say(Line::Started(board.restart));
    spawn(&spawner, output::run(board.labels, board.pins));
    spawn(&spawner, watchdog::run(board.watchdog));
    match inference::load(board.restart) {
        Ok(pipeline) => {
            spawn(&spawner, inference::run(pipeline));
            spawn(&spawner, radio::run(spawner, board.radio));
        }
        Err(refusal) => spawn(&spawner, inference::refuse(refusal, board.restart)),
    }
}

fn spawn<S>(spawner: &Spawner, task: Result<SpawnToken<S>, SpawnError>) {
    match task {
        Ok(token) => spawner.spawn(token),
        Err(_) => panic!("a task is started twice"),
    }
}

/// Safe outputs, a message, a reset.
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    board::last_words(info);
    SCB::sys_reset()
}

/// A fault is handled as a panic: the default would hold the last label for ever.
#[allow(unsafe_code, reason = "cortex-m-rt wants the handler declared so")]
mod fault {
    use cortex_m_rt::{ExceptionFrame, exception};

    #[exception]
    unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
        panic!("hard fault at {:#010x}", frame.pc());
    }
}
