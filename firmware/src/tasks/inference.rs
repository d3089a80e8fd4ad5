//! Inference: labels from packets.

use embassy_futures::{
    select::{Either4, select4},
    yield_now,
};
use embassy_time::{Duration, Instant, Timer};
use shared::calibration::Memory;
use shared::model::encoder::DeviceState;
use shared::pipeline::{Absence, AlignmentPhase, Done, ModelRefused, Pipeline, Reports};
use shared::stream::alignment::Trigger;
use shared::stream::link_sequence::QueueGapDetector;
use shared::stream::safe_state::Cause;
use shared::uart_line::answer::Refusal;
use shared::uart_line::calibration::{CalibrateCommand, CalibrationReport, CalibrationState};
use shared::uart_line::command::AlignCommand;
use shared::uart_line::emg::EmgReport;
use shared::uart_line::lock::LockCommand;
use shared::units::Millis;
use static_cell::{ConstStaticCell, StaticCell};

use crate::board::DeadMan;
use crate::clock::now;
use crate::messages::{
    calibration::{self, Keep},
    heartbeat, model,
    packets::PACKETS,
    pin_state, raw,
    requests::{INFERENCE, InferenceRequest, MODEL, ModelRequest},
    uart::{self, UartMessage},
};
use crate::model_region::{self, BoardEncoder, Loaded};
use crate::reset_reason::ResetReason;
use crate::settings::{ALIGN_ON_CONNECTION, ARM, LOCK};

/// The encoder's state, the largest variable in RAM.
static STATE: ConstStaticCell<DeviceState> = ConstStaticCell::new(DeviceState::fresh());

/// Milliseconds that the LED of alignment and calibration is lit, and then dark, when it blinks.
const BLINK_MS: u32 = 250;

/// Pipeline for a model of any dimensions that the device has room for.
pub type DevicePipeline = Pipeline<'static, BoardEncoder>;

/// The pipeline before the first sample, with the model in flash in use, or why it cannot be. To be called once.
pub fn load(reason: ResetReason) -> (&'static mut DevicePipeline, Option<ModelRefused>) {
    let pipeline = fresh(reason);
    let refused = resume(pipeline).err().map(|error| {
        let is_incomplete = model_region::journal().is_some();
        if is_incomplete {
            ModelRefused::Incomplete
        } else {
            error
        }
    });
    (pipeline, refused)
}

/// The pipeline without a model.
// Not inlined: it is constructed on the stack, 5 KiB of it, which must not lie below those that read the model.
#[inline(never)]
fn fresh(reason: ResetReason) -> &'static mut DevicePipeline {
    static PIPELINE: StaticCell<DevicePipeline> = StaticCell::new();
    let pipeline = PIPELINE.init_with(|| Pipeline::without_model(STATE.take(), start(reason)));
    pipeline.set_lock(LOCK);
    // The nRF52832 has no room for it.
    #[cfg(not(feature = "nrf52832"))]
    {
        static MEMORY: ConstStaticCell<Memory> = ConstStaticCell::new(Memory::EMPTY);
        pipeline.lend(MEMORY.take());
    }
    pipeline
}

fn resume(pipeline: &mut DevicePipeline) -> Result<(), ModelRefused> {
    model_region::load(&mut |loaded| {
        let Loaded {
            encoder,
            smoother,
            input,
            checksum,
            calibration,
        } = loaded;
        calibration::set_in_use(calibration);
        pipeline.resume(now(), encoder, smoother, input);
        model::set(Some(checksum));
    })
}

fn start(reason: ResetReason) -> Cause {
    match reason {
        ResetReason::Watchdog => Cause::Watchdog,
        ResetReason::StackOverflow => Cause::StackOverflow,
        ResetReason::Power | ResetReason::Software => Cause::Boot,
    }
}

