//! From reset to running tasks, and from a panic back to reset.

use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use embassy_executor::{SpawnError, SpawnToken, Spawner};

use crate::board;
use crate::messages::uart::{self, UartMessage};
use crate::reset_reason::End;
use crate::stack_guard;
use crate::tasks::{control, inference, output, radio, watchdog};

#[cfg(not(any(feature = "emulator", feature = "nrf52832", feature = "nrf52840")))]
compile_error!("choose a board: --features nrf52840, nrf52832 or emulator");
#[cfg(all(
    feature = "chip",
    not(any(feature = "radio-softdevice", feature = "radio-trouble"))
))]
compile_error!("choose a radio: --features radio-softdevice or radio-trouble");

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    stack_guard::start();
    // The outputs come first: from reset to here every pin floats.
    let board = board::start();
    spawn(&spawner, output::run(board.labels, board.pins));
    spawn(&spawner, watchdog::run(board.watchdog));
    let loaded = inference::load(board.reset_reason);
    let model = loaded.as_ref().ok().map(|(_, checksum)| *checksum);
    uart::enqueue(UartMessage::Started(board.reset_reason, model));
    spawn(&spawner, control::run(board.commands, board.button, model));
    match loaded {
        Ok((pipeline, _)) => {
            spawn(&spawner, inference::run(pipeline, board.dead_man));
            spawn(&spawner, radio::run(spawner, board.radio));
        }
        Err(error) => spawn(
            &spawner,
            inference::report_refused(error, board.reset_reason),
        ),
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
    board::enter_safe_state(info, End::Panic);
    SCB::sys_reset()
}

/// The same for a stack overflow, on a stack of its own.
extern "C" fn stack_overflow() -> ! {
    cortex_m::interrupt::disable();
    board::enter_safe_state(&"stack overflow", End::StackOverflow);
    SCB::sys_reset()
}

/// A fault is handled as a panic, or as a stack overflow: the default handler would loop and hold the last label forever.
#[allow(
    unsafe_code,
    reason = "cortex-m-rt requires the handler to be an unsafe fn"
)]
mod fault {
    use cortex_m_rt::{ExceptionFrame, exception};

    use super::stack_overflow;
    use crate::stack_guard;

    // SAFETY: only the core calls it, on a hard fault, with `frame` on the stack that it pushed
    // the registers to. It may interrupt any code, a critical section included: it only reads the
    // frame and panics, and the panic handler never returns to what was interrupted.
    #[exception]
    unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
        // First: the stack may be in the guard, and the frame was not saved then.
        if stack_guard::was_hit() {
            stack_guard::leave(stack_overflow);
        }
        panic!("hard fault at {:#010x}", frame.pc());
    }
}
