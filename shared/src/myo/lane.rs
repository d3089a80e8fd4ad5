//! The four EMG characteristics, which notify in turn.

/// Number of EMG characteristics.
pub(super) const LANES: u8 = 4;
/// Milliseconds between two notifications, whatever their lanes.
pub(super) const NOTIFICATION_PERIOD_MS: u32 = 10;

/// EMG characteristic, 0..=3. The four notify in turn, 0 -> 1 -> 2 -> 3 -> 0, one every
/// 10 ms. Notifications carry no counter, so lane and arrival time are all that shows their order.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Lane(u8);

impl Lane {
    /// All lanes, in order.
    pub(super) const ALL: [Self; LANES as usize] = [Self(0), Self(1), Self(2), Self(3)];

    /// The lane of a number; none from 4 on.
    #[must_use]
    pub(super) const fn new(number: u8) -> Option<Self> {
        if number < LANES {
            Some(Self(number))
        } else {
            None
        }
    }

    /// Number of the lane, 0..=3.
    #[must_use]
    pub(super) const fn number(self) -> u8 {
        self.0
    }

    /// The lane that notifies next.
    #[must_use]
    pub(super) const fn next(self) -> Self {
        Self((self.0 + 1) % LANES)
    }

    /// Least number of missing notifications when this lane arrives and `expected` was due, 0..=3. Any
    /// multiple of four more may be missing.
    #[must_use]
    pub(super) const fn missing_since(self, expected: Self) -> u32 {
        ((self.0 + LANES - expected.0) % LANES) as u32
    }
}
