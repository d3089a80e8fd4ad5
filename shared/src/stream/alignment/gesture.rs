//! Finds gestures in a stream: stretches of activity between rest, by the envelope alone.

use crate::units::{CHANNELS, PATCH, Patch};

/// Patches of the average that decides what is active: 200 ms.
const SHORT: usize = 4;
/// Patches of the average that decides what is rest: 0.5 s.
const LONG: usize = 10;
/// Fewest active patches of a gesture: 0.4 s. Less is a twitch.
const FEWEST: u32 = 8;
/// Most patches of a gesture that are used: 3 s.
const MOST: u32 = 60;
/// Lowest level of rest, the sum of a patch: one count. An armband without contact must not make noise a gesture.
const LOWEST_REST: u32 = (PATCH * CHANNELS) as u32;

/// Watches for gestures.
///
/// Rest is the quietest half second so far. A gesture begins where the average over 200 ms is 1.75 times rest, and ends
/// where it is below 1.4 times rest. Two of 64 people open the hand so weakly that nothing is found.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct GestureDetector {
    /// Sums of the newest patches over samples and electrodes, at most 10 240 each; a ring.
    recent: [u32; LONG],
    /// Patches so far.
    count: usize,
    /// The quietest half second so far, as ten patches' sum.
    rest: u32,
    burst: Option<Burst>,
    /// Bits of the newest 64 patches that were active in a gesture, the newest in the lowest bit.
    active: u64,
}

#[derive(Clone, PartialEq, Eq, Debug, Default)]
struct Burst {
    gesture: Gesture,
    /// The gesture was given already; its end is waited for.
    given: bool,
}

/// Activity of each electrode in a gesture.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(super) struct Gesture {
    /// Sums of |x| over the active patches: at most 60 x 10 x 128.
    sums: [u32; CHANNELS],
    /// Active patches.
    patches: u32,
}

impl Gesture {
    /// Mean |x| of each electrode, in 1/`unit` counts.
    pub(super) fn means(&self, unit: u32) -> [u32; CHANNELS] {
        let samples = (self.patches * PATCH as u32).max(1);
        self.sums.map(|sum| sum * unit / samples)
    }
}

impl GestureDetector {
    /// A detector before the first patch.
    pub(super) const fn new() -> Self {
        Self {
            recent: [0; LONG],
            count: 0,
            rest: u32::MAX,
            burst: None,
            active: 0,
        }
    }

    /// Bits of the newest 64 patches that were active in a gesture, the newest in the lowest bit.
    pub(super) const fn active(&self) -> u64 {
        self.active
    }

    /// Takes the next patch; returns a gesture when it has ended, or has lasted 3 s.
    pub(super) fn push(&mut self, patch: &Patch) -> Option<Gesture> {
        let electrodes = sums(patch);
        let newest: u32 = electrodes.iter().sum();
        self.recent[self.count % LONG] = newest;
        self.count += 1;
        self.active <<= 1;
        if self.count < LONG {
            return None;
        }
        let long = self.recent.iter().sum::<u32>();
        self.rest = self.rest.min(long.max(LOWEST_REST * LONG as u32));
        let short: u32 = (1..=SHORT)
            .map(|back| self.recent[(self.count - back) % LONG])
            .sum();
        // Averages of a patch are short / 4 and rest / 10; 1.75 is 7 / 4, 1.4 is 7 / 5.
        let above = |sum: u32, patches: u32| sum * LONG as u32 * 4 >= self.rest * patches * 7;
        let begins = above(short, SHORT as u32);
        let ends = short * LONG as u32 * 5 < self.rest * SHORT as u32 * 7;
        let is_active = above(newest, 1);
        let Some(burst) = &mut self.burst else {
            if begins {
                let mut burst = Burst::default();
                self.active |= u64::from(burst.add(&electrodes, is_active));
                self.burst = Some(burst);
            }
            return None;
        };
        self.active |= u64::from(burst.add(&electrodes, is_active));
        let is_long = burst.gesture.patches >= MOST;
        if ends {
            let burst = self.burst.take()?;
            return (!burst.given && burst.gesture.patches >= FEWEST).then_some(burst.gesture);
        }
        if is_long && !burst.given {
            burst.given = true;
            return Some(burst.gesture.clone());
        }
        None
    }
}

impl Burst {
    /// Adds a patch if it counts; returns whether it does.
    fn add(&mut self, electrodes: &[u32; CHANNELS], is_active: bool) -> bool {
        if !is_active || self.gesture.patches >= MOST {
            return false;
        }
        for (sum, more) in self.gesture.sums.iter_mut().zip(electrodes) {
            *sum += more;
        }
        self.gesture.patches += 1;
        true
    }
}

/// Sums over the samples of a patch.
fn sums(patch: &Patch) -> [u32; CHANNELS] {
    let mut sums = [0; CHANNELS];
    for sample in patch {
        for (sum, &value) in sums.iter_mut().zip(sample) {
            *sum += u32::from(value);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    /// Patches of these levels: counts on every electrode, twice as many on the first.
    fn gestures(levels: &[(u8, usize)]) -> Vec<Gesture> {
        let mut detector = GestureDetector::new();
        let levels = levels
            .iter()
            .flat_map(|&(level, patches)| (0..patches).map(move |_| level));
        levels
            .filter_map(|level| {
                let mut sample = [level; CHANNELS];
                sample[0] *= 2;
                detector.push(&[sample; PATCH])
            })
            .collect()
    }

    #[test]
    fn activity_between_rest_is_a_gesture_with_its_means() {
        let found = gestures(&[(3, 20), (30, 30), (3, 20), (20, 30), (3, 10)]);
        let means: Vec<_> = found.iter().map(|gesture| gesture.means(1)).collect();
        let [strong, weak] = [30, 20].map(|level| [2, 1, 1, 1, 1, 1, 1, 1].map(|k| k * level));
        assert_eq!(means, [strong, weak]);
        assert_eq!(found[0].means(64)[1], 30 * 64);
    }

    #[test]
    fn the_active_patches_of_gestures_are_marked_newest_first() {
        let mut detector = GestureDetector::new();
        for (level, patches) in [(3, 12), (30, 9), (3, 6), (30, 10), (3, 4)] {
            for _ in 0..patches {
                detector.push(&[[level; CHANNELS]; PATCH]);
            }
        }
        // The average over 200 ms is above 1.75 times rest with the first active patch.
        assert_eq!(detector.active(), (0x1FF << 20) | (0x3FF << 4));
    }

    #[test]
    fn twitches_weak_activity_and_rest_are_none() {
        assert_eq!(gestures(&[(3, 20), (30, 5), (3, 20)]), []);
        assert_eq!(gestures(&[(10, 20), (16, 40), (10, 20)]), []);
        assert_eq!(gestures(&[(0, 20), (1, 40), (0, 40)]), []);
        assert_eq!(gestures(&[(30, 200)]), []);
    }

    #[test]
    fn a_long_gesture_is_given_once_after_three_seconds() {
        assert_eq!(gestures(&[(3, 20), (30, 55)]).len(), 0);
        let long = [(3, 20), (30, 300), (3, 20), (30, 20), (3, 20)];
        assert_eq!(gestures(&long[..3]).len(), 1);
        assert_eq!(gestures(&long).len(), 2);
    }

    #[test]
    fn who_begins_with_a_gesture_is_understood_after_the_first_rest() {
        assert_eq!(gestures(&[(30, 40), (3, 20), (30, 20), (3, 20)]).len(), 1);
    }
}
