//! Device between radio and label, and the conditions that hold at every moment.

use std::collections::VecDeque;

use shared::model::encoder::{DeviceEncoder, DeviceState};
use shared::model::file::Model;
use shared::myo::{Action, Address, AddressKind, Event, MyoSession, Pair, Phase, Settings};
use shared::pipeline::{Pipeline, Reports};
use shared::stream::link_sequence::{GapDetector, Packet, Sequencer};
use shared::stream::safe_state::Start;
use shared::units::{Millis, Sample};

use super::truth::Truth;

/// Number of packets that the queue holds, as on a board.
pub const QUEUE: usize = 32;
/// Clock at the start: it wraps ten minutes later.
const START: Millis = Millis(u32::MAX - 600_000);
/// Position of the first sample: positions wrap after eight minutes.
const FIRST: u32 = u32::MAX - 96_000;

/// Address of the armband that the device follows.
pub const ARMBAND: Address = Address {
    kind: AddressKind::Public,
    bytes: [1, 0, 0, 0, 0, 0xfa],
};

/// Returns a sample that carries its number.
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

/// Steps from notification to label, connected as in the firmware.
pub struct Device<'m, 's> {
    pub session: MyoSession,
    sequencer: Sequencer,
    queue: VecDeque<Packet>,
    pub dropped: u32,
    detector: GapDetector,
    pipeline: Pipeline<'s, DeviceEncoder<'m>>,
    pub truth: Truth,
}

/// Runs a function with a device that has this model.
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
    /// Returns the clock so many milliseconds after the start.
    pub const fn clock(elapsed_ms: u64) -> Millis {
        Millis(START.0.wrapping_add(elapsed_ms as u32))
    }

    /// Passes an event to the session; returns the actions for the radio.
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
                self.truth.disconnected();
                self.check(reports);
            }
            if received.missing > 0 {
                // The silence before the loss is seen is reported before the loss is counted.
                self.tick(now);
                let reports = self.pipeline.gap(now, received.missing);
                self.truth.gap(now, received.missing);
                self.check(reports);
            }
            self.samples(now, received.samples);
        }
        self.tick(now);
        let silent = self.truth.is_silent(now);
        assert!(!(silent && self.is_valid()), "valid in silence");
        self.truth.is_current(self.pipeline.status());
    }

    fn tick(&mut self, now: Millis) {
        let reports = self.pipeline.tick(now);
        self.truth.silence(now);
        self.check(reports);
    }

    fn samples(&mut self, now: Millis, pair: Option<Pair>) {
        for sample in pair.into_iter().flatten() {
            self.truth.sample(now, number(sample));
            let reports = self.pipeline.sample(now, sample);
            self.check(reports);
        }
    }

    /// Returns true if `valid` is high.
    pub const fn is_valid(&self) -> bool {
        self.pipeline.status().valid()
    }

    /// Returns true if samples come, or are to come.
    pub fn is_streaming(&self) -> bool {
        self.session.phase() == Phase::Streaming
    }

    fn check(&mut self, reports: Reports) {
        for report in reports {
            self.truth.line(report);
        }
    }
}
