//! Ctrl-C: once, a run stops at its last complete checkpoint; twice, at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether the user requested to stop.
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Listens for Ctrl-C and termination from now on.
    #[must_use]
    pub fn listen() -> Self {
        let interrupt = Self::default();
        let requested = interrupt.0.clone();
        // Without the handler Ctrl-C simply ends the program, and checkpoints are whole anyway.
        let _ = ctrlc::set_handler(move || {
            if requested.swap(true, Ordering::SeqCst) {
                std::process::exit(130);
            }
            eprintln!("stopping; press Ctrl-C again to stop at once");
        });
        interrupt
    }

    /// Whether to stop.
    #[must_use]
    pub fn requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
