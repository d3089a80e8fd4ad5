//! Where a stream comes from: a recording in real time, or a board. Each runs on a thread of its own until it is stopped.

pub(crate) mod board;
mod dialogue;
mod recorded;
mod scored;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;

pub(crate) use self::recorded::Recorded;
use super::hub::Hub;

/// What a viewer may ask of a source.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Request {
    /// Begin an alignment.
    Align,
    /// End the alignment in progress.
    CancelAlignment,
}

/// What a source works with.
#[derive(Debug)]
pub(crate) struct Context {
    pub(crate) hub: Arc<Hub>,
    pub(crate) requests: Receiver<Request>,
    pub(crate) stop: Stop,
}

/// Whether the program ends; shared by all clones.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stop(Arc<AtomicBool>);

impl Stop {
    pub(crate) fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    pub(crate) fn requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}
