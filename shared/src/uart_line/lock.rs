//! The lock of the labels on the line: times in samples.
//!
//! ```text
//! sign   = "100" ... "2000"         samples that an open hand is held for
//! rest   = "200" ... "120000"       samples of rest after which labels are locked again
//! locked = "0" | "1"
//! ```

use core::fmt;

use super::ParseError;
use super::fields::{Fields, Reader, Writer, fields, wrong};
use crate::stream::lock::{Lock, LockTimes};

/// Command about the lock of the labels.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum LockCommand {
    /// Lock labels until a sign, by these times, until the next start.
    Set(LockTimes),
    /// Lock labels no longer, until the next start.
    Off,
    /// Show labels now, or lock them now; nothing without a lock.
    Hold {
        /// Whether they are locked.
        is_locked: bool,
    },
    /// Change nothing.
    State,
}

/// Lock that is in force.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Locking {
    /// Times of the lock.
    pub times: LockTimes,
    /// Whether labels are locked.
    pub locked: bool,
}

impl From<Lock> for Locking {
    fn from(lock: Lock) -> Self {
        Self {
            times: lock.times(),
            locked: lock.is_locked(),
        }
    }
}

fields!(Locking {
    times: LockTimes,
    locked: bool
});

impl Fields<'_> for LockTimes {
    type Value = Self;
    const COUNT: usize = 2;

    fn write(times: &Self, line: &mut Writer<'_, '_>) -> fmt::Result {
        u32::write(&times.sign, line)?;
        u32::write(&times.rest, line)
    }

    fn read(line: &mut Reader<'_>, _name: &'static str) -> Result<Self, ParseError> {
        let sign = u32::read(line, "sign")?;
        let rest = u32::read(line, "rest")?;
        let times = Self { sign, rest };
        times.are_allowed().then_some(times).ok_or(wrong("rest"))
    }
}
