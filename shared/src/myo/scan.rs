//! Choice of the armband to connect to.

use super::address::Address;
use super::advertisement::offers_control;
use crate::units::Millis;

/// Milliseconds for which other armbands are collected after the first one. Advertising repeats several times
/// within it.
const WINDOW_MS: u32 = 500;
/// Value that radios report for an unknown signal strength.
const RSSI_UNKNOWN: i8 = 127;

/// The wanted armband of a scan, or that with the strongest signal.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Scan {
    wanted: Option<Address>,
    strongest: Option<Candidate>,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Candidate {
    address: Address,
    rssi: i8,
    /// Time at which the first candidate was received.
    since: Millis,
}

impl Scan {
    pub(super) const fn new(wanted: Option<Address>) -> Self {
        Self {
            wanted,
            strongest: None,
        }
    }

    /// Takes an advertisement; returns the address if it is the wanted armband's.
    ///
    /// A wanted armband is recognised by its six address bytes, whatever it advertises; the address
    /// kind is the report's, since a printed address does not show it.
    pub(super) fn advertisement(
        &mut self,
        now: Millis,
        address: Address,
        rssi: i8,
        data: &[u8],
    ) -> Option<Address> {
        if let Some(wanted) = self.wanted {
            return (wanted.bytes == address.bytes).then_some(address);
        }
        let rssi = if rssi == RSSI_UNKNOWN { i8::MIN } else { rssi };
        let stronger = self.strongest.is_none_or(|best| rssi > best.rssi);
        if stronger && offers_control(data) {
            let since = self.strongest.map_or(now, |best| best.since);
            self.strongest = Some(Candidate {
                address,
                rssi,
                since,
            });
        }
        None
    }

    /// The strongest armband so far.
    pub(super) fn strongest(&self) -> Option<Address> {
        self.strongest.map(|best| best.address)
    }

    /// The strongest armband, once the collection time is over.
    pub(super) fn choice(&self, now: Millis) -> Option<Address> {
        self.strongest
            .filter(|best| now.elapsed_since(best.since) >= WINDOW_MS)
            .map(|best| best.address)
    }
}
