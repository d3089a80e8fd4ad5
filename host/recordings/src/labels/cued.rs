//! Labels from muscle activity where cues say which gesture was asked for, and when.
//!
//! A hold is a gesture that is cued between two rests, or several that follow each other. For each, by the rule of
//! `activity` over the hold with the later half of the rest before it and the whole one after:
//!
//! 1. The muscle follows if it is active for half of the cue or more, and becomes active between 0.5 s before the cue and
//!    1.5 s after it. Else nothing of the hold is labelled, nor the 1.5 s after it.
//! 2. In a hold that is followed, activity is the gesture, and quiet before and after it is relax. Everything else is
//!    unknown, such as a muscle that is still active 1.5 s after the cue for rest.
//! 3. From gesture to gesture the muscle stays active, which does not show the change: the label changes as late after
//!    the cue as the muscle has followed the hold.
//!
//! 4. A cue of [`Motion::OTHER`] asks for whatever the person does: activity is other movement, whenever it begins, and
//!    quiet within the cue is unknown.
//!
//! Rests without a hold beside them are relax as cued. A gesture is any movement that is asked for, an intent or
//! another.

use std::ops::Range;

use shared::units::Sample;

use super::activity::{Activity, activity};
use super::envelope::Envelope;
use super::motion::Motion;
use super::runs::{self, Run, runs};
use crate::statistics::median;

/// Samples before a cue from which the muscle may follow it: 0.5 s.
const EARLY: usize = 100;
/// Samples after a cue until which the muscle must follow it: 1.5 s.
const LATE: usize = 300;

/// Response of a muscle to a cue.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Response {
    /// The muscle followed, this many samples after the cue.
    Followed(i32),
    /// The muscle hardly rose above rest.
    Weak,
    /// The muscle was active, but not when it was asked for, or not for long enough.
    Elsewhere,
}

/// A gesture, or several in a row, between rests.
#[derive(Clone, PartialEq, Debug)]
pub struct Hold {
    /// Samples for which the hold was cued.
    pub samples: Range<usize>,
    /// The gestures, with the first sample of each.
    pub gestures: Vec<(usize, Motion)>,
    /// Response of the muscle.
    pub response: Response,
    /// Samples for which the muscle was active because of the cue, if it followed.
    pub active: Option<Range<usize>>,
    /// Rise of the muscle above rest for each gesture: natural logarithm of the ratio of amplitudes.
    pub contrasts: Vec<f64>,
}

/// Motions that the muscle shows, and the result of each hold.
#[derive(Clone, PartialEq, Debug)]
pub struct Followed {
    /// Motion at each sample.
    pub motions: Vec<Motion>,
    /// Holds in order of time.
    pub holds: Vec<Hold>,
}

/// Motions that the muscle shows where there are cues, one per sample; unknown where nothing was asked for.
pub fn follow(samples: &[Sample], cues: &[Motion]) -> Followed {
    let rest = |&cue: &Motion| match cue {
        Motion::RELAX => Motion::RELAX,
        _ => Motion::Unknown,
    };
    let mut motions: Vec<Motion> = cues.iter().map(rest).collect();
    let mut holds = Vec::new();
    let envelope = Envelope::new(samples);
    let runs = runs(cues);
    for Range { start, end } in runs::holds(&runs, is_gesture) {
        let hold = runs[start].start..runs[end - 1].end;
        let before = runs[..start].last().filter(|run| is_rest(run));
        let after = runs.get(end).filter(|run| is_rest(run));
        let segment = Segment {
            // The earlier half belongs to the hold before, which may end there.
            from: before.map_or(hold.start, |rest| {
                if start == 1 {
                    rest.start
                } else {
                    rest.middle()
                }
            }),
            to: after.map_or(hold.end, |rest| rest.end),
            hold,
        };
        let cued = &runs[start..end];
        holds.push(segment.label(samples, &envelope, cued, &mut motions));
    }
    Followed { motions, holds }
}

const fn is_rest(run: &Run<Motion>) -> bool {
    matches!(run.label, Motion::RELAX)
}

const fn is_gesture(run: &Run<Motion>) -> bool {
    !matches!(run.label, Motion::RELAX | Motion::Unknown)
}

/// A hold and the rest around it.
struct Segment {
    from: usize,
    hold: Range<usize>,
    to: usize,
}

