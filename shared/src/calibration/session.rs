//! Course of a calibration on a device: what the wearer is asked for, patch by patch.
//!
//! ```text
//! round one, which teaches:   relax, open, relax, close, the other gestures in class order, other movement if wanted
//! round two, which judges:    the same without other movement; it teaches too if the learnt head is used
//! ```
//!
//! The opening of round one shows too how the armband sits.
//!
//! Neither clock nor heap: a patch is 50 ms. Patches without a full window are not passed.

use super::{Judgement, MOST_PATCHES, Shown};
use crate::intent::Intent;
use crate::stream::alignment::{COUNT, Profile};
use crate::units::{CHANNELS, Sample};

/// Patches of a cue that count for nothing: 1 s. Nobody follows a cue at once, and labels come up to 0.3 s late. The page of
/// `live` leaves out the same.
pub(crate) const REACTION: u32 = 20;
/// Patches of a hold that count: 3 s, the most that was measured (docs/calibration.md).
const HOLD: u32 = MOST_PATCHES as u32;
/// Patches of other movement that count: 6 s, as measured.
const OTHERS: u32 = 120;

/// A calibration in progress.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CalibrationSession {
    classes: usize,
    others: bool,
    is_judging: bool,
    /// Index of the cue in its round, and patches since it began.
    step: usize,
    patch: u32,
    /// Activity in all rest so far, and in this hold.
    rest: Activity,
    hold: Activity,
    judgement: Judgement,
}

/// Consequence of a patch.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CalibrationProgress {
    /// The cue goes on.
    Same,
    /// The next cue begins.
    Next,
    /// The next cue begins, after the opening of round one, which had this profile as received: the armband is aligned now.
    Opened(Profile),
    /// The next cue begins, the first of round two: the head is learnt now.
    Taught,
    /// Both rounds are over: the head is judged.
    Judged,
    /// The hold was not stronger than rest: the calibration is over.
    Weak,
}

impl CalibrationSession {
    /// A calibration before its first cue, for a model's number of classes; with other movement in round one if wanted.
    #[must_use]
    pub fn new(classes: usize, others: bool) -> Self {
        Self {
            classes,
            others,
            is_judging: false,
            step: 0,
            patch: 0,
            rest: Activity::default(),
            hold: Activity::default(),
            judgement: Judgement::default(),
        }
    }

    /// Cue of the wearer.
    #[must_use]
    pub fn cue(&self) -> Shown {
        let class = match self.step {
            0 | 2 => 0,
            1 => 1,
            step => step - 1,
        };
        let intent = Intent::from_class(class).filter(|_| class < self.classes);
        intent.map_or(Shown::Other, Shown::Intent)
    }

    /// Whether this is round two, in which two heads are compared.
    #[must_use]
    pub const fn is_judging(&self) -> bool {
        self.is_judging
    }

    /// Whether the patch that comes next counts.
    #[must_use]
    pub const fn counts(&self) -> bool {
        self.patch >= REACTION
    }

    /// Judgement so far.
    #[must_use]
    pub const fn judgement(&self) -> &Judgement {
        &self.judgement
    }

    /// Cues from this one on: each with its patches, and whether it is of round two.
    pub fn coming(&self) -> impl Iterator<Item = (Shown, u32, bool)> {
        let mut next = Some(self.clone());
        core::iter::from_fn(move || {
            let session = next.as_mut()?;
            let coming = (session.cue(), session.patches(), session.is_judging);
            if session.next_cue() == CalibrationProgress::Judged {
                next = None;
            }
            Some(coming)
        })
    }

    /// Takes a sample as received, for the activity of the hold.
    pub fn sample(&mut self, sample: Sample) {
        if self.counts() {
            self.hold.add(sample);
        }
    }

    /// Takes a patch, with the labels that both heads emit at its end.
    pub fn push(&mut self, labels: [Option<Intent>; 2]) -> CalibrationProgress {
        let cue = self.cue();
        if let (true, true, Shown::Intent(asked)) = (self.is_judging, self.counts(), cue) {
            self.judgement.add(asked, labels);
        }
        self.patch += 1;
        if self.patch < self.patches() {
            return CalibrationProgress::Same;
        }
        let hold = core::mem::take(&mut self.hold);
        if cue == Shown::Intent(Intent::Relax) {
            self.rest.join(&hold);
        } else if !hold.exceeds(&self.rest) {
            return CalibrationProgress::Weak;
        }
        match self.next_cue() {
            CalibrationProgress::Next if cue == Shown::Intent(Intent::Open) && !self.is_judging => {
                CalibrationProgress::Opened(hold.profile())
            }
            next => next,
        }
    }

    /// Patches of the cue.
    fn patches(&self) -> u32 {
        let counted = if self.cue() == Shown::Other {
            OTHERS
        } else {
            HOLD
        };
        REACTION + counted
    }

    fn next_cue(&mut self) -> CalibrationProgress {
        self.patch = 0;
        self.step += 1;
        // A round has a cue for each class, and a second rest.
        if self.step < self.classes + 1 + usize::from(self.others && !self.is_judging) {
            return CalibrationProgress::Next;
        }
        if self.is_judging {
            return CalibrationProgress::Judged;
        }
        self.is_judging = true;
        self.step = 0;
        CalibrationProgress::Taught
    }
}

