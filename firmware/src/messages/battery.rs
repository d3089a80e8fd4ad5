//! Charge of the board's own battery, a lithium cell.

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
/// Percent from which it is low, and those from which it is no longer: load moves the voltage.
const LOW: u32 = 10;
const NO_LONGER_LOW: u32 = 20;

/// Charge of the battery.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Charge {
    /// Voltage, millivolts.
    pub millivolts: u32,
}

impl Charge {
    /// Charge in percent, 0 to 100.
    pub fn percent(self) -> u32 {
        let mut before = (0, 0);
        for (voltage, percent) in CURVE {
            if self.millivolts <= voltage {
                let above = self.millivolts.saturating_sub(before.0);
                return before.1 + (percent - before.1) * above / (voltage - before.0);
            }
            before = (voltage, percent);
        }
        100
    }
}

/// Whether the battery is low.
#[derive(Default)]
pub struct Low(bool);

impl Low {
    /// Returns true if it was not low before this charge.
    pub fn begins(&mut self, charge: Charge) -> bool {
        let limit = if self.0 { NO_LONGER_LOW } else { LOW };
        let is_low = charge.percent() < limit;
        let was_low = core::mem::replace(&mut self.0, is_low);
        is_low && !was_low
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(millivolts: u32) -> Charge {
        Charge { millivolts }
    }

    #[test]
    fn percents_rise_with_the_voltage_from_0_to_100() {
        assert_eq!(at(0).percent(), 0);
        assert_eq!(at(3300).percent(), 0);
        assert_eq!(at(3450).percent(), 5);
        assert_eq!(at(3800).percent(), 50);
        assert_eq!(at(4150).percent(), 100);
        assert_eq!(at(u32::MAX).percent(), 100);
        let all: Vec<_> = (3000..4300).map(|voltage| at(voltage).percent()).collect();
        assert!(all.is_sorted());
    }

    #[test]
    fn a_low_battery_is_said_once_until_it_was_charged() {
        let mut low = Low::default();
        assert!(!low.begins(at(3700)));
        assert!(low.begins(at(3590)));
        // The load goes, and comes again.
        assert!(!low.begins(at(3650)));
        assert!(!low.begins(at(3590)));
        assert!(!low.begins(at(4100)));
        assert!(low.begins(at(3590)));
    }
}
