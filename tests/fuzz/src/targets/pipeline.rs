//! Pipeline from samples to labels: samples, losses, silences and alignments in any order at any time.

use shared::intent::{Intent, MAX_LOGITS};
use shared::model::{Encode, LookBackLogits};
use shared::pipeline::{Pipeline, Reports};
use shared::stream::alignment::{Alignment, Arm, Template};
use shared::stream::preprocess::{Median, Preprocessing};
use shared::stream::safe_state::SILENCE_MS;
use shared::stream::smoother::{Margins, Reaction, Settings};
use shared::uart_line::line::Line;
use shared::uart_line::{Counters, Report, ReportKind};
use shared::units::{LOOK_BACK, Millis, Patch, WINDOW};

use crate::input::Input;

/// Model whose scores are the values in the patch.
struct Plain {
    classes: usize,
}

impl Encode for Plain {
    type State = u32;

    fn classes(&self) -> usize {
        self.classes
    }

    fn fresh(&self) -> u32 {
        0
    }

    fn reset(&self, state: &mut u32) {
        *state = 0;
    }

    fn step(&self, state: &mut u32, patch: &Patch) -> LookBackLogits {
        *state += 1;
        let mut rows = [[0.0; MAX_LOGITS]; LOOK_BACK];
        for (row, sample) in rows.iter_mut().zip(patch) {
            for (logit, channel) in row[..self.classes].iter_mut().zip(sample) {
                *logit = f32::from(*channel);
            }
        }
        rows
    }
}

/// Pipeline with its clock and the checks of its reports.
struct Device<'s> {
    pipeline: Pipeline<'s, Plain>,
    now: Millis,
    /// True for each sample of the window that was received, the newest last; the others are filled in.
    window: Vec<bool>,
    last_sample: Option<Millis>,
    counters: Counters,
    /// Number of the next line.
    sequence: u32,
    last_label: Option<Report>,
}

/// Takes settings, then events: a byte for the kind, then its arguments.
pub fn run(data: &[u8]) {
    let mut input = Input(data);
    let bits = input.byte();
    let encoder = Plain {
        classes: [3, 5, 6][usize::from(bits % 3)],
    };
    let mut state = encoder.fresh();
    let settings = Settings {
        look_ahead: input.below(LOOK_BACK),
        hold: 1 + input.below(20),
        margins: Margins {
            entry: f32::from(input.byte()),
            other: (bits & 0x40 != 0).then(|| f32::from(input.byte()) - 128.0),
            early: Reaction::ALL
                .get(input.below(4))
                .and_then(|reaction| reaction.margins().early),
        },
        ..Settings::PAPER_IN_PATCHES
    };
    let pipeline = Pipeline::new(encoder, &mut state, settings);
    let mut pipeline = pipeline.expect("settings in their range");
    pipeline.preprocess(Preprocessing {
        normalized: bits & 0x10 != 0,
        median: if bits & 0x20 != 0 {
            Median::Off
        } else {
            Median::Three
        },
    });
    pipeline.set_template((bits & 0x20 != 0).then(template));
    let mut device = Device {
        pipeline,
        now: Millis(input.word()),
        window: Vec::new(),
        last_sample: None,
        counters: Counters::default(),
        sequence: 0,
        last_label: None,
    };
    // Samples take long, and two windows with the labels after them reach all behaviour.
    let mut samples = 0;
    while !input.is_empty() && samples < 2 * WINDOW + 300 {
        samples += device.step(&mut input);
    }
}

/// Returns a flat template, which any gesture fits.
fn template() -> Template {
    Template::round([0, 16, 32, 48, 64, 80, 96, 112], 1).expect("a template")
}

