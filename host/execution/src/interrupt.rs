//! Ctrl-C: the first one stops a run, which can be resumed; the second one ends the program at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::progress;

/// A request of the user to stop, shared by all clones.
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Installs a handler for Ctrl-C and termination signals.
    pub fn listen() -> Self {
        let interrupt = Self::default();
        let requested = interrupt.0.clone();
        // Without a handler Ctrl-C ends the program at once; checkpoints are complete all the same.
        let _ = ctrlc::set_handler(move || {
            if requested.swap(true, Ordering::SeqCst) {
                std::process::exit(130);
            }
            progress::log("stopping; press Ctrl-C again to stop at once");
        });
        interrupt
    }

    /// An interrupt whose stop is requested already.
    #[cfg(any(test, feature = "testing"))]
    pub fn at_once() -> Self {
        Self(Arc::new(AtomicBool::new(true)))
    }

    /// Requests a stop.
    #[cfg(any(test, feature = "testing"))]
    pub fn request(&self) {
        self.0.store(true, Ordering::SeqCst);
    }

    /// Whether a stop was requested.
    pub fn requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Makes a write beyond the limit on the size of files an error, in this thread and its children: without this, the
/// signal of the limit ends the program in the middle of a session.
pub fn outlive_file_limit() {
    #[cfg(unix)]
    {
        use nix::sys::signal::{SigSet, Signal};
        let mut signals = SigSet::empty();
        signals.add(Signal::SIGXFSZ);
        // A system that refuses ends the program as before.
        let _ = signals.thread_block();
    }
}
