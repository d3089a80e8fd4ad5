//! Expected state without the device's own counters: numbers that the samples carry, and the rules of README in their
//! plainest form.

use std::collections::VecDeque;

use shared::stream::safe_state::{SILENCE_MS, Status};
use shared::uart_line::{Counters, Kind, Report};
use shared::units::{HOLD, LOOK_AHEAD, Millis, PATCH, SampleIndex, WINDOW};

/// Smallest number of received samples in the window; a patch is taken or left as a whole.
const RECEIVED: usize = 540 - PATCH;
/// Largest number of samples filled in, in a row; below, of a window.
const BRIDGED: u32 = 5;
const BRIDGED_OF_WINDOW: usize = 60;

/// Expected state of the device.
#[derive(Default)]
pub struct Truth {
    /// Number and position of the last sample of the stream.
    last: Option<(u32, u32)>,
    /// Positions of the newest received samples.
    received: VecDeque<u32>,
    /// Time at which the last sample was taken.
    at: Option<Millis>,
    position: u32,
    window: Window,
    /// Number of the next line.
    sequence: u32,
    status: Option<Status>,
    /// Instant and line of the last label, if the state has been valid since.
    label: Option<(SampleIndex, SampleIndex)>,
    pub totals: Totals,
}

/// Sums over all streams.
#[derive(Clone, Copy, Default, Debug)]
pub struct Totals {
    /// Samples that the pipeline took.
    pub samples: u64,
    /// Samples missing between two others, by the numbers that they carry.
    pub missing: u64,
    /// Samples missing between two others, by their positions.
    pub counted: u64,
    /// Labels while valid.
    pub labels: u64,
}

/// Window of the pipeline, as a list.
#[derive(Default)]
struct Window {
    /// True for each sample since the last reset that was filled in; the ring has all but the first.
    filled_in: VecDeque<bool>,
    length: usize,
    counters: Counters,
}

impl Truth {
    /// Adds a gap: samples are missing before the next one.
    pub fn gap(&mut self, now: Millis, missing: u32) {
        self.silence(now);
        self.position = self.position.wrapping_add(missing);
        if self.last.is_some() {
            self.totals.counted += u64::from(missing);
        }
        self.window.gap(missing);
    }

    /// Ends the stream: samples lost before the next stream are not counted.
    pub fn disconnected(&mut self) {
        self.last = None;
        self.received.clear();
        self.at = None;
        self.window.reset();
    }

    /// Advances the time; after 200 ms without a sample the window begins anew.
    pub fn silence(&mut self, now: Millis) {
        if self.is_silent(now) {
            self.at = None;
            self.window.reset();
        }
    }

    /// Returns true if there was no sample for 200 ms, or there is no stream.
    pub fn is_silent(&self, now: Millis) -> bool {
        self.at.is_none_or(|at| now.elapsed_since(at) >= SILENCE_MS)
    }

    /// Adds the next sample, which carries its number.
    pub fn sample(&mut self, now: Millis, number: u32) {
        self.silence(now);
        self.at = Some(now);
        self.totals.samples += 1;
        let position = self.position;
        self.position = position.wrapping_add(1);
        if let Some((last_number, last_position)) = self.last.replace((number, position)) {
            assert!(number > last_number, "{number} after {last_number}");
            // The lanes show losses of up to three notifications, arrival times the larger ones: exactly here, where
            // one notification of five has no delay. So positions do not drift from the numbers, however long the run.
            let step = position.wrapping_sub(last_position);
            assert_eq!(step, number - last_number, "after number {last_number}");
            self.totals.missing += u64::from(step - 1);
        }
        self.received.push_back(position);
        if self.received.len() > WINDOW {
            self.received.pop_front();
        }
        self.window.push(false);
    }

