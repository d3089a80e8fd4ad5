//! Lead of a recording session: one viewer has it, all others watch.

use std::sync::{Mutex, PoisonError};

/// Number of a viewer.
pub(crate) type ViewerId = u64;

/// Viewer who leads: the first to send a request to the session, until it leaves the page.
#[derive(Debug, Default)]
pub(crate) struct Lead(Mutex<Option<ViewerId>>);

impl Lead {
    /// Claims the lead. Returns whether the viewer leads, and whether that is new.
    pub(crate) fn claim(&self, viewer: ViewerId) -> (bool, bool) {
        let mut lead = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_new = lead.is_none();
        (*lead.get_or_insert(viewer) == viewer, is_new)
    }

    /// Releases the lead of a viewer that has left. Returns whether it led.
    pub(crate) fn release(&self, viewer: ViewerId) -> bool {
        let mut lead = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let led = *lead == Some(viewer);
        if led {
            *lead = None;
        }
        led
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_leads_until_it_leaves() {
        let lead = Lead::default();
        assert_eq!(lead.claim(1), (true, true));
        assert_eq!(lead.claim(2), (false, false));
        assert_eq!(lead.claim(1), (true, false));
        assert!(!lead.release(2) && lead.release(1));
        assert_eq!(lead.claim(2), (true, true));
    }
}