/// Runs the model forever; without one, for the reason in `refused`, reports that, and waits for one.
///
/// Clears the dead-man timer with every packet that passed the pipeline, provided that the pins show the
/// state of the packets before. So hardware makes the pins safe whatever stops on the way from radio to pin.
///
/// Carries out requests between packets.
#[embassy_executor::task]
pub async fn run(
    pipeline: &'static mut DevicePipeline,
    refused: Option<ModelRefused>,
    mut dead_man: DeadMan,
) -> ! {
    let mut detector = QueueGapDetector::default();
    let mut trigger = Trigger::new(ALIGN_ON_CONNECTION);
    let mut streams = false;
    let mut absence = Absence::began(Millis(0), ModelRefused::Incomplete);
    match refused {
        Some(error) => refuse(pipeline, &mut absence, error),
        None => uart::enqueue(UartMessage::Report(pipeline.state_report())),
    }
    calibration::say_if_refused();
    loop {
        let silence = timer_until(pipeline.deadline());
        let (asked, exchange) = (INFERENCE.receive(), MODEL.receive());
        // Dropped futures lose nothing: packets and requests stay until they are taken, the deadline is the pipeline's.
        let next = select4(PACKETS.receive(), silence, asked, exchange).await;
        let now = now();
        // Checked first: a stall would otherwise be reported as silence of the armband.
        if dead_man.has_expired() {
            stalled(pipeline, now);
        }
        if let Some(memory) = calibration::RETURNED.try_take() {
            pipeline.lend(memory);
        }
        match next {
            Either4::First(packet) => {
                let first = packet.first;
                let received = detector.receive(packet);
                if received.disconnected {
                    let reports = pipeline.disconnected(now);
                    enqueue(pipeline, reports);
                    trigger.disconnected();
                }
                if received.missing > 0 {
                    let reports = pipeline.gap(now, received.missing);
                    enqueue(pipeline, reports);
                }
                for sample in received.samples.into_iter().flatten() {
                    let reports = pipeline.sample(now, sample);
                    enqueue(pipeline, reports);
                }
                if let Some(samples) = received.samples {
                    raw::enqueue(EmgReport { first, samples });
                }
                streams = received.samples.is_some();
                if streams && trigger.begins(pipeline.status().valid()) {
                    pipeline.begin_alignment(ARM);
                    enqueue(pipeline, Reports::default());
                }
                if dead_man.has_expired() {
                    // It may have expired during this packet.
                    stalled(pipeline, now);
                    dead_man.acknowledge();
                }
                if pin_state::is_shown() {
                    dead_man.clear();
                }
                heartbeat::INFERENCE.beat();
            }
            Either4::Second(()) => {
                let reports = pipeline.tick(now);
                enqueue(pipeline, reports);
            }
            Either4::Third((ticket, request)) => {
                let done = match request {
                    InferenceRequest::Align(command) => pipeline.align(command, streams, ARM),
                    InferenceRequest::Gate(command) => pipeline.change_gate(command),
                    InferenceRequest::Lock(command) => Ok(pipeline.change_lock(command)),
                    InferenceRequest::Calibrate(command) => {
                        calibrate(pipeline, &mut absence, command, streams)
                    }
                    InferenceRequest::Press if pipeline.cancel_calibration() => {
                        Ok(Done::Calibrated)
                    }
                    InferenceRequest::Press
                        if pipeline.lock().is_some_and(|lock| lock.is_locked()) =>
                    {
                        Ok(pipeline.change_lock(LockCommand::Hold { is_locked: false }))
                    }
                    InferenceRequest::Press => {
                        pipeline.align(AlignCommand::Begin(ARM), streams, ARM)
                    }
                };
                if let Ok(Done::Align(_)) = done {
                    trigger.requested();
                }
                INFERENCE.answer(ticket, done);
                enqueue(pipeline, Reports::default());
            }
            Either4::Fourth((ticket, request)) => {
                let done = match request {
                    ModelRequest::Suspend => {
                        model::set(None);
                        let reports = pipeline.suspend(now);
                        enqueue(pipeline, reports);
                        absence = Absence::began(now, ModelRefused::Incomplete);
                        Ok(())
                    }
                    ModelRequest::Verify => model_region::load(&mut |_| ()),
                    ModelRequest::Resume => {
                        let resumed = resume(pipeline);
                        calibration::say_if_refused();
                        resumed
                    }
                };
                match done {
                    Ok(()) => enqueue(pipeline, Reports::default()),
                    Err(error) => refuse(pipeline, &mut absence, error),
                }
                MODEL.answer(ticket, done.map_err(|_| Refusal::Model));
            }
        }
        // After requests too: frequent requests would otherwise keep the timer from firing.
        if PACKETS.is_empty() {
            heartbeat::INFERENCE.beat();
        }
        if !pipeline.has_model()
            && let Some(reason) = absence.due(now)
        {
            uart::enqueue(UartMessage::ModelRefused(reason));
            uart::enqueue(UartMessage::Report(pipeline.state_report()));
        }
        if let Some(learnt) = pipeline.take_learnt() {
            keep(pipeline, &mut absence, Some(learnt));
        }
        pin_state::set_status(pipeline.status(), pipeline.strength());
        let blink = (now.0 / BLINK_MS).is_multiple_of(2);
        let alignment = || match pipeline.alignment_phase() {
            AlignmentPhase::None => false,
            AlignmentPhase::Waiting => blink,
            AlignmentPhase::Aligned => true,
        };
        pin_state::set_alignment_led(calibration::led(blink).unwrap_or_else(alignment));
        // Pins and lines follow each packet, however many wait.
        yield_now().await;
    }
}

