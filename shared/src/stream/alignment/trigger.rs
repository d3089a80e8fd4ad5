//! When an alignment begins: at a button, or by itself at the first full window of a connection.

use crate::units::Millis;

/// Milliseconds that a button has to be down to count as pressed, and up to count as released. Contacts of push buttons
/// bounce for less than 10 ms; one look may hit a bounce, two that are 30 ms apart with no other between do not.
pub const DEBOUNCE_MS: u32 = 30;

/// Decides when to call `Pipeline::begin_alignment`.
///
/// No clock and no pin: the caller looks at the button, as often as it likes, and passes what it saw.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Trigger {
    button: Button,
    /// Whether an alignment begins by itself.
    automatic: bool,
    /// No alignment has begun since the armband was connected.
    is_due: bool,
}

impl Trigger {
    /// Before the first connection. With `automatic`, each connection's first full window begins an alignment.
    #[must_use]
    pub const fn new(automatic: bool) -> Self {
        Self {
            button: Button::Up,
            automatic,
            is_due: true,
        }
    }

    /// The armband was disconnected: the next stream is another connection's.
    pub const fn disconnected(&mut self) {
        self.is_due = true;
    }

    /// Whether an alignment begins now. `is_down` is what the button looks like, `is_full` whether the window is.
    ///
    /// Holding the button down begins one alignment, not several.
    pub const fn begins(&mut self, now: Millis, is_down: bool, is_full: bool) -> bool {
        let is_pressed = self.button.look(now, is_down);
        let begins = is_pressed || self.automatic && self.is_due && is_full;
        if begins {
            self.is_due = false;
        }
        begins
    }
}

/// A button, debounced.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Button {
    Up,
    /// Down since then.
    GoingDown(Millis),
    Down,
    /// Up since then.
    GoingUp(Millis),
}

impl Button {
    /// Takes what the contact looks like; whether the button is pressed by it.
    const fn look(&mut self, now: Millis, is_down: bool) -> bool {
        let before = *self;
        *self = match (before, is_down) {
            (Self::Up, true) => Self::GoingDown(now),
            (Self::Down, false) => Self::GoingUp(now),
            (Self::GoingDown(_), false) => Self::Up,
            (Self::GoingUp(_), true) => Self::Down,
            (Self::GoingDown(since), true) if now.elapsed_since(since) >= DEBOUNCE_MS => Self::Down,
            (Self::GoingUp(since), false) if now.elapsed_since(since) >= DEBOUNCE_MS => Self::Up,
            _ => before,
        };
        matches!((before, *self), (Self::GoingDown(_), Self::Down))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    /// Looks at a contact every 10 ms; gives the milliseconds at which an alignment begins.
    fn begins(trigger: &mut Trigger, from: u32, contact: &str) -> Vec<u32> {
        let looks = (from..).step_by(10).zip(contact.chars());
        let begun =
            looks.filter(|&(ms, contact)| trigger.begins(Millis(ms), contact == 'x', false));
        begun.map(|(ms, _)| ms).collect()
    }

    #[test]
    fn a_press_of_30_ms_begins_one_alignment_however_long_it_lasts() {
        let mut trigger = Trigger::new(false);
        assert_eq!(begins(&mut trigger, 0, "..xxx...."), []);
        assert_eq!(begins(&mut trigger, 100, "..xxxx...."), [150]);
        assert_eq!(begins(&mut trigger, 200, "xxxxxxxxxxxxxxxxxxxxxx"), [230]);
    }

    #[test]
    fn a_contact_that_bounces_begins_one_alignment() {
        let mut trigger = Trigger::new(false);
        assert_eq!(
            begins(&mut trigger, 0, "x.x.xxxx.xxx..xx....x.xxxx"),
            [70, 250]
        );
    }

    #[test]
    fn looks_that_come_all_at_once_are_one_look() {
        let mut trigger = Trigger::new(false);
        for _ in 0..100 {
            assert!(!trigger.begins(Millis(7), true, false));
        }
        assert!(trigger.begins(Millis(37), true, false));
    }

    #[test]
    fn the_first_full_window_of_each_connection_begins_one_where_that_is_wanted() {
        for automatic in [false, true] {
            let mut trigger = Trigger::new(automatic);
            let full = |trigger: &mut Trigger, is_full| trigger.begins(Millis(0), false, is_full);
            assert!(!full(&mut trigger, false));
            assert_eq!(full(&mut trigger, true), automatic);
            // After a gap the window is full again.
            assert!(!full(&mut trigger, false));
            assert!(!full(&mut trigger, true));
            trigger.disconnected();
            assert!(!full(&mut trigger, false));
            assert_eq!(full(&mut trigger, true), automatic);
        }
    }

    #[test]
    fn after_a_press_no_alignment_begins_by_itself() {
        let mut trigger = Trigger::new(true);
        assert_eq!(begins(&mut trigger, 0, "xxxx..."), [30]);
        assert!(!trigger.begins(Millis(3000), false, true));
    }

    #[test]
    fn the_clock_may_wrap_while_the_button_is_down() {
        let mut trigger = Trigger::new(false);
        assert!(!trigger.begins(Millis(u32::MAX - 10), true, false));
        assert!(!trigger.begins(Millis(18), true, false));
        assert!(trigger.begins(Millis(19), true, false));
    }
}
