//! The air between the chip's radio and armbands: scans, attempts to connect, one link as a central, requests to attributes.
//!
//! The SoftDevice or the controller takes its [`AirEvent`]s and gives them the form that the program knows. Links
//! lose nothing, and nobody interferes.

mod link;
mod scan;

use std::collections::VecDeque;

use virtual_armband::Armband;

use crate::time::us;
use link::AirLink;
pub use link::{AirRequest, Parameters, parameters_are_allowed};
pub use scan::ScanTimes;
use scan::{Attempt, Scan};

/// Reasons for the end of a connection (Bluetooth Core Specification, volume 1, part F, 1.3).
mod reason {
    /// Nothing was heard from the other side for the supervision time-out.
    pub const CONNECTION_TIMEOUT: u8 = 0x08;
    /// The other side ended it.
    pub const REMOTE_ENDED: u8 = 0x13;
    /// End by this side.
    pub const LOCAL_ENDED: u8 = 0x16;
}

/// Something that the radio tells.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum AirEvent {
    /// An armband, by its index, was heard to advertise.
    Advertised(usize),
    ScanTimedOut,
    AttemptTimedOut,
    /// The link to an armband, by its index, is there.
    Connected(usize, Parameters),
    /// The link has ended, for this reason.
    Disconnected(u8),
    Updated(Parameters),
    /// The armband asks for other parameters, with this identifier.
    Asked(u8),
    /// The armband was sent this number of packets.
    Sent(u16),
    /// The longest unit that the armband takes, in bytes.
    Mtu(u16),
    /// An attribute was read; none where it cannot be.
    Read(u16, Option<Vec<u8>>),
    /// An attribute was written; false where it cannot be.
    Written(u16, bool),
    /// A notification: attribute and value.
    Notified(u16, Vec<u8>),
}

#[derive(Default, Debug)]
pub struct Air {
    events: VecDeque<AirEvent>,
    scan: Option<Scan>,
    /// Ticks of the scans that have ended.
    scanned: u64,
    attempt: Option<Attempt>,
    link: Option<AirLink>,
    /// Whether a connection is made while the command that cancels its attempt is on the way.
    pub cancel_comes_late: bool,
    /// Armbands within reach.
    pub armbands: Vec<Armband>,
    /// Notifications of armbands: the tick at which each was received, and its number.
    pub received: Vec<(u64, usize)>,
}

/// Microseconds of the armbands' clock.
fn air_us(ticks: u64) -> u64 {
    ticks / us(1)
}

impl Air {
    /// The radio falls silent: a link is lost without a word.
    pub fn reset(&mut self, now: u64) {
        if let Some(link) = self.link.take() {
            self.armbands[link.armband].disconnected(air_us(now));
        }
        self.scan = None;
        self.attempt = None;
        self.events.clear();
    }

    /// Returns true while it scans, tries to connect, or has a link.
    pub const fn is_in_use(&self) -> bool {
        self.scan.is_some() || self.attempt.is_some() || self.link.is_some()
    }

    pub const fn scans(&self) -> bool {
        self.scan.is_some()
    }

    pub const fn connects(&self) -> bool {
        self.attempt.is_some()
    }

    pub const fn is_linked(&self) -> bool {
        self.link.is_some()
    }

    pub fn take(&mut self) -> Option<AirEvent> {
        self.events.pop_front()
    }

    /// Returns the tick at which something happens by itself next, if something does.
    pub fn next(&self) -> Option<u64> {
        let scan = self.scan.as_ref().map(Scan::next);
        let attempt = self.attempt.as_ref().map(Attempt::next);
        let link = self.link.as_ref().map(|link| link.at);
        [scan, attempt, link].into_iter().flatten().min()
    }

    pub fn advance(&mut self, now: u64) {
        self.advance_scan(now);
        self.advance_attempt(now);
        self.advance_link(now);
    }
}
