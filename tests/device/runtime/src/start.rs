//! Start of a program from reset to its own `main`, and its end with the emulator's exit code.

use core::panic::PanicInfo;

// For its critical section, which the allocator uses.
use cortex_m as _;
use cortex_m_rt::{ExceptionFrame, exception};
use embedded_alloc::LlffHeap;
use semihosting::{println, process};

use crate::harness;

/// Bytes of heap, of 16 MiB of RAM. No more: the start-up code clears it in every run, which takes time.
const HEAP_BYTES: usize = 4 << 20;
/// Exit code of a panic, the same as with `std`.
const PANICKED: i32 = 101;
/// Exit code of a hard fault.
const FAULTED: i32 = 102;

#[global_allocator]
static HEAP: LlffHeap = LlffHeap::empty();

/// Makes `fn()` the program.
#[macro_export]
macro_rules! entry {
    ($main:path) => {
        // SAFETY: cortex-m-rt calls the symbol `main` once, after RAM is initialised, as a function
        // without arguments that never returns, which this is. No other item of the image has the
        // name: with `no_main` the compiler defines none.
        #[unsafe(export_name = "main")]
        extern "C" fn reset() -> ! {
            $crate::start($main)
        }
    };
}

/// Runs a program once and ends the emulator; for [`entry!`](crate::entry).
pub fn start(main: fn()) -> ! {
    #[expect(unsafe_code, reason = "the allocator gets its memory by address")]
    // SAFETY: `init!` defines the memory that it passes to the allocator, so nothing else uses it;
    // it panics if it runs a second time.
    unsafe {
        embedded_alloc::init!(HEAP, HEAP_BYTES);
    }
    main();
    process::exit(0)
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    if harness::panic_is_expected() {
        process::exit(0);
    }
    println!("{info}");
    process::exit(PANICKED)
}

// `allow`: `expect` is not fulfilled inside what the attribute expands to.
#[allow(
    unsafe_code,
    reason = "cortex-m-rt requires the handler to be an unsafe fn"
)]
// SAFETY: only the core calls it, on a hard fault, with `frame` on the stack that it pushed the
// registers to. It may interrupt any code: it reads the frame, prints, and ends the emulator.
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    println!("hard fault at {:#010x}", frame.pc());
    process::exit(FAULTED)
}
