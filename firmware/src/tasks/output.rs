//! Writes lines and sets pins. Lines wait for the UART; pins wait for nothing.

use core::{
    cell::Cell,
    fmt::{self, Write as _},
};

use embassy_futures::join::join;
use embassy_sync::{
    blocking_mutex::{Mutex, raw::CriticalSectionRawMutex},
    signal::Signal,
};
use embassy_time::with_timeout;
use shared::myo::{Address, Counters, FirmwareVersion};
use shared::stream::safe_state::Status;
use shared::uart_line::Report;

use super::{
    PACKETS,
    inference::Refusal,
    watchdog::{self, ROUND},
};
use crate::board::{LabelPort, Pins, Restart, Shown};
use crate::queue::Queue;

/// What the UART tells. Reports are for machines; the others begin with `#` and are for people.
#[derive(Clone, Copy)]
pub enum Line {
    /// A label, or a change of state.
    Report(Report),
    /// The program started.
    Started(Restart),
    /// No label will be valid.
    Refused(Refusal),
    /// An armband streams.
    Armband(Armband),
    /// A stream ended; counts of all streams since the start.
    StreamOver(Counters),
    /// The armband's battery runs low; percent.
    LowBattery(u8),
    /// The inference fell behind, and so many packets were dropped since the start.
    Dropped(u32),
}

/// What is known of an armband.
#[derive(Clone, Copy)]
pub struct Armband {
    /// Whose signal it is.
    pub address: Option<Address>,
    /// Its firmware.
    pub firmware: Option<FirmwareVersion>,
    /// Its battery, percent.
    pub battery: Option<u8>,
}

/// Longest comment: all counters of a stream.
const MOST_BYTES: usize = 256;

static LINES: Queue<Line, 16> = Queue::new();
static SHOWN: Mutex<CriticalSectionRawMutex, Cell<Shown>> = Mutex::new(Cell::new(Shown::SAFE));
static CHANGED: Signal<CriticalSectionRawMutex, ()> = Signal::new();

/// Queues a line.
pub fn say(line: Line) {
    LINES.push(line);
}

/// Shows label and `valid`.
pub fn status(status: Status) {
    show(|shown| shown.status = status);
}

/// Shows whether an armband streams.
pub fn armband(streams: bool) {
    show(|shown| shown.armband = streams);
}

fn show(change: impl FnOnce(&mut Shown)) {
    SHOWN.lock(|cell| {
        let before = cell.get();
        let mut shown = before;
        change(&mut shown);
        if shown != before {
            cell.set(shown);
            CHANGED.signal(());
        }
    });
}

/// Runs for ever.
#[embassy_executor::task]
pub async fn run(mut port: LabelPort, mut pins: Pins) {
    let show = async {
        loop {
            pins.show(SHOWN.lock(Cell::get));
            CHANGED.wait().await;
        }
    };
    let write = async {
        let mut dropped = 0;
        loop {
            watchdog::OUTPUT.alive();
            if let Ok(line) = with_timeout(ROUND, LINES.next()).await {
                port.send(text(line).as_bytes()).await;
            }
            if PACKETS.dropped() != dropped {
                dropped = PACKETS.dropped();
                port.send(text(Line::Dropped(dropped)).as_bytes()).await;
            }
        }
    };
    join(show, write).await;
}

fn text(line: Line) -> heapless::String<MOST_BYTES> {
    let mut text = heapless::String::new();
    let written = match line {
        Line::Report(report) => write!(text, "{report}"),
        Line::Started(restart) => write!(
            text,
            "# myointent {}, started by {}\r\n",
            env!("CARGO_PKG_VERSION"),
            restart.name()
        ),
        Line::Refused(refusal) => write!(text, "# {refusal}\r\n"),
        Line::Armband(armband) => write!(text, "# {armband}\r\n"),
        Line::StreamOver(counters) => stream_over(&mut text, counters),
        Line::LowBattery(percent) => write!(text, "# armband battery low: {percent} %\r\n"),
        Line::Dropped(packets) => {
            write!(text, "# inference too slow: {packets} packets dropped\r\n")
        }
    };
    if written.is_err() {
        // Cut, but still a line.
        text.truncate(MOST_BYTES - 2);
        let _ = text.push_str("\r\n");
    }
    text
}

fn stream_over(text: &mut heapless::String<MOST_BYTES>, counters: Counters) -> fmt::Result {
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
        text,
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