impl Device<'_> {
    /// Executes the event of the input's next bytes; returns the number of samples that it took.
    fn step(&mut self, input: &mut Input<'_>) -> usize {
        let kind = input.byte();
        match kind % 16 {
            0..=5 => {
                let count = usize::from(input.byte());
                let pattern: [u8; 8] = input.array();
                for number in 0..count {
                    self.now = self.now.plus(5);
                    let turned = number * usize::from(kind >> 4);
                    let sample =
                        pattern.map(|byte| byte.wrapping_mul(turned as u8 | 1).cast_signed());
                    self.sample(sample);
                }
                return count;
            }
            6..=8 => self.gap(u32::from(input.byte() % 8)),
            9 => self.gap(input.word()),
            10 => {
                self.now = self.now.plus(input.pause());
                let reports = self.pipeline.tick(self.now);
                self.check(reports, false);
                let silent = |last| self.now.elapsed_since(last) >= SILENCE_MS;
                assert!(!(self.last_sample.is_some_and(silent) && self.pipeline.status().valid()));
            }
            11 => {
                let reports = self.pipeline.disconnected(self.now);
                self.last_sample = None;
                self.check(reports, false);
                assert!(!self.pipeline.status().valid());
            }
            12 => {
                let reports = self.pipeline.stalled(self.now);
                self.check(reports, false);
                assert!(!self.pipeline.status().valid());
            }
            13 => self.pipeline.begin_alignment(match kind >> 4 {
                0..8 => Arm::Unknown,
                told => Arm::Known {
                    mirrored: told % 2 == 1,
                },
            }),
            14 => self.pipeline.cancel_alignment(),
            _ => self
                .pipeline
                .set_alignment(Alignment::new(input.byte(), input.flag())),
        }
        self.alignment_report();
        0
    }

    fn sample(&mut self, sample: [i8; 8]) {
        let reports = self.pipeline.sample(self.now, sample);
        self.last_sample = Some(self.now);
        self.check(reports, true);
        self.alignment_report();
    }

    fn gap(&mut self, missing: u32) {
        let reports = self.pipeline.gap(self.now, missing);
        self.check(reports, false);
    }

    /// Takes over the counters, and checks the promises of `valid`.
    fn check(&mut self, reports: Reports, received: bool) {
        let mut labelled = false;
        for report in reports {
            labelled = true;
            assert_eq!(Report::parse(report.to_string().as_bytes()), Ok(report));
            self.report(report);
        }
        let report = self.pipeline.state_report();
        self.report(report);
        if received {
            self.window.push(true);
        }
        // Between two labels the state claims only what it claimed with the last one.
        if labelled && self.pipeline.status().valid() {
            self.check_window();
        }
    }

    fn check_window(&self) {
        let newest = &self.window[self.window.len().saturating_sub(WINDOW)..];
        assert_eq!(newest.len(), WINDOW, "valid with {} samples", newest.len());
        let filled = newest.iter().filter(|received| !**received).count();
        assert!(filled <= 60, "valid with {filled} samples filled in");
    }

    fn report(&mut self, report: Report) {
        let strength = report.strength.expect("a strength").get();
        let is_gesture = report.status.label() != Intent::Relax;
        assert!(strength <= 100 && (strength == 0 || is_gesture), "{report}");
        assert_eq!(report.sequence, self.sequence, "lines are counted");
        self.sequence += 1;
        let Counters {
            lost,
            bridged,
            resets,
        } = report.counters;
        assert!(lost >= self.counters.lost && resets >= self.counters.resets && lost >= bridged);
        if resets > self.counters.resets {
            self.window.clear();
        }
        let filled = bridged - self.counters.bridged;
        self.window.extend((0..filled).map(|_| false));
        self.counters = report.counters;
        if report.kind == ReportKind::Label {
            assert!(
                report.emitted.since(report.instant) < WINDOW as u32,
                "{report}"
            );
            if let Some(before) = self.last_label
                && before.counters.resets == resets
            {
                let ahead = report.instant.since(before.instant);
                // An early label is said again until the look-ahead of the next instant is over.
                let least = u32::from(report.status.label() != before.status.label());
                assert!(
                    (least..1 << 31).contains(&ahead),
                    "labels go back: {before}, {report}"
                );
            }
            self.last_label = Some(report);
        }
        if !report.status.valid() {
            assert_eq!(report.status.label(), Intent::Relax);
        }
    }

    fn alignment_report(&mut self) {
        if let Some(report) = self.pipeline.take_alignment_report() {
            assert_eq!(report.sequence, self.sequence);
            self.sequence += 1;
            let line = report.to_string();
            assert_eq!(Line::parse(line.as_bytes()), Ok(Line::Alignment(report)));
        }
    }
}
