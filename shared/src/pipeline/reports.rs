//! What a call of the pipeline gives.

use crate::uart_line::Report;

/// Reports of one input, in order: at most a change of state and a label.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Reports([Option<Report>; 2]);

impl Reports {
    pub(super) fn push(&mut self, report: Report) {
        // Two suffice: silence empties the window, so no label follows it, and a label causes at most one
        // change of state.
        if let Some(free) = self.0.iter_mut().find(|slot| slot.is_none()) {
            *free = Some(report);
        }
    }
}

impl IntoIterator for Reports {
    type Item = Report;
    type IntoIter = core::iter::Flatten<core::array::IntoIter<Option<Report>, 2>>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter().flatten()
    }
}
