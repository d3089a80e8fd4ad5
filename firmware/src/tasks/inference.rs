//! From packets to labels.

use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Instant, Timer};
use shared::model::encoder::{DeviceEncoder, DeviceState};
use shared::model::file::{Model, ModelError};
use shared::pipeline::{Pipeline, Reports};
use shared::stream::link_sequence::GapDetector;
use shared::stream::safe_state::{Event, SafeState, Start};
use shared::stream::smoother::Smoother;
use shared::uart_line::{Counters, Kind, Report};
use shared::units::{Millis, SampleIndex};
use static_cell::{ConstStaticCell, StaticCell};

use super::{
    PACKETS, output,
    watchdog::{self, ROUND},
};
use crate::board::Restart;
use crate::model_region;
use crate::radio::follow::now;

/// The encoder's memory, the largest thing in RAM.
static MEMORY: ConstStaticCell<DeviceState> = ConstStaticCell::new(DeviceState::fresh());

/// Rounds between two tellings of a refused model: together a second, long enough to read and
/// short enough for whoever connects late.
const REPEAT: u32 = 2;

/// Why the model region's content cannot be run.
#[derive(Clone, Copy, Debug, thiserror::Error)]
pub enum Refusal {
    /// It is no model, or a damaged or foreign one.
    #[error("model refused: {0}")]
    Model(#[from] ModelError),
    /// It asks for a smoother that there is none of.
    #[error("model refused: {0}")]
    Smoother(#[from] shared::stream::smoother::SettingsError),
}

/// From sample to report, for whichever model lies in flash.
pub type Line = Pipeline<'static, DeviceEncoder<'static>>;

/// The model's encoder and smoother, before the first sample. To be called once.
///
/// # Errors
/// Tells why the model cannot be run.
// Not inlined: what it needs of the stack is given back before anything else runs.
#[inline(never)]
pub fn load(restart: Restart) -> Result<&'static mut Line, Refusal> {
    static LINE: StaticCell<Line> = StaticCell::new();
    let model = Model::parse(model_region::bytes())?;
    let encoder = DeviceEncoder::new(&model)?;
    let settings = model.header.smoother.in_patches();
    let smoother = Smoother::new(settings, encoder.classes())?;
    let line = || Pipeline::with_smoother(encoder, MEMORY.take(), smoother, start(restart));
    // In place: it is too large to pass through the stack.
    Ok(LINE.init_with(line))
}

fn start(restart: Restart) -> Start {
    match restart {
        Restart::Watchdog => Start::Watchdog,
        Restart::Power | Restart::Software => Start::Boot,
    }
}

/// Runs the model for ever.
#[embassy_executor::task]
pub async fn run(pipeline: &'static mut Line) -> ! {
    output::say(output::Line::Report(pipeline.state_report()));
    let mut detector = GapDetector::new();
    loop {
        watchdog::INFERENCE.alive();
        let silence = wait_for(pipeline.deadline());
        match select(PACKETS.next(), silence).await {
            Either::First(packet) => {
                let received = detector.receive(packet);
                let now = now();
                if received.disconnected {
                    tell(pipeline.disconnected(now));
                }
                if received.missing > 0 {
                    tell(pipeline.gap(now, received.missing));
                }
                for sample in received.samples.into_iter().flatten() {
                    tell(pipeline.sample(now, sample));
                }
            }
            Either::Second(()) => tell(pipeline.tick(now())),
        }
        output::status(pipeline.status());
    }
}

fn tell(reports: Reports) {
    for report in reports {
        output::say(output::Line::Report(report));
    }
}

/// Until the deadline, or for a while if there is none.
fn wait_for(deadline: Option<Millis>) -> Timer {
    let wait = deadline.map_or(ROUND, |deadline| {
        let wait = deadline.since(now());
        // A deadline that has passed looks like one in 49 days.
        let passed = wait > i32::MAX.unsigned_abs();
        Duration::from_millis(if passed { 0 } else { wait.into() }).min(ROUND)
    });
    Timer::at(Instant::now() + wait)
}

/// Says for ever why nothing can be valid.
#[embassy_executor::task]
pub async fn refuse(refusal: Refusal, restart: Restart) -> ! {
    let mut guard = SafeState::new(start(restart));
    guard.handle(now(), Event::ModelRefused);
    let mut sequence = 0_u32;
    loop {
        output::say(output::Line::Refused(refusal));
        output::say(output::Line::Report(Report {
            kind: Kind::State,
            sequence,
            instant: SampleIndex(0),
            emitted: SampleIndex(0),
            status: guard.status(),
            counters: Counters::default(),
        }));
        sequence = sequence.wrapping_add(1);
        for _ in 0..REPEAT {
            watchdog::INFERENCE.alive();
            // No radio runs without a model.
            watchdog::RADIO.alive();
            Timer::after(ROUND).await;
        }
    }
}
