//! From reset to a program's own `main`, and out again.

use core::panic::PanicInfo;

use alloc::{string::String, vec::Vec};
// For its critical section, which the allocator calls.
use cortex_m as _;
use cortex_m_rt::{ExceptionFrame, exception};
use embedded_alloc::LlffHeap;
use semihosting::{println, process};

use crate::harness;

/// Of the 16 MiB; the start-up code clears it, which takes time in every run.
const HEAP_BYTES: usize = 4 << 20;
/// Exit code of a panic, as `std` has it.
const PANICKED: i32 = 101;
const FAULTED: i32 = 102;

#[global_allocator]
static HEAP: LlffHeap = LlffHeap::empty();

/// Makes `fn()` the program.
#[macro_export]
macro_rules! entry {
    ($main:path) => {
        #[unsafe(export_name = "main")]
        extern "C" fn reset() -> ! {
            $crate::start($main)
        }
    };
}

/// Runs a program once and ends the emulator; for [`entry!`](crate::entry).
pub fn start(main: fn()) -> ! {
    #[expect(
        unsafe_code,
        reason = "the allocator cannot know that it is given memory once"
    )]
    // SAFETY: the first statement of the program, run once, before anything allocates.
    unsafe {
        embedded_alloc::init!(HEAP, HEAP_BYTES);
    }
    main();
    process::exit(0)
}

/// Words of the command line after the program's name.
pub type Arguments = Vec<String>;

/// What `-semihosting-config arg=...` handed over.
///
/// # Panics
/// On a command line above 1 KiB, or not of UTF-8.
#[must_use]
pub fn arguments() -> Arguments {
    let line = semihosting::experimental::env::args::<1024>().expect("a command line");
    line.skip(1)
        .map(|word| word.expect("UTF-8").into())
        .collect()
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    if harness::panic_is_expected() {
        process::exit(0);
    }
    println!("{info}");
    process::exit(PANICKED)
}

// `allow`, for `expect` does not see through what the attribute makes of the function.
#[allow(
    unsafe_code,
    reason = "the runtime asks for it: a fault may come anywhere"
)]
#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    println!("hard fault at {:#010x}", frame.pc());
    process::exit(FAULTED)
}
