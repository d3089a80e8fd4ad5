//! The device between radio and label, and what has to hold of it at every moment.

use std::collections::VecDeque;

use shared::model::encoder::{DeviceEncoder, DeviceState};
use shared::model::file::Model;
use shared::myo::{Action, Address, AddressKind, Event, MyoSession, Pair, Phase, Settings};
use shared::pipeline::{Pipeline, Reports};
use shared::stream::link_sequence::{GapDetector, Packet, Sequencer};
use shared::stream::safe_state::Start;
use shared::units::{Millis, Sample, SampleIndex};

/// Packets that the queue holds, as on a board.
const QUEUE: usize = 32;
/// The clock at the start: it wraps ten minutes later.
const START: Millis = Millis(u32::MAX - 600_000);
/// Position of the first sample: positions wrap after eight minutes.
const FIRST: u32 = u32::MAX - 96_000;
/// Samples of the window, and how many of them have to be received ones; a patch is taken or left as a whole.
const WINDOW: u32 = 600;
const RECEIVED: usize = 540 - 10;
/// Most positions between two received samples of a valid window: five are filled in.
const MAX_STEP: u32 = 6;
/// Losses up to here are counted exactly, in samples.
const EXACT: u32 = 6;
/// How wrong the estimate of a larger loss may be: one round of the four lanes.
const ESTIMATE: u32 = 8;

/// The armband that the device follows.
pub const ARMBAND: Address = Address {
    kind: AddressKind::Public,
    bytes: [1, 0, 0, 0, 0, 0xfa],
};

/// A sample that carries its number.
pub const fn numbered(number: u32) -> Sample {
    let [a, b, c, d] = number.to_le_bytes();
    let noise = (number.wrapping_mul(2_654_435_761) >> 24) as u8;
    [
        a.cast_signed(),
        b.cast_signed(),
        c.cast_signed(),
        d.cast_signed(),
        noise.cast_signed() / 8,
        noise.cast_signed() / 16,
        -(noise.cast_signed() / 8),
        0,
    ]
}

fn number(sample: Sample) -> u32 {
    let [a, b, c, d, ..] = sample.map(i8::cast_unsigned);
    u32::from_le_bytes([a, b, c, d])
}

/// Everything from notification to label, as the firmware connects it.
pub struct Device<'m, 's> {
    pub session: MyoSession,
    sequencer: Sequencer,
    queue: VecDeque<Packet>,
    pub dropped: u32,
    detector: GapDetector,
    pipeline: Pipeline<'s, DeviceEncoder<'m>>,
    truth: Truth,
}

/// What is known without the device's own counters.
#[derive(Default)]
struct Truth {
    /// Number and position of the last sample of the stream.
    last: Option<(u32, u32)>,
    /// Positions of the newest received samples.
    received: VecDeque<u32>,
    /// When the last sample was taken.
    at: Option<Millis>,
    position: u32,
    lost: u32,
    sequence: u32,
    labels: u64,
    worst_estimate: u32,
}

/// Runs something with a device that has this model.
pub fn with_device(model: &[u8], run: impl FnOnce(&mut Device<'_, '_>)) {
    let model = Model::parse(model).expect("a model");
    let encoder = DeviceEncoder::new(&model).expect("a model for boards");
    let mut state: DeviceState = encoder.fresh();
    let settings = model.header.smoother.in_patches();
    let mut pipeline =
        Pipeline::new(encoder, &mut state, settings, Start::Boot).expect("its settings");
    pipeline.preprocess(model.header.preprocessing);
    let settings = Settings {
        pinned: Some(ARMBAND),
        ..Settings::default()
    };
    let mut sequencer = Sequencer::new();
    sequencer.gap(FIRST);
    run(&mut Device {
        session: MyoSession::new(settings),
        sequencer,
        queue: VecDeque::new(),
        dropped: 0,
        detector: GapDetector::new(),
        pipeline,
        truth: Truth::default(),
    });
}

impl Device<'_, '_> {
    /// The clock so many milliseconds after the start.
    pub const fn clock(elapsed_ms: u64) -> Millis {
        Millis(START.0.wrapping_add(elapsed_ms as u32))
    }

