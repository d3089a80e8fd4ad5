//! Box and blocks against time, a task that measures: a fist grasps a block, an open hand lets it go.
//!
//! Time is the stream's, so that the score is the same for every source and at any speed. A signal that is not good ends the
//! task without a score.

use shared::intent::Intent;
use shared::units::SAMPLE_RATE_HZ;

use crate::event::Event;

/// Time of the task in seconds, from the first fist on.
pub const SECONDS: u32 = 60;
/// Samples from the first to the last label of a fist or an open hand that counts: 0.2 s.
const HELD: u32 = SAMPLE_RATE_HZ / 5;

/// Samples for which a simulated person rests between two gestures: then it moves the most blocks.
const REST: u32 = SAMPLE_RATE_HZ / 2;

/// Task of box and blocks.
#[derive(Debug, Default)]
pub struct Blocks {
    /// Whether it is in progress.
    runs: bool,
    /// Sample of the first fist.
    from: Option<u32>,
    /// Newest label, and the first sample since which it is the same.
    held: Option<(&'static str, u32)>,
    /// Sample of the newest label.
    newest: u32,
    /// Whether a block is grasped.
    grasped: bool,
    /// Number of blocks that were let go.
    moved: u32,
}

impl Blocks {
    /// Hand that is asked for; none while nobody plays.
    pub const fn cue(&self) -> Option<Intent> {
        match (self.runs, self.grasped) {
            (false, _) => None,
            (true, false) => Some(Intent::Close),
            (true, true) => Some(Intent::Open),
        }
    }

    /// Gesture of a simulated person: rests between two, which are recognised the better.
    pub fn hand(&self) -> Option<Intent> {
        let cue = self.cue()?;
        let (label, since) = self.held?;
        let has_rested = label == "relax" && self.newest.wrapping_sub(since) >= REST;
        let goes_on = label == cue.name() || has_rested;
        Some(if goes_on { cue } else { Intent::Relax })
    }

    /// Begins anew.
    pub fn begin(&mut self, at: f64) -> Event {
        *self = Self {
            runs: true,
            ..Self::default()
        };
        self.event(at, "running", None)
    }

    /// Ends it without a score; none if nobody plays.
    pub fn cancel(&mut self, at: f64) -> Option<Event> {
        std::mem::take(&mut self.runs).then(|| self.event(at, "cancelled", None))
    }

    /// Takes an event of the source. Returns what it changes.
    pub fn take(&mut self, now: f64, event: &Event) -> Option<Event> {
        match *event {
            _ if !self.runs => None,
            Event::Report {
                is_label: true,
                instant,
                label,
                valid: true,
                ..
            } => self.label(now, instant, label),
            Event::Report { valid: false, .. }
            | Event::Source {
                connected: false, ..
            } => {
                self.runs = false;
                Some(self.event(now, "interrupted", None))
            }
            _ => None,
        }
    }

    fn label(&mut self, at: f64, instant: u32, label: &'static str) -> Option<Event> {
        let passed = self.from.map_or(0, |from| instant.wrapping_sub(from));
        let left = (SECONDS * SAMPLE_RATE_HZ).saturating_sub(passed);
        if left == 0 {
            self.runs = false;
            return Some(self.event(at, "done", None));
        }
        let since = match self.held {
            Some((held, since)) if held == label => since,
            _ => instant,
        };
        self.held = Some((label, since));
        self.newest = instant;
        let is_asked = self.cue().is_some_and(|cue| cue.name() == label);
        if !is_asked || instant.wrapping_sub(since) < HELD {
            return None;
        }
        self.from.get_or_insert(instant);
        self.moved += u32::from(self.grasped);
        self.grasped = !self.grasped;
        Some(self.event(at, "running", Some(left)))
    }

    fn event(&self, at: f64, state: &'static str, left: Option<u32>) -> Event {
        Event::Blocks {
            at,
            state,
            cue: self.cue().map(Intent::name),
            moved: self.moved,
            left: left.map(|samples| f64::from(samples) / f64::from(SAMPLE_RATE_HZ)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Label of a sample, or a signal that is not good.
    fn report(instant: u32, label: Option<&'static str>) -> Event {
        Event::Report {
            at: 0.0,
            is_label: true,
            number: 0,
            instant,
            emitted: instant,
            label: label.unwrap_or("relax"),
            valid: label.is_some(),
            cause: None,
            lost: 0,
            bridged: 0,
            resets: 0,
            strength: None,
        }
    }

    /// Plays labels, one each 0.1 s, repeated: state, blocks and seconds of each change.
    fn played(
        labels: &[Option<&'static str>],
        count: usize,
    ) -> Vec<(&'static str, u32, Option<f64>)> {
        let mut blocks = Blocks::default();
        let begun = blocks.begin(0.0);
        let labels = labels.iter().cycle().take(count);
        let reports = (0..).step_by(20).zip(labels);
        let changes =
            reports.filter_map(|(instant, label)| blocks.take(0.0, &report(instant, *label)));
        let changes = std::iter::once(begun).chain(changes);
        let told = changes.map(|event| match event {
            Event::Blocks {
                state, moved, left, ..
            } => (state, moved, left),
            other => panic!("{other:?}"),
        });
        told.collect()
    }

    #[test]
    fn a_fist_and_an_open_hand_are_a_block_and_a_minute_ends() {
        // A second a block. What is shorter than 0.2 s, or comes in another order, does not count.
        let [fist, open, rest] = ["close", "open", "relax"].map(Some);
        let second = [rest, fist, open, open, fist, fist, fist, open, open, open];
        let told = played(&second, 1000);
        assert_eq!(told[0], ("running", 0, None));
        // The first fist begins the minute.
        assert_eq!(told[1], ("running", 0, Some(60.0)));
        assert_eq!(told[2], ("running", 1, Some(59.7)));
        assert_eq!(told[3], ("running", 1, Some(59.0)));
        assert_eq!(told.last(), Some(&("done", 60, None)));
        assert_eq!(played(&[rest, open, open, open, open], 1000), told[..1]);
    }

    #[test]
    fn lost_samples_and_its_end_leave_no_score() {
        let told = played(&[Some("close"), Some("close"), Some("close"), None], 100);
        let states: Vec<_> = told.iter().map(|own| own.0).collect();
        assert_eq!(states, ["running", "running", "interrupted"]);
        let mut blocks = Blocks::default();
        blocks.begin(0.0);
        let lost = Event::Source {
            kind: "port",
            name: String::new(),
            connected: false,
            detail: None,
            steps: Vec::new(),
        };
        assert!(blocks.take(0.0, &lost).is_some());
        assert_eq!(blocks.cancel(0.0), None);
        blocks.begin(0.0);
        assert!(blocks.cancel(0.0).is_some());
        assert_eq!(blocks.cue(), None);
    }
}
