//! Lost notifications, bridged as the device bridges them: how much loss a model bears.

use rand::RngExt as _;
use shared::units::Sample;

use crate::seed::generator;

/// Samples of a notification.
const NOTIFICATION: usize = 2;
/// Maximum number of consecutive notifications that the device bridges; one more resets its window.
const MOST_IN_A_ROW: u32 = 2;
/// Maximum loss in percent: two of every three notifications, since three in a row are never lost.
pub const MOST_PERCENT: u8 = 66;

/// Replaces `percent` of the notifications by the last sample before each, as the device does.
///
/// They are lost at random, at most two in a row: a third one would reset the device's window. The same
/// name gives the same losses. The first notification is never lost.
///
/// # Panics
/// If `percent` is above [`MOST_PERCENT`].
pub fn bridge_lost_notifications(samples: &mut [Sample], percent: u8, name: &str) {
    assert!(percent <= MOST_PERCENT, "{percent} % lost");
    let chance = chance_after_a_received_one(percent);
    let mut random = generator(0, name);
    let mut in_a_row = MOST_IN_A_ROW;
    let mut last = Sample::default();
    for notification in samples.chunks_mut(NOTIFICATION) {
        if in_a_row < MOST_IN_A_ROW && random.random_bool(chance) {
            in_a_row += 1;
            notification.fill(last);
        } else {
            in_a_row = 0;
            last = notification.last().copied().unwrap_or(last);
        }
    }
}

/// Probability `q` that a notification is lost unless two before it were.
///
/// After a received notification, one is lost with probability `q` and a second one with `q^2`, so the share of losses
/// is `(q + q^2) / (1 + q + q^2)`. This is solved for `q`.
fn chance_after_a_received_one(percent: u8) -> f64 {
    let share = f64::from(percent) / 100.0;
    let lost_of_a_received_one = share / (1.0 - share);
    ((1.0 + 4.0 * lost_of_a_received_one).sqrt() - 1.0) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbered(count: usize) -> Vec<Sample> {
        (0..count).map(|n| [(n % 127) as i8; 8]).collect()
    }

    /// Flags of the notifications that were replaced. No notification repeats the one before it by itself.
    fn lost(percent: u8, name: &str) -> Vec<bool> {
        let mut samples = numbered(40_000);
        bridge_lost_notifications(&mut samples, percent, name);
        let mut last = None;
        samples
            .chunks(NOTIFICATION)
            .zip(numbered(40_000).chunks(NOTIFICATION))
            .map(|(found, sent)| {
                let lost = found != sent;
                if lost {
                    assert_eq!(found, [last.unwrap(); 2], "the last sample is repeated");
                } else {
                    last = sent.last().copied();
                }
                lost
            })
            .collect()
    }

    #[test]
    fn the_share_that_is_asked_for_is_lost_and_never_three_in_a_row() {
        for percent in [0, 1, 2, 5, 10, 20, 50, MOST_PERCENT] {
            let lost = lost(percent, "a");
            let share = lost.iter().filter(|lost| **lost).count() as f64 / lost.len() as f64;
            assert!((share - f64::from(percent) / 100.0).abs() < 0.01, "{share}");
            assert!(!lost.windows(3).any(|three| three == [true; 3]));
            assert!(percent <= 1 || lost.windows(2).any(|two| two == [true; 2]));
        }
    }

    #[test]
    fn a_name_has_its_losses() {
        assert_eq!(lost(20, "a"), lost(20, "a"));
        assert_ne!(lost(20, "a"), lost(20, "b"));
    }
}
