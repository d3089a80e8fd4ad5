//! Hardware beside the program: clock, dead-man timer, watchdog, levels of the outputs, log of events.

use std::fmt::Display;
use std::fs::File;
use std::io::Write as _;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use embassy_time::{Duration, Instant, MockDriver};
use virtual_armband::{EVENTS, LEVELS, LINES, PinLevels};

use crate::messages::pin_state::{self, PinState};

static HARDWARE: Mutex<Option<Hardware>> = Mutex::new(None);

struct Hardware {
    lines: File,
    levels: File,
    events: File,
    /// Time at which the dead-man timer expires, once it runs.
    dead_man_us: Option<u64>,
    has_expired: bool,
    /// Time at which the watchdog resets, once it runs.
    watchdog_us: Option<u64>,
    /// Time at which the newest packet was received.
    last_received_us: u64,
    end_us: u64,
}

/// Event of the hardware itself.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Incident {
    /// The watchdog resets the board.
    Reset,
    /// The simulated time is over.
    End,
}

fn lock() -> MutexGuard<'static, Option<Hardware>> {
    // A panic here comes before any change.
    HARDWARE.lock().unwrap_or_else(PoisonError::into_inner)
}

fn with<R>(act: impl FnOnce(&mut Hardware) -> R) -> Option<R> {
    lock().as_mut().map(act)
}

pub fn now_us() -> u64 {
    Instant::now().as_micros()
}

/// Switches the power on, until `end_us`. Output goes to files in a folder, after what they hold.
pub fn start(folder: &Path, end_us: u64) -> std::io::Result<()> {
    let open = |name: &str| {
        File::options()
            .create(true)
            .append(true)
            .open(folder.join(name))
    };
    *lock() = Some(Hardware {
        lines: open(LINES)?,
        levels: open(LEVELS)?,
        events: open(EVENTS)?,
        dead_man_us: None,
        has_expired: false,
        watchdog_us: None,
        last_received_us: 0,
        end_us,
    });
    happened("START", "");
    Ok(())
}

/// Writes to the log what has happened now.
pub fn happened(what: &str, details: impl Display) {
    let now = now_us();
    with(|hardware| {
        write(
            &mut hardware.events,
            format_args!("{what} {now} {details}\n"),
        );
    });
}

/// Lets time pass, and what is due with it.
pub fn advance(us: u64) -> Option<Incident> {
    let target = now_us() + us;
    loop {
        let now = now_us();
        let due = with(|hardware| hardware.due(now)).flatten();
        match due {
            Some(Due::DeadMan) => {
                with(|hardware| hardware.has_expired = true);
                set_levels(pin_state::current());
            }
            Some(Due::Incident(incident)) => return Some(incident),
            None if now >= target => return None,
            None => {
                let next = with(|hardware| hardware.next(now)).flatten();
                let until = next.map_or(target, |next| next.min(target));
                MockDriver::get().advance(Duration::from_micros(until - now));
            }
        }
    }
}

enum Due {
    DeadMan,
    Incident(Incident),
}

impl Hardware {
    fn due(&mut self, now: u64) -> Option<Due> {
        if self.dead_man_us.take_if(|at| *at <= now).is_some() {
            return Some(Due::DeadMan);
        }
        if self.watchdog_us.is_some_and(|at| at <= now) {
            return Some(Due::Incident(Incident::Reset));
        }
        (self.end_us <= now).then_some(Due::Incident(Incident::End))
    }

    fn next(&self, now: u64) -> Option<u64> {
        let times = [self.dead_man_us, self.watchdog_us, Some(self.end_us)];
        times.into_iter().flatten().filter(|at| *at > now).min()
    }
}

/// Restarts the watchdog's period, or starts it.
pub fn feed_watchdog(period_ms: u32) {
    with(|hardware| hardware.watchdog_us = Some(now_us() + u64::from(period_ms) * 1000));
}

/// Restarts the dead-man timer's period, or starts it.
pub fn clear_dead_man(period_ms: u32) {
    with(|hardware| hardware.dead_man_us = Some(now_us() + u64::from(period_ms) * 1000));
}

/// Whether the dead-man timer has expired since it was acknowledged.
pub fn dead_man_has_expired() -> bool {
    with(|hardware| hardware.has_expired).unwrap_or(false)
}

/// Lets the outputs show a valid label again.
pub fn acknowledge_dead_man() {
    with(|hardware| hardware.has_expired = false);
}

/// Notifications of the wearer's armband, over all connections and all starts of the board.
static SENT: AtomicUsize = AtomicUsize::new(0);

/// Notes how many notifications the wearer's armband has sent.
pub fn sent(count: usize) {
    SENT.store(count, Ordering::Relaxed);
}

/// Number of notifications that the wearer's armband has sent.
pub fn packets_sent() -> usize {
    SENT.load(Ordering::Relaxed)
}

pub fn heard() {
    with(|hardware| hardware.last_received_us = now_us());
}

pub fn received(number: usize) {
    heard();
    happened("PACKET", number);
}

/// Sets every output; safe ones while the dead-man timer has expired.
pub fn set_levels(state: PinState) {
    with(|hardware| {
        let safe = PinState {
            status: PinState::SAFE.status,
            ..state
        };
        let state = if hardware.has_expired { safe } else { state };
        let levels = PinLevels {
            at_us: now_us(),
            last_byte_us: hardware.last_received_us,
            valid: state.status.valid(),
            high: vec![state.status.label()],
            alignment_led: state.alignment_led,
        };
        write(&mut hardware.levels, format_args!("{levels}\n"));
    });
}

/// Writes the time of a fault beside the levels.
pub fn report_fault() {
    with(|hardware| write(&mut hardware.levels, format_args!("FAULT {}\n", now_us())));
}

/// Writes the time at which the wearer's armband begins to stream beside the levels.
pub fn report_stream() {
    with(|hardware| write(&mut hardware.levels, format_args!("STREAM {}\n", now_us())));
}

/// Writes bytes that the UART has sent, the last one at this time: the program may be told later.
pub fn write_line(line: &[u8], ended_us: u64) {
    with(|hardware| {
        write(&mut hardware.lines, String::from_utf8_lossy(line));
        write(&mut hardware.events, format_args!("LINE {ended_us}\n"));
    });
}

fn write(file: &mut File, text: impl Display) {
    // A reader of the file notices its end.
    let _ = write!(file, "{text}");
}
