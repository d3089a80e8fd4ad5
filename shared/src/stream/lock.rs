//! Lock of the labels: no label is shown until a deliberate sign, nor after a long rest.
//!
//! The sign is an open hand that is held: in daily life the label `open` is rare, and lasts for seconds more rarely still
//! (docs/decisions.md). The label of the sign itself is shown as relax, so that the hand does not follow it.

use crate::intent::Intent;
use crate::units::{SAMPLE_RATE_HZ, SampleIndex};

/// Times of a lock, in samples.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct LockTimes {
    /// Samples that the label `open` lasts to be the sign.
    pub sign: u32,
    /// Samples of the label `relax` after which labels are locked again.
    pub rest: u32,
}

impl LockTimes {
    /// A sign of 1.5 s, a rest of 10 s.
    pub const USUAL: Self = Self {
        sign: 3 * SAMPLE_RATE_HZ / 2,
        rest: 10 * SAMPLE_RATE_HZ,
    };
    /// Least and most samples of a sign: 0.5 to 10 s.
    const SIGN: core::ops::RangeInclusive<u32> = SAMPLE_RATE_HZ / 2..=10 * SAMPLE_RATE_HZ;
    /// Least and most samples of a rest: 1 s to 10 min.
    const REST: core::ops::RangeInclusive<u32> = SAMPLE_RATE_HZ..=600 * SAMPLE_RATE_HZ;

    /// Returns true if both times are ones that a lock can have.
    #[must_use]
    pub fn are_allowed(self) -> bool {
        Self::SIGN.contains(&self.sign) && Self::REST.contains(&self.rest)
    }
}

/// State between labels.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum LockState {
    Locked,
    /// The sign was given, and the hand is still open.
    Signed,
    Unlocked,
}

/// Decides which labels are shown.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Lock {
    times: LockTimes,
    state: LockState,
    /// The newest label, and the instant from which on it is the same; none since the lock began or changed by command.
    run: Option<(Intent, SampleIndex)>,
}

impl Lock {
    /// A lock that is locked.
    #[must_use]
    pub const fn new(times: LockTimes) -> Self {
        Self {
            times,
            state: LockState::Locked,
            run: None,
        }
    }

    /// Times of the lock.
    #[must_use]
    pub const fn times(&self) -> LockTimes {
        self.times
    }

    /// Returns true while no label is shown.
    #[must_use]
    pub const fn is_locked(&self) -> bool {
        matches!(self.state, LockState::Locked)
    }

    /// Takes a label, and returns the shown one; `None` while locked. Instants do not run backwards.
    pub fn push(&mut self, instant: SampleIndex, intent: Intent) -> Option<Intent> {
        let start = match self.run {
            Some((same, start)) if same == intent => start,
            _ => instant,
        };
        self.run = Some((intent, start));
        let lasted = instant.since(start);
        self.state = match (self.state, intent) {
            (LockState::Locked, Intent::Open) if lasted >= self.times.sign => LockState::Signed,
            (LockState::Signed, intent) if intent != Intent::Open => LockState::Unlocked,
            (LockState::Unlocked, Intent::Relax) if lasted >= self.times.rest => LockState::Locked,
            (state, _) => state,
        };
        match self.state {
            LockState::Locked => None,
            LockState::Signed => Some(Intent::Relax),
            LockState::Unlocked => Some(intent),
        }
    }

    /// Locks: whatever was seen of a sign is forgotten.
    pub const fn lock(&mut self) {
        self.state = LockState::Locked;
        self.run = None;
    }

    /// Unlocks, without a sign. A rest counts from the next label on.
    pub const fn unlock(&mut self) {
        self.state = LockState::Unlocked;
        self.run = None;
    }
}

#[cfg(test)]
mod tests {
    use alloc::vec::Vec;
    use proptest::prelude::*;

    use super::*;

    const TIMES: LockTimes = LockTimes {
        sign: 500,
        rest: 2000,
    };
    /// Samples between two labels: the hold.
    const STEP: u32 = 20;

    /// Labels that are shown of ones that last for some samples each, from an instant on.
    fn shown(lock: &mut Lock, from: u32, labels: &[(Intent, u32)]) -> Vec<Option<Intent>> {
        let all = labels
            .iter()
            .flat_map(|&(intent, samples)| (0..samples / STEP).map(move |_| intent));
        let instants = (0..).map(|at| SampleIndex(from.wrapping_add(at * STEP)));
        instants
            .zip(all)
            .map(|(instant, intent)| lock.push(instant, intent))
            .collect()
    }

    #[test]
    fn an_open_hand_that_is_held_unlocks_and_is_itself_shown_as_relax() {
        let mut lock = Lock::new(TIMES);
        // The second wraps in between.
        for from in [0, u32::MAX - 1000] {
            lock.lock();
            let labels = [
                (Intent::Close, 1000),
                (Intent::Open, 480),
                (Intent::Relax, 500),
                (Intent::Open, 700),
                (Intent::Close, 200),
                (Intent::Open, 1000),
            ];
            let shown = shown(&mut lock, from, &labels);
            let first = shown.iter().position(Option::is_some);
            assert_eq!(first, Some((1000 + 480 + 500 + 500) / 20));
            let shown: Vec<Intent> = shown.into_iter().flatten().collect();
            assert!(shown[..10].iter().all(|own| *own == Intent::Relax));
            assert!(shown[10..20].iter().all(|own| *own == Intent::Close));
            assert!(shown[20..].iter().all(|own| *own == Intent::Open));
        }
    }

    #[test]
    fn rest_locks_again_and_shorter_rests_do_not() {
        let mut lock = Lock::new(TIMES);
        lock.unlock();
        let labels = [
            (Intent::Relax, 1980),
            (Intent::Close, 20),
            (Intent::Relax, 2000),
            (Intent::Relax, 20),
            (Intent::Close, 3000),
        ];
        let shown = shown(&mut lock, 0, &labels);
        let unlocked = (1980 + 20 + 2000) / 20;
        assert!(shown[..unlocked].iter().all(Option::is_some));
        assert!(shown[unlocked..].iter().all(Option::is_none));
        assert!(lock.is_locked());
    }

    proptest! {
        /// Nothing but an open hand of the sign's length unlocks, and what is shown is a label or relax.
        #[test]
        fn nothing_is_shown_before_a_sign(labels in prop::collection::vec((0_usize..6, 1_u32..60), 1..60)) {
            let mut lock = Lock::new(TIMES);
            let labels: Vec<(Intent, u32)> = labels
                .into_iter()
                .filter_map(|(class, count)| Some((Intent::from_class(class)?, count * STEP)))
                .collect();
            let shown = shown(&mut lock, 0, &labels);
            let all: Vec<Intent> = labels
                .iter()
                .flat_map(|&(intent, samples)| (0..samples / STEP).map(move |_| intent))
                .collect();
            let (mut open, mut signed) = (0, false);
            for (at, intent) in all.iter().enumerate() {
                open = if *intent == Intent::Open { open + 1 } else { 0 };
                signed |= (open - 1) * STEP as i32 >= TIMES.sign as i32;
                prop_assert!(signed || shown[at].is_none());
                if let Some(shown) = shown[at] {
                    prop_assert!(shown == *intent || shown == Intent::Relax);
                }
            }
        }
    }
}
