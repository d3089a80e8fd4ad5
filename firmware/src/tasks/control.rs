//! Requests of a person to the board: commands on the UART, presses of the button.

use embassy_futures::{
    select::{Either, select},
    yield_now,
};
use embassy_time::{Duration, Ticker};
use shared::button::{self, Press};
use shared::uart_line::answer::{Answer, Counts, Refusal};
use shared::uart_line::calibration::CalibrateCommand;
use shared::uart_line::command::{AlignCommand, BindCommand, Command, CommandReader};
use shared::units::Millis;

use crate::board::{Button, CommandPort, LINES};
use crate::clock::now;
use crate::messages::{
    armband, calibration, model,
    packets::PACKETS,
    raw,
    requests::{self, InferenceRequest, InstallationRequest},
    uart::{self, UartMessage},
};

/// Period at which the button is read: at least twice while its contact is debounced.
const LOOK: Duration = Duration::from_millis(15);
const _: () = assert!(LOOK.as_millis() * 2 <= button::DEBOUNCE_MS as u64);
/// Bytes that are taken at once; other tasks run before the next ones, however many wait.
const AT_ONCE: usize = 32;
/// Milliseconds between two messages that bytes were lost: on a noisy line that is always so.
const REMINDER_MS: u32 = 10_000;

#[embassy_executor::task]
pub async fn run(mut port: CommandPort, mut button: Button) -> ! {
    let mut readers = [const { CommandReader::new() }; LINES];
    let mut contact = button::Button::default();
    let mut ticker = Ticker::every(LOOK);
    let mut bytes = [0; AT_ONCE];
    let mut reminded: Option<Millis> = None;
    loop {
        // The dropped future loses nothing: the ticker knows its next time, bytes stay where they were received.
        match select(ticker.next(), port.read(&mut bytes)).await {
            Either::First(()) => match contact.look(now(), button.is_down()) {
                // Refused without a stream: there is nothing to align.
                Some(Press::Pressed) => {
                    let _ = requests::INFERENCE.ask(InferenceRequest::Press).await;
                }
                // Refused without a stream or a model.
                Some(Press::Twice) => {
                    let begin = CalibrateCommand::Begin { others: false };
                    let _ = carry_out(0, Command::Calibrate(begin)).await;
                }
                // An address that was given at build time stays.
                Some(Press::Held) => drop(requests::BIND.ask(BindCommand::Begin).await),
                None => {}
            },
            Either::Second((line, Ok(count))) => {
                for &byte in bytes.iter().take(count) {
                    if let Some(command) = readers[line].push(byte) {
                        let answer = match command {
                            Ok(command) => carry_out(line, command).await,
                            Err(refusal) => Answer::Refused(refusal),
                        };
                        uart::answer(answer).await;
                    }
                }
            }
            Either::Second((line, Err(_))) => {
                readers[line].interrupt();
                if reminded.is_none_or(|at| now().elapsed_since(at) >= REMINDER_MS) {
                    reminded = Some(now());
                    uart::enqueue(UartMessage::BytesLost);
                }
            }
        }
        yield_now().await;
    }
}

async fn carry_out(line: usize, command: Command) -> Answer<'static> {
    match command {
        Command::Identify => Answer::Identity(uart::identity(model::current(), armband::current())),
        #[cfg(feature = "uf2")]
        Command::Battery => Answer::Battery(crate::messages::battery::current()),
        #[cfg(not(feature = "uf2"))]
        Command::Battery => Answer::Battery(None),
        Command::Counters => Answer::Counts(Counts {
            session: armband::counters(),
            packets_dropped: PACKETS.dropped(),
            lines_dropped: uart::dropped(),
            emg_dropped: raw::dropped(),
        }),
        Command::Raw(on) => {
            raw::switch(on);
            Answer::Raw(on)
        }
        // A board without USB has line 0 alone.
        Command::Imu(true) if line == 0 => Answer::Refused(Refusal::NoRoom),
        Command::Imu(on) => {
            #[cfg(feature = "uf2")]
            crate::messages::imu::switch(on);
            Answer::Imu(on)
        }
        Command::Strength(on) => {
            uart::switch_strength(on);
            Answer::Strength(on)
        }
        Command::Align(AlignCommand::State) => {
            ask_inference(InferenceRequest::Align(AlignCommand::State)).await
        }
        Command::Calibrate(CalibrateCommand::State) => calibration::answer(),
        Command::Align(_) | Command::Bind(_) | Command::Gate(_) | Command::Calibrate(_)
            if model::current().is_none() =>
        {
            Answer::Refused(Refusal::NoModel)
        }
        Command::Bind(command) => {
            let bound = requests::BIND.ask(command).await;
            bound.map_or_else(Answer::Refused, Answer::Binding)
        }
        Command::Align(command) => ask_inference(InferenceRequest::Align(command)).await,
        Command::Gate(command) => ask_inference(InferenceRequest::Gate(command)).await,
        Command::Calibrate(command) => ask_inference(InferenceRequest::Calibrate(command)).await,
        Command::Lock(command) => ask_inference(InferenceRequest::Lock(command)).await,
        #[cfg(feature = "uf2")]
        Command::Hid(command) => {
            let set = requests::HID.ask(command).await;
            set.map_or_else(Answer::Refused, Answer::Hid)
        }
        // No USB.
        #[cfg(not(feature = "uf2"))]
        Command::Hid(_) => Answer::Refused(Refusal::Unknown),
        Command::Install(transfer) => install(InstallationRequest::Begin(transfer)).await,
        Command::Block(number, block) => install(InstallationRequest::Block(number, block)).await,
    }
}

async fn ask_inference(request: InferenceRequest) -> Answer<'static> {
    let done = requests::INFERENCE.ask(request).await;
    done.map_or_else(Answer::Refused, |done| done.answer(calibration::answer))
}

async fn install(request: InstallationRequest) -> Answer<'static> {
    let progress = requests::INSTALLATION.ask(request).await;
    progress.map_or_else(Answer::Refused, Answer::Install)
}
