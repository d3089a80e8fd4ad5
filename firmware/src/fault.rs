//! Reset after a panic, a fault or a stack overflow.

use core::fmt;
use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;

use crate::board;
use crate::reset_reason::End;

/// Safe outputs, a message, a reset.
#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    board::enter_safe_state(&Words(info), End::Panic);
    SCB::sys_reset()
}

/// Words of a panic, the message first: the path of a library's file is long.
struct Words<'p>(&'p PanicInfo<'p>);

impl fmt::Display for Words<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "panicked: {}", self.0.message())?;
        let Some(place) = self.0.location() else {
            return Ok(());
        };
        let file = place.file();
        // Crate, `src` and file.
        let names = file.rmatch_indices('/').map(|(at, _)| at + 1);
        let start = names.take(3).last().unwrap_or(0);
        let file = file.get(start..).unwrap_or(file);
        write!(f, ", {file}:{}", place.line())
    }
}

/// Handles a stack overflow, on a stack of its own.
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
mod hard_fault {
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
