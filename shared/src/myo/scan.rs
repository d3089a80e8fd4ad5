//! Which armband to connect to.

use super::address::Address;
use super::advertisement::offers_control;
use super::elapsed;
use crate::units::Millis;

/// How long others may still be heard after the first armband. Advertising repeats several times
/// within it.
const WINDOW_MS: u32 = 500;
/// What radios report where they do not know the signal.
const RSSI_UNKNOWN: i8 = 127;

/// The strongest armband of a scan, or the one that is pinned.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Scan {
    pinned: Option<Address>,
    strongest: Option<Heard>,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Heard {
    address: Address,
    rssi: i8,
    /// When the first of them was heard.
    since: Millis,
}

impl Scan {
    pub(super) const fn new(pinned: Option<Address>) -> Self {
        Self {
            pinned,
            strongest: None,
        }
    }

    /// Hears an advertisement; gives the address where that is already the armband to take.
    ///
    /// A pinned armband is known by its six bytes, whatever it advertises; the kind of its address
    /// is the report's, for a printed address does not tell it.
    pub(super) fn hear(
        &mut self,
        now: Millis,
        address: Address,
        rssi: i8,
        data: &[u8],
    ) -> Option<Address> {
        if let Some(pinned) = self.pinned {
            return (pinned.bytes == address.bytes).then_some(address);
        }
        let rssi = if rssi == RSSI_UNKNOWN { i8::MIN } else { rssi };
        let stronger = self.strongest.is_none_or(|best| rssi > best.rssi);
        if stronger && offers_control(data) {
            let since = self.strongest.map_or(now, |best| best.since);
            self.strongest = Some(Heard {
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

    /// The strongest armband, once all had their chance.
    pub(super) fn choice(&self, now: Millis) -> Option<Address> {
        self.strongest
            .filter(|best| elapsed(now, best.since) >= WINDOW_MS)
            .map(|best| best.address)
    }
}
