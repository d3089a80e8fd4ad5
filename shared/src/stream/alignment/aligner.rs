//! Alignment in progress: waits for gestures, then chooses a placement or says why not.

use super::arm_decision::{ArmDecision, SURE};
use super::gesture::GestureDetector;
use super::outcome::AlignmentOutcome;
use super::placement::{Alignment, Arm};
use super::profile::{COUNT, Profile};
use super::template::{Fit, Template};
use crate::units::{CHANNELS, Patch};

/// Openings of the hand that an alignment takes. A third gains nothing: docs/alignment.md.
pub const GESTURES: u8 = 2;

/// Patches after which an alignment without gestures ends: 30 s.
pub const TIMEOUT_PATCHES: u16 = 600;

/// Takes the stream while the wearer opens the hand.
///
/// No clock: time is counted in patches. One call does bounded work; the last gesture's costs 16 x 36 products.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Aligner {
    detector: GestureDetector,
    arm: Arm,
    gestures: u8,
    /// Sums over the gestures of each electrode's mean, in 1/64 counts.
    means: [u32; CHANNELS],
    patches: u16,
}

/// Result of a patch.
#[derive(Clone, PartialEq, Debug)]
pub enum AlignmentProgress {
    /// Nothing new.
    Waiting,
    /// A gesture was found; more are needed.
    Gesture,
    /// The end, but for the arm, which the template alone does not tell.
    Undecided(ArmDecision),
    /// The end.
    Done(AlignmentOutcome),
}

impl Aligner {
    /// An aligner before the first patch; `arm` is what is known of the arm, seen from the alignment of the patches.
    #[must_use]
    pub const fn new(arm: Arm) -> Self {
        Self {
            detector: GestureDetector::new(),
            arm,
            gestures: 0,
            means: [0; CHANNELS],
            patches: 0,
        }
    }

    /// Gestures found so far.
    #[must_use]
    pub const fn gestures(&self) -> u8 {
        self.gestures
    }

    /// The next patch does not follow the one before: a gesture in progress is dropped, those before it count.
    pub fn interrupt(&mut self) {
        self.detector = GestureDetector::new();
    }

    /// Takes the next patch. Not to be called after [`AlignmentProgress::Undecided`] or [`AlignmentProgress::Done`].
    pub fn push(&mut self, patch: &Patch, template: &Template) -> AlignmentProgress {
        self.patches = self.patches.saturating_add(1);
        let Some(gesture) = self.detector.push(patch) else {
            return if self.patches >= TIMEOUT_PATCHES {
                AlignmentProgress::Done(AlignmentOutcome::Timeout)
            } else {
                AlignmentProgress::Waiting
            };
        };
        for (sum, mean) in self.means.iter_mut().zip(gesture.means(COUNT)) {
            *sum += mean;
        }
        self.gestures += 1;
        if self.gestures < GESTURES {
            return AlignmentProgress::Gesture;
        }
        let mean = self.means.map(|sum| sum / u32::from(self.gestures));
        AlignmentProgress::of(
            Profile::new(mean),
            self.arm,
            self.detector.active(),
            template,
            0,
        )
    }
}

