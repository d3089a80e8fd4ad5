//! Lines on their way to the UART. Reports and answers are for machines; the others begin with `#` and are for people.
//!
//! Messages come first. An answer waits for them, and the next command waits for its answer: however many commands
//! come, they push no label out of its queue. Raw samples come last.

use core::fmt::{self, Write as _};
use core::sync::atomic::{AtomicBool, Ordering};

use embassy_futures::select::{Either3, select3};
use embassy_sync::{blocking_mutex::raw::CriticalSectionRawMutex, channel::Channel};
use shared::calibration::RecordError;
use shared::myo::{ConnectionParameters, Counters, FirmwareVersion, Following};
use shared::pipeline::ModelRefused;
use shared::uart_line::answer::{Answer, Identity};
use shared::uart_line::calibration::CalibrationReport;
use shared::uart_line::command::{BEGIN_PAIRING, NOBODY_HEARD};
use shared::uart_line::emg::EmgReport;
use shared::uart_line::{Report, alignment::AlignmentReport};

use super::armband::Armband;
use super::queue::Queue;
use super::raw;
use crate::reset_reason::{ResetReason, previous_message};
use crate::settings;

#[derive(Clone, Copy)]
pub enum UartMessage {
    Report(Report),
    Alignment(AlignmentReport),
    Calibration(CalibrationReport),
    /// The calibration that is kept is not used.
    CalibrationRefused(RecordError),
    /// The program started; the CRC-32 of its model file, if it can be run.
    Started(ResetReason, Option<u32>),
    /// A panic ended the run before.
    Ended,
    /// The radio has started, with this source of its clock.
    #[cfg(target_os = "none")]
    SlowClock(crate::settings::SlowClock),
    /// The model cannot be run, so no label will be valid.
    ModelRefused(ModelRefused),
    /// Armband that is followed from now on.
    Following(Following),
    PairingFailed,
    /// The binding, or its removal, was not kept: a restart forgets it.
    NotKept,
    Armband(Armband),
    /// A stream ended; counts of all streams since the start.
    StreamEnded(Counters),
    /// The armband's battery is low; percent.
    LowBattery(u8),
    #[cfg(feature = "uf2")]
    BoardBattery(shared::uart_line::answer::Charge),
    /// The inference is too slow: packets dropped since the start.
    PacketsDropped(u32),
    /// Received bytes were lost, and the command that they belonged to.
    BytesLost,
    Preferred(ConnectionParameters),
}

const VERSION: &str = env!("CARGO_PKG_VERSION");
const REVISION: &str = env!("MYOINTENT_REVISION");

const IMAGE: &str = env!("MYOINTENT_IMAGE");
/// Start of the first line. One text, which `myointent flash` looks for in a file.
const FIRST: &str = concat!(
    "# myointent ",
    env!("CARGO_PKG_VERSION"),
    " ",
    env!("MYOINTENT_REVISION"),
    ", image ",
    env!("MYOINTENT_IMAGE"),
    ", model "
);

/// Bytes of the longest line: all counters of a stream.
const MAX_BYTES: usize = 256;

/// Whether lines have the strength.
static STRENGTH: AtomicBool = AtomicBool::new(settings::STRENGTH);
static MESSAGES: Queue<UartMessage, 16> = Queue::new();
static ANSWERS: Channel<CriticalSectionRawMutex, Answer<'static>, 1> = Channel::new();

/// Queues a message; where the queue is full, the oldest is dropped.
pub fn enqueue(message: UartMessage) {
    MESSAGES.push(message);
}

/// Sets whether lines have the strength from now on.
pub fn switch_strength(on: bool) {
    STRENGTH.store(on, Ordering::Relaxed);
}

/// Hands over an answer, once the one before was taken.
pub async fn answer(answer: Answer<'static>) {
    ANSWERS.send(answer).await;
}

/// Messages dropped since the start, and lines that a USB host did not take; wraps.
pub fn dropped() -> u32 {
    #[cfg(feature = "uf2")]
    return MESSAGES.dropped().wrapping_add(super::usb::LINES.dropped());
    #[cfg(not(feature = "uf2"))]
    MESSAGES.dropped()
}

pub fn is_idle() -> bool {
    MESSAGES.is_empty() && ANSWERS.is_empty() && raw::is_idle()
}

/// Content of the next line.
pub enum Next {
    Message(UartMessage),
    Answer(Answer<'static>),
    Emg(EmgReport),
}

impl Next {
    /// The line, CR LF included.
    pub fn line(self) -> Line {
        match self {
            Self::Message(message) => line(|line| message.write(line)),
            Self::Answer(answer) => line(|line| write!(line, "{answer}")),
            Self::Emg(report) => line(|line| write!(line, "{report}")),
        }
    }
}

/// Waits for the next line: the oldest message; without one, an answer; without either, samples.
pub async fn receive() -> Next {
    // The dropped futures lose nothing: an entry stays in its queue until it is taken.
    match select3(MESSAGES.receive(), ANSWERS.receive(), raw::receive()).await {
        Either3::First(message) => Next::Message(message),
        Either3::Second(answer) => Next::Answer(answer),
        Either3::Third(report) => Next::Emg(report),
    }
}

/// Identity of the program, its model and the armband.
pub fn identity(model: Option<u32>, armband: Armband) -> Identity<'static> {
    Identity {
        version: VERSION,
        revision: REVISION,
        image: IMAGE,
        model,
        armband: armband.address,
        firmware: armband.firmware,
        battery: armband.battery,
    }
}