impl Segment {
    fn label(
        &self,
        samples: &[Sample],
        envelope: &Envelope,
        cued: &[Run<Motion>],
        motions: &mut [Motion],
    ) -> Hold {
        let activity = activity(&samples[self.from..self.to]);
        let (response, active) = match &activity {
            None => (Response::Weak, None),
            Some(activity) if cued.iter().any(|run| run.label == Motion::OTHER) => {
                self.during(activity)
            }
            Some(activity) => self.followed(activity),
        };
        let late = match response {
            Response::Followed(late) => usize::try_from(late).unwrap_or(0),
            _ => 0,
        };
        let gestures: Vec<(usize, Motion)> =
            cued.iter().map(|run| (run.start, run.label)).collect();
        if let (Some(activity), Some(active)) = (&activity, &active) {
            let released = (self.hold.end + LATE).min(self.to);
            for (at, activity) in (self.from..self.to).zip(activity) {
                let inside = active.contains(&at);
                motions[at] = match activity {
                    Activity::Active if inside && at < released => gestures
                        .iter()
                        .rev()
                        .find(|&&(start, _)| start + late <= at)
                        .or(gestures.first())
                        .map_or(Motion::Unknown, |&(_, motion)| motion),
                    Activity::Quiet if !inside => Motion::RELAX,
                    _ => Motion::Unknown,
                };
            }
        } else {
            let end = (self.hold.end + LATE).min(self.to);
            motions[self.hold.start..end].fill(Motion::Unknown);
        }
        let contrast = |run: &Run<Motion>| self.contrast(envelope, run);
        Hold {
            samples: self.hold.clone(),
            contrasts: cued.iter().map(contrast).collect(),
            gestures,
            response,
            active,
        }
    }

    /// Response of the muscle, and the samples for which it was active because of the cue.
    fn followed(&self, activity: &[Activity]) -> (Response, Option<Range<usize>>) {
        let is_active = |at: &usize| activity[at - self.from] == Activity::Active;
        let first = self.hold.start.saturating_sub(EARLY).max(self.from);
        let last = (self.hold.start + LATE).min(self.hold.end);
        let onset = (first..last).find(is_active);
        let inside = self.hold.clone().filter(is_active).count();
        // A muscle that is active before this time already does not follow the cue.
        let onset = onset.filter(|&at| at > first || first == self.from && self.from == 0);
        let (Some(onset), true) = (onset, 2 * inside >= self.hold.len()) else {
            return (Response::Elsewhere, None);
        };
        let late = onset as i64 - self.hold.start as i64;
        let late = i32::try_from(late).unwrap_or(0);
        let end = self.released(onset, activity);
        (Response::Followed(late), Some(onset..end))
    }

    /// Response to a cue that may be followed at any time.
    fn during(&self, activity: &[Activity]) -> (Response, Option<Range<usize>>) {
        let end = self.released(self.hold.start, activity);
        (Response::Followed(0), Some(self.hold.start..end))
    }

    /// Sample after the activity that begins within the cue, at `onset` or later.
    fn released(&self, onset: usize, activity: &[Activity]) -> usize {
        let mut end = onset;
        for at in onset..self.to {
            // Activity that begins after the end of the cue is another movement.
            let is_active = activity[at - self.from] == Activity::Active;
            if is_active && (at < self.hold.end || at == end) {
                end = at + 1;
            }
        }
        end
    }

    /// Median envelope of a cue's later half minus that of the rest before it.
    fn contrast(&self, envelope: &Envelope, cue: &Run<Motion>) -> f64 {
        const WIDTH: usize = 40;
        let level = |range: Range<usize>| {
            let all: Vec<f64> = range.step_by(4).map(|at| envelope.at(at, WIDTH)).collect();
            median(&all)
        };
        let rest = level(self.from..self.hold.start);
        let hold = level(cue.middle()..cue.end);
        rest.zip(hold).map_or(0.0, |(rest, hold)| hold - rest)
    }
}

#[cfg(test)]
mod tests {
    use shared::intent::Intent;

    use super::*;
    use crate::fixture::{cells, labels, muscle};
    use crate::recording::movement::MovementKind;

    const R: Motion = Motion::RELAX;
    const O: Motion = Motion::Intent(Intent::Open);
    const C: Motion = Motion::Intent(Intent::Close);

