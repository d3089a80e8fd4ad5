//! Start of an alignment: on request, or automatically at the first full window of a connection.

/// Decides when to call `Pipeline::begin_alignment`.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Trigger {
    /// Whether an alignment begins by itself.
    automatic: bool,
    /// Whether no alignment has begun since the armband was connected.
    is_due: bool,
}

impl Trigger {
    /// A trigger before the first connection. With `automatic`, each connection's first full window begins an alignment.
    #[must_use]
    pub const fn new(automatic: bool) -> Self {
        Self {
            automatic,
            is_due: true,
        }
    }

    /// The armband was disconnected: the next stream is another connection's.
    pub const fn disconnected(&mut self) {
        self.is_due = true;
    }

    /// An alignment was begun, ended or set on request.
    pub const fn requested(&mut self) {
        self.is_due = false;
    }

    /// Whether an alignment begins by itself now. `is_full` is whether the window is.
    pub const fn begins(&mut self, is_full: bool) -> bool {
        let begins = self.automatic && self.is_due && is_full;
        if begins {
            self.is_due = false;
        }
        begins
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_full_window_of_each_connection_begins_one_where_that_is_wanted() {
        for automatic in [false, true] {
            let mut trigger = Trigger::new(automatic);
            assert!(!trigger.begins(false));
            assert_eq!(trigger.begins(true), automatic);
            // After a gap the window is full again.
            assert!(!trigger.begins(false));
            assert!(!trigger.begins(true));
            trigger.disconnected();
            assert!(!trigger.begins(false));
            assert_eq!(trigger.begins(true), automatic);
        }
    }

    #[test]
    fn after_a_request_no_alignment_begins_by_itself() {
        let mut trigger = Trigger::new(true);
        trigger.requested();
        assert!(!trigger.begins(true));
    }
}
