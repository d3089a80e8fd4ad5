//! Where a stream comes from: a recording in real time, a board, or an armband. Each runs on a thread of its own until it is stopped.

#[cfg(any(feature = "bluetooth", test))]
pub(crate) mod bluetooth;
pub(crate) mod board;
mod dialogue;
mod recorded;
mod scored;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::Receiver;

use shared::intent::Intent;

pub(crate) use self::recorded::{Played, Recorded};
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

/// What a simulated person is asked for; shared by all clones.
#[derive(Clone, Debug, Default)]
pub(crate) struct Asked(Arc<AtomicUsize>);

impl Asked {
    pub(crate) fn set(&self, intent: Intent) {
        self.0.store(intent.class(), Ordering::Relaxed);
    }

    pub(crate) fn get(&self) -> Intent {
        Intent::from_class(self.0.load(Ordering::Relaxed)).unwrap_or(Intent::Relax)
    }
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