    /// Cues, samples at which the muscle is loud, labels that are found, and how late each hold is followed. R is relax,
    /// O open, C close, X other movement, U unknown.
    ///
    /// From gesture to gesture the label changes as late as the muscle has followed; other movement may begin at any time;
    /// what the muscle does 1.5 s after its cue is unknown.
    const CASES: &str = "\
R600 O700 R600 C700 R600 | 680-1420 1950-2700 | R0 O680 R1420 C1950 R2700 | 80 50
R600 O500 C500 R600 | 660-1650 | R0 O660 C1160 R1650 | 60
R600 X4000 R600 | 2000-2600 3500-4700 | R0 U600 X2000 U2600 X3500 R4700 | 0
R600 O600 R1400 | 650-1800 | R0 O650 U1500 R1800 | 50";

    fn number(text: &str) -> usize {
        text.parse().unwrap()
    }

    fn motion(text: &str) -> (Motion, usize) {
        let (motion, rest) = text.split_at(1);
        let motion = match motion {
            "R" => R,
            "O" => O,
            "C" => C,
            "X" => Motion::OTHER,
            _ => Motion::Unknown,
        };
        (motion, number(rest))
    }

    #[test]
    fn labels_are_where_the_muscle_is_and_not_where_the_cue_was() {
        for [case, loud, expected, late] in cells(CASES) {
            let asked: Vec<_> = case.split(' ').map(motion).collect();
            let ends = loud.split(' ').map(|loud| loud.split_once('-').unwrap());
            let loud: Vec<_> = ends.map(|(from, to)| number(from)..number(to)).collect();
            let cues = labels(&asked);
            let found = follow(&muscle(cues.len(), &loud), &cues);
            let expected: Vec<_> = expected.split(' ').map(motion).collect();
            let runs = runs(&found.motions);
            assert_eq!(runs.len(), expected.len(), "{case}: {runs:?}");
            for (run, (label, start)) in runs.iter().zip(expected) {
                assert_eq!(run.label, label, "{case}: {runs:?}");
                assert!(run.start.abs_diff(start) <= 10, "{case}: {runs:?}");
            }
            let late: Vec<_> = late.split(' ').map(number).collect();
            assert_eq!(found.holds.len(), late.len(), "{case}: {:?}", found.holds);
            for (hold, late) in found.holds.iter().zip(late) {
                let Response::Followed(found) = hold.response else {
                    panic!("{case}: {hold:?}");
                };
                assert!(found.abs_diff(late as i32) <= 10, "{case}: {hold:?}");
                assert_eq!(hold.contrasts.len(), hold.gestures.len());
                assert!(hold.contrasts.iter().all(|own| *own > 1.0), "{hold:?}");
            }
        }
    }

    #[test]
    fn a_muscle_that_is_active_at_another_time_does_not_follow() {
        let cues = labels(&[(R, 600), (O, 700), (R, 800)]);
        for loud in [1250..1700, 300..1000, 700..900] {
            let found = follow(&muscle(cues.len(), std::slice::from_ref(&loud)), &cues);
            assert_eq!(found.holds[0].response, Response::Elsewhere, "{loud:?}");
            let gesture = found.motions.iter().filter(|motion| **motion == O).count();
            assert_eq!(gesture, 0, "{loud:?}");
        }
        let point = Motion::Other(MovementKind::Point);
        let cues = labels(&[(R, 600), (point, 4000), (R, 600)]);
        let found = follow(&muscle(cues.len(), &[2000..2600, 3500..4700]), &cues);
        assert_eq!(found.holds[0].response, Response::Elsewhere);
    }

    proptest::proptest! {
        #![proptest_config(proptest::prelude::ProptestConfig::with_cases(64))]
        /// Any cues over any samples give a label a sample, and no panic.
        #[test]
        fn arbitrary_cues_never_panic(
            pieces in proptest::collection::vec((proptest::prelude::any::<Sample>(), 0_usize..8, 1_usize..400), 0..12),
        ) {
            let samples: Vec<Sample> =
                pieces.iter().flat_map(|&(sample, _, count)| vec![sample; count]).collect();
            let cues: Vec<_> = pieces
                .iter()
                .flat_map(|&(_, class, count)| vec![Intent::from_class(class).map_or(Motion::Unknown, Motion::Intent); count])
                .collect();
            let found = follow(&samples, &cues);
            proptest::prop_assert_eq!(found.motions.len(), samples.len());
            for (label, cue) in found.motions.iter().zip(&cues) {
                // Nothing is labelled where nothing was asked for.
                proptest::prop_assert!(*cue != Motion::Unknown || *label == Motion::Unknown);
            }
        }
    }
}