pub type Line = heapless::String<MAX_BYTES>;

impl UartMessage {
    fn write(self, line: &mut Line) -> fmt::Result {
        match self {
            Self::Report(mut report) => {
                if !STRENGTH.load(Ordering::Relaxed) {
                    report.strength = None;
                }
                write!(line, "{report}")
            }
            Self::Alignment(report) => write!(line, "{report}"),
            Self::Calibration(report) => write!(line, "{report}"),
            Self::CalibrationRefused(error) => write!(line, "# {error}\r\n"),
            Self::Started(reason, model) => {
                line.write_str(FIRST)?;
                match model {
                    Some(checksum) => write!(line, "{checksum:08x}")?,
                    None => line.write_str("refused")?,
                }
                write!(line, ", started by {}\r\n", reason.name())
            }
            Self::Ended => write!(line, "# the run before {}\r\n", previous_message()),
            #[cfg(target_os = "none")]
            Self::SlowClock(source) => write!(line, "# slow clock: {}\r\n", source.name()),
            Self::ModelRefused(error) => write!(line, "# {error}\r\n"),
            Self::Following(following) => write_following(line, following),
            Self::PairingFailed => line.write_str(NOBODY_HEARD),
            Self::NotKept => {
                line.write_str("# the flash page did not take the change: a restart undoes it\r\n")
            }
            Self::Armband(armband) => write!(line, "# {armband}\r\n"),
            Self::StreamEnded(counters) => write_counters(line, counters),
            Self::LowBattery(percent) => write!(line, "# armband battery low: {percent} %\r\n"),
            #[cfg(feature = "uf2")]
            Self::BoardBattery(charge) => {
                let (millivolts, percent) = (charge.millivolts, charge.percent);
                write!(
                    line,
                    "# board battery low: {percent} %, {millivolts} mV\r\n"
                )
            }
            Self::PacketsDropped(packets) => {
                write!(line, "# inference too slow: {packets} packets dropped\r\n")
            }
            Self::BytesLost => {
                line.write_str("# received bytes were lost: send the command again\r\n")
            }
            Self::Preferred(preferred) => write_preferred(line, preferred),
        }
    }
}

fn line(write: impl FnOnce(&mut Line) -> fmt::Result) -> Line {
    let mut line = Line::new();
    if write(&mut line).is_err() {
        // Truncated, but still a line.
        line.truncate(MAX_BYTES - 2);
        let _ = line.push_str("\r\n");
    }
    line
}

fn write_following(line: &mut Line, following: Following) -> fmt::Result {
    match following {
        Following::Pinned(address) => {
            write!(line, "# follows {address}: given when the program was built\r\n")
        }
        Following::Bound(address) => write!(line, "# follows {address}: bound\r\n"),
        Following::Strongest => line.write_str(
            "# follows the strongest armband, whoever wears it: none is bound, and the program was built so\r\n",
        ),
        Following::Pairing => {
            line.write_str("# pairing: in 30 s the armband with the strongest signal is bound\r\n")
        }
        Following::Nobody => {
            line.write_str(
                "# follows no armband: none is bound. Wear yours beside the board and hold button 1 for 3 s, or send ",
            )?;
            line.write_str(BEGIN_PAIRING)
        }
    }
}

fn write_preferred(line: &mut Line, preferred: ConnectionParameters) -> fmt::Result {
    line.write_str("# the armband prefers an interval of ")?;
    // Units of 1.25 ms, in hundredths of a millisecond.
    let [least, most] = [preferred.min_interval, preferred.max_interval].map(|units| {
        let hundredths = u32::from(units) * 125;
        (hundredths / 100, hundredths % 100)
    });
    write!(
        line,
        "{}.{:02} to {}.{:02} ms",
        least.0, least.1, most.0, most.1
    )?;
    let timeout = u32::from(preferred.supervision_timeout) * 10;
    write!(
        line,
        ", latency {}, time-out {timeout} ms\r\n",
        preferred.latency
    )
}

fn write_counters(line: &mut Line, counters: Counters) -> fmt::Result {
    let Counters {
        connections,
        notifications,
        lost,
        given_up,
        duplicates,
        reordered,
        malformed,
        foreign,
        ..
    } = counters;
    write!(
        line,
        "# stream over; since start: connections {connections}, notifications {notifications}, \
         samples lost {lost}, given up {given_up}, duplicates {duplicates}, swaps {reordered}, \
         malformed {malformed}, foreign {foreign}\r\n"
    )
}

impl fmt::Display for Armband {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("armband")?;
        if let Some(address) = self.address {
            write!(f, " {address}")?;
        }
        if let Some(firmware) = self.firmware {
            let FirmwareVersion {
                major,
                minor,
                patch,
                ..
            } = firmware;
            write!(f, ", firmware {major}.{minor}.{patch}")?;
        }
        if let Some(percent) = self.battery {
            write!(f, ", battery {percent} %")?;
        }
        Ok(())
    }
}
