//! Armband that a session follows, and how that changes while it runs.

use super::*;

/// Milliseconds for which a pairing collects armbands: enough to wake one's own and to hold it near.
pub(super) const PAIRING_MS: u32 = 30_000;
/// The delay before the next scan when the armband changes: the shortest.
const CHANGE_MS: u32 = 300;

/// Armband that a session follows, and why.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Following {
    /// The armband of the settings.
    Pinned(Address),
    /// The bound armband.
    Bound(Address),
    /// The armband with the strongest signal: no armband is bound, and the settings allow it.
    Strongest,
    /// No armband, since no armband is bound.
    Nobody,
    /// No armband yet: a pairing looks for the one to bind.
    Pairing,
}

impl Following {
    /// The address that is looked for, if it is known.
    #[must_use]
    pub const fn address(self) -> Option<Address> {
        match self {
            Self::Pinned(address) | Self::Bound(address) => Some(address),
            Self::Strongest | Self::Nobody | Self::Pairing => None,
        }
    }
}

/// A pairing in progress.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Pairing {
    since: Millis,
    pub(super) scan: Scan,
}

impl MyoSession {
    /// Armband that is followed, and why.
    #[must_use]
    pub const fn following(&self) -> Following {
        match (self.settings.pinned, self.pairing, self.settings.bound) {
            (Some(address), ..) => Following::Pinned(address),
            (None, Some(_), _) => Following::Pairing,
            (None, None, Some(address)) => Following::Bound(address),
            (None, None, None) if self.settings.follow_strongest => Following::Strongest,
            (None, None, None) => Following::Nobody,
        }
    }

    /// The armband that is bound, whether it is followed or not.
    #[must_use]
    pub const fn bound(&self) -> Option<Address> {
        self.settings.bound
    }

    /// Whether the last pairing ended without an armband.
    #[must_use]
    pub const fn pairing_failed(&self) -> bool {
        self.pairing_failed
    }

    /// Begins a pairing, anew if one is in progress.
    pub(super) fn pair(&mut self, now: Millis, act: &mut impl FnMut(Action)) {
        if self.settings.pinned.is_none() {
            self.pairing = Some(Pairing {
                since: now,
                scan: Scan::new(None),
            });
            self.pairing_failed = false;
            self.look_anew(now, act);
        }
    }

    /// Binds an armband, or forgets it; ends a pairing.
    pub(super) fn bind(
        &mut self,
        now: Millis,
        armband: Option<Address>,
        act: &mut impl FnMut(Action),
    ) {
        if self.settings.pinned.is_none() {
            self.pairing = None;
            self.settings.bound = armband;
            act(Action::Keep(armband));
            self.look_anew(now, act);
        }
    }

    /// Ends a pairing whose time is over.
    pub(super) fn end_pairing(&mut self, now: Millis, act: &mut impl FnMut(Action)) {
        let over = |pairing: &mut Pairing| now.elapsed_since(pairing.since) >= PAIRING_MS;
        let Some(pairing) = self.pairing.take_if(over) else {
            return;
        };
        let strongest = pairing.scan.strongest();
        self.pairing_failed = strongest.is_none();
        if let Some(armband) = strongest {
            self.settings.bound = Some(armband);
            act(Action::Keep(strongest));
        }
        match (&self.state, strongest) {
            (SessionState::Scanning(_), Some(armband)) => self.connect(now, armband, act),
            (SessionState::Scanning(_), None) => self.look_anew(now, act),
            _ => {}
        }
    }

    /// Another armband is to be followed than before: ends the connection to that one, and scans.
    fn look_anew(&mut self, now: Millis, act: &mut impl FnMut(Action)) {
        match &mut self.state {
            SessionState::Idle => {}
            SessionState::Unbound => self.start_scan(act),
            // Begun anew even where it goes on: between two scans there is time to keep the new armband.
            SessionState::Scanning(_) => {
                act(Action::StopScan);
                self.start_scan(act);
            }
            SessionState::Disconnecting { delay, .. } => *delay = CHANGE_MS,
            SessionState::BackingOff { since, delay } => (*since, *delay) = (now, CHANGE_MS),
            SessionState::Connecting { .. }
            | SessionState::SettingUp { .. }
            | SessionState::Streaming(_) => {
                self.disconnect(now, CHANGE_MS, act);
            }
        }
    }
}