/// Activity of a stretch: the sums of |x| of each electrode.
///
/// At most a minute: 128 x 12 000 x 64 is below 2^32.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Activity {
    sums: [u32; CHANNELS],
    samples: u32,
}

impl Activity {
    /// Adds a sample as received.
    pub fn add(&mut self, sample: Sample) {
        self.join(&Self {
            sums: sample.map(|value| u32::from(value.unsigned_abs())),
            samples: 1,
        });
    }

    /// Profile of the stretch.
    #[must_use]
    pub fn profile(&self) -> Profile {
        let samples = self.samples.max(1);
        Profile::new(self.sums.map(|sum| sum * COUNT / samples))
    }

    fn join(&mut self, other: &Self) {
        for (sum, own) in self.sums.iter_mut().zip(other.sums) {
            *sum += own;
        }
        self.samples += other.samples;
    }

    fn sum(&self) -> u32 {
        self.sums.iter().sum()
    }

    /// Whether the mean is at least 1.4 times that of rest: below, the alignment takes a gesture to be over. Rest counts as one
    /// count at least, as there: noise of an armband without contact is no gesture.
    fn exceeds(&self, rest: &Self) -> bool {
        let floor = rest.sum().max(rest.samples * CHANNELS as u32);
        let product = |a: u32, b: u32, factor: u64| u64::from(a) * u64::from(b) * factor;
        product(self.sum(), rest.samples, 5) >= product(floor, self.samples, 7) && self.samples > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Intent::{Close, Open, Relax, WaveIn, WaveOut};
    use alloc::vec::Vec;

    const OTHER: Shown = Shown::Other;

    /// Runs a session in which each cue has this level of activity and these labels; returns the cues with their patches, and
    /// the end.
    fn run(
        session: &mut CalibrationSession,
        level: impl Fn(Shown) -> i8,
        labels: impl Fn(Shown) -> [Option<Intent>; 2],
    ) -> (Vec<(Shown, u32)>, CalibrationProgress) {
        let mut cues = Vec::new();
        let mut patches = 0;
        loop {
            let cue = session.cue();
            for _ in 0..10 {
                session.sample([level(cue); CHANNELS]);
            }
            patches += 1;
            match session.push(labels(cue)) {
                CalibrationProgress::Same => {}
                CalibrationProgress::Next
                | CalibrationProgress::Opened(_)
                | CalibrationProgress::Taught => {
                    cues.push((cue, patches));
                    patches = 0;
                }
                end => {
                    cues.push((cue, patches));
                    return (cues, end);
                }
            }
        }
    }

    fn strong(cue: Shown) -> i8 {
        if cue == Shown::Intent(Relax) { 2 } else { -20 }
    }

    #[test]
    fn cues_come_in_order_twice_and_other_movement_once() {
        let as_asked = |cue| match cue {
            Shown::Intent(intent) => [None, Some(intent)],
            OTHER => [None; 2],
        };
        for (classes, others, gestures) in [
            (3, false, &[Close][..]),
            (5, true, &[Close, WaveIn, WaveOut]),
        ] {
            let mut session = CalibrationSession::new(classes, others);
            let coming = session.coming().map(|(cue, patches, _)| (cue, patches));
            let coming: Vec<_> = coming.collect();
            let (cues, end) = run(&mut session, strong, as_asked);
            assert_eq!(coming, cues);
            let round = [Relax, Open, Relax].iter().chain(gestures);
            let round: Vec<_> = round.map(|own| (Shown::Intent(*own), 80)).collect();
            let other = others.then_some((OTHER, 140));
            let expected: Vec<_> = round
                .iter()
                .copied()
                .chain(other)
                .chain(round.clone())
                .collect();
            assert_eq!((cues, end), (expected, CalibrationProgress::Judged));
            assert_eq!(session.judgement().recalls(), [0.0, 1.0]);
        }
    }

    #[test]
    fn who_does_nothing_or_never_rests_is_told_at_the_first_gesture() {
        // Rest of less than a count is taken for one count.
        for level in [0, 1, 30] {
            let mut session = CalibrationSession::new(3, false);
            let (cues, end) = run(&mut session, |_| level, |_| [None; 2]);
            assert_eq!((cues.len(), end), (2, CalibrationProgress::Weak), "{level}");
        }
        // 1.4 times rest.
        for (level, cues) in [(13, 2), (14, 8)] {
            let own = |cue| if strong(cue) == 2 { 10 } else { level };
            let mut session = CalibrationSession::new(3, false);
            assert_eq!(run(&mut session, own, |_| [None; 2]).0.len(), cues);
        }
    }

    #[test]
    fn what_is_done_in_the_first_second_of_a_cue_counts_for_nothing() {
        let mut session = CalibrationSession::new(3, false);
        for _ in 0..REACTION {
            assert!(!session.counts());
            session.sample([127; CHANNELS]);
            assert_eq!(session.push([None; 2]), CalibrationProgress::Same);
        }
        assert!(session.counts());
        assert_eq!(session.hold, Activity::default());
    }
}