    /// Checks a line: its number, its counters, and a label only while valid, with a full window and in time.
    pub fn line(&mut self, report: Report) {
        assert_eq!(report.sequence, self.sequence, "a report is missing");
        self.sequence = report.sequence.wrapping_add(1);
        assert_eq!(report.counters, self.window.counters, "{report}");
        let is_valid = report.status.valid();
        match report.kind {
            Kind::State => {
                assert_ne!(Some(report.status), self.status, "no change: {report}");
                self.label = None;
            }
            Kind::Label => {
                assert!(is_valid, "a label while not valid: {report}");
                let was_valid = self.status.is_some_and(Status::valid);
                assert!(was_valid, "a label before the state is valid: {report}");
                let age = report.emitted.since(report.instant);
                let waited = age.wrapping_sub(1);
                assert!(
                    waited <= LOOK_AHEAD as u32 && waited.is_multiple_of(PATCH as u32),
                    "{report}"
                );
                if let Some((instant, emitted)) = self.label {
                    let step = report.emitted.since(emitted);
                    let is_step = [PATCH, HOLD].contains(&(step as usize));
                    assert!(is_step, "from label to label: {report}");
                    assert!(
                        report.instant.since(instant) <= WINDOW as u32,
                        "back in time: {report}"
                    );
                }
                self.label = Some((report.instant, report.emitted));
                self.totals.labels += 1;
            }
        }
        if is_valid {
            self.window_is_full(report.emitted);
        }
        self.status = Some(report.status);
    }

    /// Returns true if the newest label, while valid, is at most as old as a label holds, and the lines agree with the
    /// pins.
    pub fn is_current(&self, status: Status) {
        let said = self.status.map(Status::valid);
        assert!(
            said.is_none_or(|said| said == status.valid()),
            "pins {status:?}, lines {:?}",
            self.status
        );
        if status.valid() {
            let (_, emitted) = self.label.expect("a label with the state");
            let since = SampleIndex(self.position).since(emitted);
            assert!(since <= HOLD as u32, "no label for {since} samples");
        }
    }

    /// Returns true if the window keeps the promise of `valid`: 600 samples without a gap of more than five, a tenth of
    /// them filled in at most.
    fn window_is_full(&self, emitted: SampleIndex) {
        let within = |position: &&u32| emitted.0.wrapping_sub(**position) < WINDOW as u32;
        let window: Vec<u32> = self.received.iter().filter(within).copied().collect();
        let step = window
            .windows(2)
            .map(|pair| pair[1].wrapping_sub(pair[0]))
            .max();
        assert!(
            window.len() >= RECEIVED && step <= Some(BRIDGED + 1),
            "valid with {} samples and a step of {step:?} at {emitted:?}",
            window.len()
        );
    }

    /// Returns the counters that the next line must have.
    pub const fn counters(&self) -> Counters {
        self.window.counters
    }
}

impl Window {
    fn push(&mut self, filled_in: bool) {
        self.length += 1;
        // The median lags by one sample: the first of a window only fills it.
        if self.length > 1 {
            self.filled_in.push_back(filled_in);
        }
        if self.filled_in.len() > WINDOW + PATCH {
            self.filled_in.pop_front();
        }
    }

    fn gap(&mut self, missing: u32) {
        self.counters.lost = self.counters.lost.saturating_add(missing);
        if self.length == 0 {
            return;
        }
        if missing <= BRIDGED && self.bridged() + missing as usize <= BRIDGED_OF_WINDOW {
            self.counters.bridged += missing;
            (0..missing).for_each(|_| self.push(true));
        } else {
            self.reset();
        }
    }

    /// Returns the number of filled-in samples among the kept ones: the newest 600, less those whose patch the
    /// incomplete one overwrites.
    fn bridged(&self) -> usize {
        let pushed = self.length - 1;
        let kept = if pushed > WINDOW {
            WINDOW - (PATCH - pushed % PATCH) % PATCH
        } else {
            pushed
        };
        let newest = self.filled_in.iter().rev().take(kept);
        newest.filter(|filled_in| **filled_in).count()
    }

    fn reset(&mut self) {
        if self.length > 0 {
            self.counters.resets += 1;
        }
        *self = Self {
            counters: self.counters,
            ..Self::default()
        };
    }
}