impl AlignmentProgress {
    /// The end by the profile of openings; bits of `active` mark their patches, the newest in the lowest bit. The alignment in
    /// force stays if it is further from the template than the nearest by less than `favour`, in the unit of [`NAT`](super::NAT).
    #[must_use]
    pub fn of(profile: Profile, arm: Arm, active: u64, template: &Template, favour: u32) -> Self {
        let fits = template.fit(profile);
        let nearest = match arm {
            Arm::Unknown => fits.nearest,
            Arm::Known { mirrored } => template.fit_on(mirrored, profile),
        };
        let outcome = AlignmentOutcome::of(nearest);
        if !matches!(outcome, AlignmentOutcome::Aligned(_)) {
            return Self::Done(outcome);
        }
        let in_force = template.distance(profile.values());
        if arm != (Arm::Known { mirrored: true }) && in_force < nearest.distance + favour {
            return Self::Done(AlignmentOutcome::Aligned(Fit {
                alignment: Alignment::NONE,
                distance: in_force,
                ..nearest
            }));
        }
        if arm == Arm::Unknown && fits.lead() < SURE {
            return Self::Undecided(ArmDecision::new(fits, active));
        }
        Self::Done(outcome)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::alignment::template::tests::{template, template_of};
    use crate::stream::alignment::{Alignment, NAT, Poor};
    use crate::units::PATCH;

    /// Means whose profile is the test template's: 20 counts x 2^(mean / 256), less 1.
    const OPEN: [u8; CHANNELS] = [58, 43, 31, 22, 16, 12, 8, 6];
    const REST: [u8; CHANNELS] = [2; CHANNELS];

    /// The last progress but `Waiting`, and the patches until it is done.
    fn run(template: &Template, phases: &[([u8; CHANNELS], usize)]) -> (AlignmentProgress, usize) {
        let mut aligner = Aligner::new(Arm::Unknown);
        let mut last = AlignmentProgress::Waiting;
        let mut taken = 0;
        for &(sample, patches) in phases {
            for _ in 0..patches {
                let progress = aligner.push(&[sample; PATCH], template);
                taken += 1;
                match progress {
                    AlignmentProgress::Waiting => {}
                    AlignmentProgress::Gesture => last = progress,
                    AlignmentProgress::Undecided(_) | AlignmentProgress::Done(_) => {
                        return (progress, taken);
                    }
                }
            }
        }
        (last, taken)
    }

    fn two(template: &Template, open: [u8; CHANNELS]) -> AlignmentProgress {
        let phases = [(REST, 20), (open, 20), (REST, 20), (open, 20), (REST, 20)];
        run(template, &phases).0
    }

    #[test]
    fn two_openings_align_whatever_the_placement() {
        for alignment in Alignment::all() {
            match two(&template(), alignment.inverse().apply(OPEN)) {
                AlignmentProgress::Done(AlignmentOutcome::Aligned(fit)) => {
                    assert_eq!(fit.alignment, alignment)
                }
                other => panic!("{alignment:?}: {other:?}"),
            }
        }
    }

    #[test]
    fn one_opening_is_not_enough_and_time_runs_out() {
        let rest_for = |patches| run(&template(), &[(REST, 20), (OPEN, 20), (REST, patches)]);
        assert_eq!(rest_for(100).0, AlignmentProgress::Gesture);
        let late = AlignmentProgress::Done(AlignmentOutcome::Timeout);
        assert_eq!(rest_for(1000), (late, 600));
    }

    #[test]
    fn what_looks_like_no_open_hand_is_poor() {
        let poor = |template: &Template, open| match two(template, open) {
            AlignmentProgress::Done(AlignmentOutcome::Poor(_, poor)) => poor,
            other => panic!("{other:?}"),
        };
        let far = poor(&template(), [127, 1, 60, 1, 60, 1, 60, 1]);
        assert_eq!(far, Poor::Distance);
        // As strong all round, and a template so wide that it is near.
        assert_eq!(poor(&template_of(1), [20; CHANNELS]), Poor::Margin);
    }

    #[test]
    fn an_opening_that_is_nearly_symmetrical_does_not_tell_the_arm() {
        let mean = [400, 200, 0, -200, -300, -200, 0, 200];
        let symmetrical = Template::round(mean, 10).unwrap();
        let open = [58, 34, 20, 12, 9, 12, 20, 34];
        for alignment in Alignment::all() {
            let other = Alignment::new(alignment.turn(), !alignment.mirrored());
            match two(&symmetrical, alignment.inverse().apply(open)) {
                AlignmentProgress::Undecided(decision) => {
                    let fits = decision.fits();
                    let found = [fits.nearest, fits.other_arm].map(|fit| fit.alignment);
                    assert!(found == [alignment, other] || found == [other, alignment]);
                    assert!(fits.lead() < NAT / 10, "{fits:?}");
                }
                other => panic!("{alignment:?}: {other:?}"),
            }
        }
    }

    #[test]
    fn an_interruption_drops_the_gesture_in_progress_alone() {
        let mut aligner = Aligner::new(Arm::Unknown);
        let push = |aligner: &mut Aligner, sample, patches| {
            for _ in 0..patches {
                aligner.push(&[sample; PATCH], &template());
            }
        };
        push(&mut aligner, REST, 20);
        push(&mut aligner, OPEN, 20);
        push(&mut aligner, REST, 20);
        push(&mut aligner, OPEN, 10);
        aligner.interrupt();
        push(&mut aligner, REST, 20);
        assert_eq!(aligner.gestures(), 1);
    }
}
