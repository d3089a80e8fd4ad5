//! Charge of the board's own battery, a lithium cell. Only the newest counts, so it is not a queue.

#[cfg(feature = "uf2")]
pub use newest::{current, set};
use shared::uart_line::answer::Charge;

/// Voltage of a cell, millivolts, and its charge in percent: about, for it depends on load, cold and age.
const CURVE: [(u32, u32); 7] = [
    (3300, 0),
    (3600, 10),
    (3700, 25),
    (3800, 50),
    (3900, 70),
    (4000, 85),
    (4150, 100),
];
/// Percent from which it is low, and percent from which it no longer is: load moves the voltage.
const LOW: u8 = 10;
const NO_LONGER_LOW: u8 = 20;

pub fn charge(millivolts: u32) -> Charge {
    let mut before = (0, 0);
    for (voltage, percent) in CURVE {
        if millivolts <= voltage {
            let above = millivolts.saturating_sub(before.0);
            let percent = before.1 + (percent - before.1) * above / (voltage - before.0);
            return Charge {
                millivolts,
                percent: percent as u8,
            };
        }
        before = (voltage, percent);
    }
    Charge {
        millivolts,
        percent: 100,
    }
}

#[derive(Default)]
pub struct Low(bool);

impl Low {
    /// Returns true if it was not low before this charge.
    pub fn begins(&mut self, charge: Charge) -> bool {
        let limit = if self.0 { NO_LONGER_LOW } else { LOW };
        let is_low = charge.percent < limit;
        let was_low = core::mem::replace(&mut self.0, is_low);
        is_low && !was_low
    }
}

#[cfg(feature = "uf2")]
mod newest {
    use core::cell::Cell;

    use embassy_sync::blocking_mutex::{Mutex, raw::CriticalSectionRawMutex};
    use shared::uart_line::answer::Charge;

    /// The newest charge; none before the first measurement.
    static CURRENT: Mutex<CriticalSectionRawMutex, Cell<Option<Charge>>> =
        Mutex::new(Cell::new(None));

    pub fn set(charge: Charge) {
        CURRENT.lock(|cell| cell.set(Some(charge)));
    }

    /// The newest charge; none before the first measurement.
    pub fn current() -> Option<Charge> {
        CURRENT.lock(Cell::get)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percents_rise_with_the_voltage_from_0_to_100() {
        assert_eq!(charge(0).percent, 0);
        assert_eq!(charge(3300).percent, 0);
        assert_eq!(charge(3450).percent, 5);
        assert_eq!(charge(3800).percent, 50);
        assert_eq!(charge(4150).percent, 100);
        assert_eq!(charge(u32::MAX).percent, 100);
        let all: Vec<_> = (3000..4300)
            .map(|voltage| charge(voltage).percent)
            .collect();
        assert!(all.is_sorted());
    }

    #[test]
    fn a_low_battery_is_said_once_until_it_was_charged() {
        let mut low = Low::default();
        assert!(!low.begins(charge(3700)));
        assert!(low.begins(charge(3590)));
        // The load goes, and comes again.
        assert!(!low.begins(charge(3650)));
        assert!(!low.begins(charge(3590)));
        assert!(!low.begins(charge(4100)));
        assert!(low.begins(charge(3590)));
    }
}