    /// Passes an event to the session; gives the actions for the radio.
    pub fn handle(&mut self, now: Millis, event: Event<'_>) -> Vec<Action> {
        let mut actions = Vec::new();
        let (sequencer, queue) = (&mut self.sequencer, &mut self.queue);
        let dropped = &mut self.dropped;
        let mut push = |packet| {
            if queue.len() == QUEUE {
                queue.pop_front();
                *dropped += 1;
            }
            queue.push_back(packet);
        };
        self.session.handle(now, event, &mut |action| match action {
            Action::Deliver(pair) => push(sequencer.samples(pair)),
            Action::Gap { missing } => sequencer.gap(missing),
            Action::StreamEnded => push(sequencer.end()),
            action => actions.push(action),
        });
        actions
    }

    /// Runs the inference until the queue is empty.
    pub fn infer(&mut self, now: Millis) {
        while let Some(packet) = self.queue.pop_front() {
            let received = self.detector.receive(packet);
            if received.disconnected {
                let reports = self.pipeline.disconnected(now);
                self.truth.restart();
                self.check(reports);
            }
            if received.missing > 0 {
                // The silence before the loss is seen is reported before the loss is counted.
                let reports = self.pipeline.tick(now);
                self.check(reports);
                let reports = self.pipeline.gap(now, received.missing);
                self.truth.position = self.truth.position.wrapping_add(received.missing);
                self.truth.lost = self.truth.lost.saturating_add(received.missing);
                self.check(reports);
            }
            self.samples(now, received.samples);
        }
        let reports = self.pipeline.tick(now);
        self.check(reports);
        let silent = self.truth.at.is_none_or(|at| now.elapsed_since(at) >= 200);
        assert!(!(silent && self.is_valid()), "valid in silence");
    }

    fn samples(&mut self, now: Millis, pair: Option<Pair>) {
        for sample in pair.into_iter().flatten() {
            self.truth.sample(now, number(sample));
            let reports = self.pipeline.sample(now, sample);
            self.check(reports);
        }
    }

    /// Whether `valid` is high.
    pub const fn is_valid(&self) -> bool {
        self.pipeline.status().valid()
    }

    /// Whether samples come, or are to come.
    pub fn is_streaming(&self) -> bool {
        self.session.phase() == Phase::Streaming
    }

    fn check(&mut self, reports: Reports) {
        for report in reports {
            assert_eq!(report.sequence, self.truth.sequence, "a report is missing");
            self.truth.sequence = report.sequence.wrapping_add(1);
            assert_eq!(report.counters.lost, self.truth.lost, "{report}");
            assert!(report.counters.bridged <= report.counters.lost, "{report}");
            if report.status.valid() {
                self.truth.labels += 1;
                self.truth.window_is_full(report.emitted);
            }
        }
    }

    /// Labels while valid, and the worst estimate of a loss in samples.
    pub const fn seen(&self) -> (u64, u32) {
        (self.truth.labels, self.truth.worst_estimate)
    }
}

impl Truth {
    /// Another stream: what was lost between is not counted.
    fn restart(&mut self) {
        self.last = None;
        self.received.clear();
        self.at = None;
    }

    fn sample(&mut self, now: Millis, number: u32) {
        self.at = Some(now);
        let position = self.position;
        self.position = position.wrapping_add(1);
        if let Some((last_number, last_position)) = self.last.replace((number, position)) {
            assert!(number > last_number, "{number} after {last_number}");
            let (true_step, step) = (number - last_number, position.wrapping_sub(last_position));
            let wrong = true_step.abs_diff(step);
            let allowed = if true_step - 1 <= EXACT { 0 } else { ESTIMATE };
            assert!(
                wrong <= allowed,
                "{true_step} samples on, {step} by the positions, from number {last_number}"
            );
            self.worst_estimate = self.worst_estimate.max(wrong);
        }
        self.received.push_back(position);
        if self.received.len() > WINDOW as usize {
            self.received.pop_front();
        }
    }

    /// What `valid` promises: 600 samples without a gap of more than five, a tenth of them filled in at most.
    fn window_is_full(&self, emitted: SampleIndex) {
        let within = |position: &&u32| emitted.0.wrapping_sub(**position) < WINDOW;
        let window: Vec<u32> = self.received.iter().filter(within).copied().collect();
        let step = window
            .windows(2)
            .map(|pair| pair[1].wrapping_sub(pair[0]))
            .max();
        assert!(
            window.len() >= RECEIVED && step <= Some(MAX_STEP),
            "valid with {} samples and a step of {step:?} at {emitted:?}",
            window.len()
        );
    }
}
