//! A push button, debounced: pressed, pressed twice, and held.

use crate::units::Millis;

/// Milliseconds that a button has to be down to count as pressed, and up to count as released. Contacts of push buttons
/// bounce for less than 10 ms; one look may hit a bounce, two that are 30 ms apart with no other between do not.
pub const DEBOUNCE_MS: u32 = 30;

/// Milliseconds that a button has to be down to count as held. A press is shorter.
pub const HELD_MS: u32 = 3000;

/// Most milliseconds from the beginning of a press to that of the next one which together are a double press.
pub const TWICE_MS: u32 = 600;

/// Action on a button.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Press {
    /// The button went down.
    Pressed,
    /// The button went down again within [`TWICE_MS`] after `Pressed`; in place of a second one.
    Twice,
    /// The button has been down for [`HELD_MS`]; follows either, once.
    Held,
}

/// Decides what the levels of a button's pin mean.
///
/// No clock and no pin: the caller looks at the button, as often as it likes, and passes what it saw.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Button {
    contact: Contact,
    /// Whether this press was reported as held.
    was_held: bool,
    /// Time of a press that another one may follow.
    single: Option<Millis>,
}

/// A contact, debounced.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
enum Contact {
    #[default]
    Up,
    /// Down since then.
    GoingDown(Millis),
    /// Down since then.
    Down(Millis),
    /// The button is up since the second time, after it was down since the first.
    GoingUp(Millis, Millis),
}

impl Button {
    /// Takes what the contact looks like.
    pub const fn look(&mut self, now: Millis, is_down: bool) -> Option<Press> {
        let before = self.contact;
        self.contact = match (before, is_down) {
            (Contact::Up, true) => Contact::GoingDown(now),
            (Contact::Down(down), false) => Contact::GoingUp(down, now),
            (Contact::GoingDown(_), false) => Contact::Up,
            (Contact::GoingUp(down, _), true) => Contact::Down(down),
            (Contact::GoingDown(since), true) if now.elapsed_since(since) >= DEBOUNCE_MS => {
                self.was_held = false;
                Contact::Down(since)
            }
            (Contact::GoingUp(_, since), false) if now.elapsed_since(since) >= DEBOUNCE_MS => {
                Contact::Up
            }
            _ => before,
        };
        match (before, self.contact) {
            (Contact::GoingDown(_), Contact::Down(since)) => Some(match self.single.take() {
                Some(single) if since.elapsed_since(single) <= TWICE_MS => Press::Twice,
                _ => {
                    self.single = Some(since);
                    Press::Pressed
                }
            }),
            (Contact::Down(_), Contact::Down(since))
                if !self.was_held && now.elapsed_since(since) >= HELD_MS =>
            {
                self.was_held = true;
                Some(Press::Held)
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::{string::String, vec::Vec};

    /// Looks at a contact every 10 ms; returns the milliseconds at which something happened.
    fn presses(button: &mut Button, from: u32, contact: &str) -> Vec<(u32, Press)> {
        let looks = (from..).step_by(10).zip(contact.chars());
        let pressed =
            looks.filter_map(|(ms, contact)| Some((ms, button.look(Millis(ms), contact == 'x')?)));
        pressed.collect()
    }

    #[test]
    fn a_press_of_30_ms_counts_once_however_long_it_lasts() {
        let mut button = Button::default();
        assert_eq!(presses(&mut button, 0, "..xxx...."), []);
        let pressed = presses(&mut button, 100, "..xxxx....");
        assert_eq!(pressed, [(150, Press::Pressed)]);
        let pressed = presses(&mut button, 1000, "xxxxxxxxxxxxxxxxxxxxxx");
        assert_eq!(pressed, [(1030, Press::Pressed)]);
    }

    #[test]
    fn a_contact_that_bounces_counts_once() {
        let mut button = Button::default();
        assert_eq!(
            presses(&mut button, 0, "x.x.xxxx.xxx..xx....x.xxxx"),
            [(70, Press::Pressed), (250, Press::Twice)]
        );
    }

    #[test]
    fn two_presses_within_600_ms_are_a_double_press_and_a_third_one_is_single() {
        let down_at = |starts: [usize; 3]| {
            let is_down = |look| {
                starts
                    .iter()
                    .any(|start| (*start..start + 10).contains(&look))
            };
            let contact: String = (0..300)
                .map(|look| if is_down(look) { 'x' } else { '.' })
                .collect();
            presses(&mut Button::default(), 0, &contact)
                .into_iter()
                .map(|(_, press)| press)
                .collect::<Vec<_>>()
        };
        use Press::{Pressed, Twice};
        assert_eq!(down_at([0, 60, 120]), [Pressed, Twice, Pressed]);
        assert_eq!(down_at([0, 61, 121]), [Pressed, Pressed, Twice]);
        assert_eq!(down_at([0, 61, 122]), [Pressed; 3]);
    }

    #[test]
    fn a_button_that_is_down_for_three_seconds_is_held_once() {
        let mut button = Button::default();
        // A bounce in the middle of it changes nothing.
        let held: String = (0..700)
            .map(|look| if look == 150 { '.' } else { 'x' })
            .collect();
        let expected = [(30, Press::Pressed), (3000, Press::Held)];
        assert_eq!(presses(&mut button, 0, &held), expected);
        assert_eq!(presses(&mut button, 7000, "......"), []);
        let short = "x".repeat(299) + "......";
        let expected = [(8030, Press::Pressed)];
        assert_eq!(presses(&mut button, 8000, &short), expected);
        let expected = [(20_030, Press::Pressed), (23_000, Press::Held)];
        assert_eq!(presses(&mut button, 20_000, &held), expected);
    }

    #[test]
    fn looks_that_come_all_at_once_are_one_look() {
        let mut button = Button::default();
        for _ in 0..100 {
            assert_eq!(button.look(Millis(7), true), None);
        }
        assert_eq!(button.look(Millis(37), true), Some(Press::Pressed));
    }

    #[test]
    fn the_clock_may_wrap_while_the_button_is_down() {
        let mut button = Button::default();
        assert_eq!(button.look(Millis(u32::MAX - 10), true), None);
        assert_eq!(button.look(Millis(18), true), None);
        assert_eq!(button.look(Millis(19), true), Some(Press::Pressed));
        assert_eq!(button.look(Millis(2988), true), None);
        assert_eq!(button.look(Millis(2989), true), Some(Press::Held));
    }
}
