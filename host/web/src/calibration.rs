//! A calibration for the page: what the wearer is asked for now, how long, and what comes next.

use shared::calibration::{CalibrationSession, Shown};
use shared::uart_line::calibration::{CalibrationReport, CalibrationState, name};
use shared::units::{PATCH, SAMPLE_RATE_HZ};

use crate::event::Event;

/// Seconds of a patch.
const PATCH_SECONDS: f64 = PATCH as f64 / SAMPLE_RATE_HZ as f64;

/// Calibration that a source reports.
#[derive(Debug, Default)]
pub struct Calibration {
    /// Cues with their patches, and whether they are of round two; empty where the model is unknown.
    cues: Vec<(Shown, u32, bool)>,
    /// Place of the cue in these; none before the first.
    place: Option<usize>,
    known: (CalibrationReport, bool),
}

impl Calibration {
    /// Learns the model's number of classes.
    pub fn know(&mut self, classes: usize) {
        self.cues = CalibrationSession::new(classes, false).coming().collect();
    }

    /// Cue of the wearer; none while no calibration is in progress.
    pub fn cue(&self) -> Option<Shown> {
        let (report, _) = self.known;
        report.cue.filter(|_| round(report.state).is_some())
    }

    /// Takes a report, and whether a calibration is in use; returns the event if either is new.
    pub fn event(&mut self, at: f64, report: CalibrationReport, in_use: bool) -> Option<Event> {
        if self.known == (report, in_use) {
            return None;
        }
        let round = round(report.state);
        if round.is_none() || self.cue().is_none() {
            self.place = None;
        }
        self.known = (report, in_use);
        let from = self.place.map_or(0, |place| place + 1);
        self.place = round.zip(self.cue()).and_then(|(judges, cue)| {
            let is_it = |place: &usize| {
                let (own, _, round) = self.cues[*place];
                (own, round) == (cue, judges)
            };
            (from..self.cues.len()).find(is_it)
        });
        let coming = self.place.map_or(&[][..], |place| &self.cues[place..]);
        let seconds = |cues: &[(Shown, u32, bool)]| {
            let patches: u32 = cues.iter().map(|(_, patches, _)| patches).sum();
            f64::from(patches) * PATCH_SECONDS
        };
        Some(Event::Calibration {
            at,
            state: report.state.name(),
            cue: report.cue.map(name),
            seconds: coming.first().map(|_| seconds(&coming[..1])),
            next: coming.get(1).map(|(cue, ..)| name(*cue)),
            left: coming.first().map(|_| seconds(coming)),
            before: report.recalls.map(|recalls| recalls.before),
            learnt: report.recalls.map(|recalls| recalls.learnt),
            in_use,
        })
    }
}

/// Whether a state is of round two; none if it is of no round.
const fn round(state: CalibrationState) -> Option<bool> {
    match state {
        CalibrationState::Teaching => Some(false),
        CalibrationState::Judging => Some(true),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::intent::Intent::{Close, Open, Relax};

    #[test]
    fn each_cue_says_how_long_what_comes_next_and_how_much_is_left() {
        use CalibrationState::{Done, Judging, Teaching};
        let mut calibration = Calibration::default();
        calibration.know(3);
        let mut event = |state, cue: Option<_>| {
            let report = CalibrationReport::of(state, cue.map(Shown::Intent));
            match calibration.event(0.0, report, false)? {
                Event::Calibration {
                    seconds,
                    next,
                    left,
                    ..
                } => Some((seconds, next, left)),
                _ => None,
            }
        };
        let said = |next, left| Some((Some(4.0), next, Some(left)));
        for _ in 0..2 {
            assert_eq!(event(Teaching, Some(Relax)), said(Some("open"), 32.0));
            assert_eq!(event(Teaching, Some(Relax)), None);
            assert_eq!(event(Teaching, Some(Open)), said(Some("relax"), 28.0));
            assert_eq!(event(Teaching, Some(Relax)), said(Some("close"), 24.0));
            assert_eq!(event(Teaching, Some(Close)), said(Some("relax"), 20.0));
            // The report of a cue may be lost.
            assert_eq!(event(Judging, Some(Open)), said(Some("relax"), 12.0));
            assert_eq!(event(Judging, Some(Relax)), said(Some("close"), 8.0));
            assert_eq!(event(Judging, Some(Close)), said(None, 4.0));
            assert_eq!(event(Done, None), Some((None, None, None)));
        }
    }

    #[test]
    fn a_model_that_is_unknown_has_cues_alone() {
        let report = CalibrationReport::of(CalibrationState::Teaching, Some(Shown::Intent(Open)));
        let mut calibration = Calibration::default();
        let event = calibration.event(0.0, report, true);
        let is_bare = matches!(
            event,
            Some(Event::Calibration {
                cue: Some("open"),
                seconds: None,
                next: None,
                in_use: true,
                ..
            })
        );
        assert!(is_bare, "{event:?}");
    }
}
