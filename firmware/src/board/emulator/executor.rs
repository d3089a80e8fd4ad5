//! The executor of the emulated board. Embassy's own waits with `WFE`, which this emulator takes for a hint to go on at once: an idle
//! board kept a core of the PC busy, and on a loaded PC was late. This one waits with `WFI`.

use core::ptr;

use cortex_m::{asm, interrupt, peripheral::NVIC};
use embassy_executor::{Spawner, raw};

use super::irq::Irq;

/// Runs the tasks in thread mode, as embassy's executor of the same name.
pub struct Executor(raw::Executor);

impl Executor {
    /// A task that is woken pends [`Irq::Woken`].
    pub fn new() -> Self {
        let context = usize::from(Irq::Woken as u16);
        Self(raw::Executor::new(ptr::without_provenance_mut(context)))
    }

    /// Spawns tasks and runs them for ever.
    #[expect(
        unsafe_code,
        reason = "tasks are polled, and interrupts masked by hand"
    )]
    pub fn run(&'static mut self, init: impl FnOnce(Spawner)) -> ! {
        let executor = &self.0;
        init(executor.spawner());
        loop {
            NVIC::unpend(Irq::Woken);
            // SAFETY: nothing else polls this executor, and no task calls `run`.
            unsafe { executor.poll() };
            // Masked, so that no interrupt wakes a task between the look and the wait, which ends with a masked interrupt too.
            interrupt::disable();
            if !NVIC::is_pending(Irq::Woken) {
                asm::wfi();
            }
            // SAFETY: they were enabled before: no critical section surrounds this loop.
            unsafe { interrupt::enable() };
        }
    }
}
