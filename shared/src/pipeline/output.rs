//! Output of a pipeline: its newest label, whether it is shown, and the lines about it.

use crate::intent::Intent;
use crate::stream::lock::Lock;
use crate::stream::safe_state::{Cause, SafeState};
use crate::units::SampleIndex;

/// State of the outputs.
#[derive(Debug)]
pub(super) struct Output {
    pub(super) safe_state: SafeState,
    /// The newest label; `None` since a reset of the window.
    label: Option<(SampleIndex, Intent)>,
    /// Lock of the labels; `None` if they are not locked.
    pub(super) lock: Option<Lock>,
    /// Number of the next line.
    pub(super) sequence: u32,
}

impl Output {
    /// The safe state after a reset with this cause.
    pub(super) const fn new(start: Cause) -> Self {
        Self {
            safe_state: SafeState::new(start),
            label: None,
            lock: None,
            sequence: 0,
        }
    }

    /// Takes a label that contradicts none before; returns the label to be shown, `None` while labels are locked.
    pub(super) fn show(&mut self, instant: SampleIndex, intent: Intent) -> Option<Intent> {
        self.label = Some((instant, intent));
        match &mut self.lock {
            Some(lock) => lock.push(instant, intent),
            None => Some(intent),
        }
    }

    /// Whether an instant has another label, or is before one that has a label. Happens where samples are taken again after
    /// an early label: that label stands, and what the samples say now counts from the next instant on.
    pub(super) fn contradicts(&self, instant: SampleIndex, intent: Intent) -> bool {
        self.label
            .is_some_and(|(labelled, before)| match labelled.since(instant) {
                0 => intent != before,
                later => later < 1 << 31,
            })
    }

    /// Forgets the label, and locks labels again.
    pub(super) const fn reset(&mut self) {
        self.label = None;
        self.hold_lock(true);
    }

    pub(super) const fn hold_lock(&mut self, is_locked: bool) {
        match &mut self.lock {
            Some(lock) if is_locked => lock.lock(),
            Some(lock) => lock.unlock(),
            None => {}
        }
    }

    /// Takes the number of the next line.
    pub(super) const fn next_sequence(&mut self) -> u32 {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        sequence
    }
}