/// Makes the state safe after hardware made the pins safe.
fn stalled(pipeline: &mut DevicePipeline, now: Millis) {
    if pipeline.status().valid() {
        let reports = pipeline.stalled(now);
        enqueue(pipeline, reports);
    }
}

fn calibrate(
    pipeline: &mut DevicePipeline,
    absence: &mut Absence,
    command: CalibrateCommand,
    streams: bool,
) -> Result<Done, Refusal> {
    let reports = pipeline.calibrate(now(), command, streams, ARM)?;
    enqueue(pipeline, reports);
    if command == CalibrateCommand::Forget {
        keep(pipeline, absence, None);
    }
    Ok(Done::Calibrated)
}

/// Gives up the model, and has its calibration written, or none; then the installation asks for the model again.
fn keep(pipeline: &mut DevicePipeline, absence: &mut Absence, learnt: Option<&'static mut Memory>) {
    let Some(model) = model::current() else {
        return;
    };
    model::set(None);
    let reports = pipeline.suspend(now());
    enqueue(pipeline, reports);
    if learnt.is_none() {
        calibration::report(CalibrationReport::of(CalibrationState::Keeping, None));
    }
    *absence = Absence::began(now(), ModelRefused::Keeping);
    calibration::KEEP.signal(Keep { learnt, model });
}

/// Queues what a call of the pipeline gave and what is new about alignment and calibration, in the order of the lines' numbers.
fn enqueue(pipeline: &mut DevicePipeline, reports: Reports) {
    for report in reports {
        uart::enqueue(UartMessage::Report(report));
    }
    if let Some(report) = pipeline.take_alignment_report() {
        uart::enqueue(UartMessage::Alignment(report));
    }
    if let Some(report) = pipeline.take_calibration_report() {
        calibration::report(report);
    }
}

/// Expires at the deadline, or after a heartbeat period, whichever comes first.
fn timer_until(deadline: Option<Millis>) -> Timer {
    let wait = deadline.map_or(heartbeat::PERIOD, |deadline| {
        let wait = deadline.since(now());
        // A deadline that has passed looks like one in 49 days.
        let passed = wait > i32::MAX.unsigned_abs();
        Duration::from_millis(if passed { 0 } else { wait.into() }).min(heartbeat::PERIOD)
    });
    Timer::at(Instant::now() + wait)
}

/// The region holds no model: says why.
fn refuse(pipeline: &mut DevicePipeline, absence: &mut Absence, error: ModelRefused) {
    uart::enqueue(UartMessage::ModelRefused(error));
    let reports = pipeline.refuse_model(now());
    enqueue(pipeline, reports);
    pin_state::set_status(pipeline.status(), pipeline.strength());
    *absence = Absence::began(now(), error);
}
