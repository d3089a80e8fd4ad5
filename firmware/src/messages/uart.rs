//! Messages on their way to the UART. Reports are for machines; the others begin with `#` and are for people.

use core::fmt::{self, Write as _};

use shared::myo::{Address, Counters, FirmwareVersion};
use shared::uart_line::{Report, alignment::AlignmentReport};

use super::queue::Queue;
use crate::model_region::ModelRefused;
use crate::reset_reason::ResetReason;

/// One line of the UART.
#[derive(Clone, Copy)]
pub enum UartMessage {
    /// A label, or a change of state.
    Report(Report),
    /// What an alignment does.
    Alignment(AlignmentReport),
    /// The program started; the CRC-32 of its model file, if it can be run.
    Started(ResetReason, Option<u32>),
    /// The model cannot be run, so no label will be valid.
    ModelRefused(ModelRefused),
    /// An armband streams.
    Armband(Armband),
    /// A stream ended; counts of all streams since the start.
    StreamEnded(Counters),
    /// The armband's battery is low; percent.
    LowBattery(u8),
    /// The inference is too slow: packets dropped since the start.
    PacketsDropped(u32),
}

/// What is known of an armband.
#[derive(Clone, Copy)]
pub struct Armband {
    /// Its Bluetooth address.
    pub address: Option<Address>,
    /// Its firmware.
    pub firmware: Option<FirmwareVersion>,
    /// Its battery, percent.
    pub battery: Option<u8>,
}

/// The image, by the name that `cargo xtask images` gives it.
const IMAGE: &str = match (
    cfg!(feature = "emulator"),
    cfg!(feature = "nrf52832"),
    cfg!(feature = "radio-trouble"),
) {
    (true, ..) => "emulator",
    (_, true, true) => "nrf52832-sdc",
    (_, true, false) => "nrf52832-s132",
    (_, false, true) => "nrf52840-sdc",
    (_, false, false) => "nrf52840-s140",
};

/// Bytes of the longest comment: all counters of a stream.
const MAX_BYTES: usize = 256;

static MESSAGES: Queue<UartMessage, 16> = Queue::new();

/// Queues a message; where the queue is full, the oldest is dropped.
pub fn enqueue(message: UartMessage) {
    MESSAGES.push(message);
}

/// Whether no message waits.
pub fn is_idle() -> bool {
    MESSAGES.is_empty()
}

/// Waits for the oldest message.
pub async fn receive() -> UartMessage {
    MESSAGES.receive().await
}

/// The text of a message.
pub type Line = heapless::String<MAX_BYTES>;

impl UartMessage {
    /// The line, CR LF included.
    pub fn line(self) -> Line {
        let mut line = Line::new();
        if self.write(&mut line).is_err() {
            // Truncated, but still a line.
            line.truncate(MAX_BYTES - 2);
            let _ = line.push_str("\r\n");
        }
        line
    }

    fn write(self, line: &mut Line) -> fmt::Result {
        match self {
            Self::Report(report) => write!(line, "{report}"),
            Self::Alignment(report) => write!(line, "{report}"),
            Self::Started(reason, model) => {
                let (version, revision) = (env!("CARGO_PKG_VERSION"), env!("MYOINTENT_REVISION"));
                write!(
                    line,
                    "# myointent {version} {revision}, image {IMAGE}, model "
                )?;
                match model {
                    Some(checksum) => write!(line, "{checksum:08x}")?,
                    None => line.write_str("refused")?,
                }
                write!(line, ", started by {}\r\n", reason.name())
            }
            Self::ModelRefused(error) => write!(line, "# {error}\r\n"),
            Self::Armband(armband) => write!(line, "# {armband}\r\n"),
            Self::StreamEnded(counters) => write_counters(line, counters),
            Self::LowBattery(percent) => write!(line, "# armband battery low: {percent} %\r\n"),
            Self::PacketsDropped(packets) => {
                write!(line, "# inference too slow: {packets} packets dropped\r\n")
            }
        }
    }
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
