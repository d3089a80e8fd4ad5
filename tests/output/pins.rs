//! Log of the pins: `PINS <time us> <last HCI byte us> valid=0 relax=0 ... pinch=0 armband=0 alignment=0`.

use shared::intent::Intent;

/// State of the pins from one instant on.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct PinLevels {
    /// Time of the board's clock, in microseconds; wraps after 71 minutes.
    pub at_us: u32,
    /// Time at which the newest byte from the controller was received, on the same clock.
    pub last_byte_us: u32,
    /// Level of the `valid` pin.
    pub valid: bool,
    /// Intents whose pin is high.
    pub high: Vec<Intent>,
    /// Level of the LED that is lit while an armband streams.
    pub armband: bool,
    /// Level of the LED of alignment and calibration.
    pub alignment_led: bool,
}

impl PinLevels {
    /// Parses a line; returns `None` if it is of another kind or damaged.
    pub fn parse(line: &str) -> Option<Self> {
        let mut words = line.trim_end().strip_prefix("PINS ")?.split(' ');
        let at_us = words.next()?.parse().ok()?;
        let last_byte_us = words.next()?.parse().ok()?;
        let mut pins = Self {
            at_us,
            last_byte_us,
            valid: false,
            high: Vec::new(),
            armband: false,
            alignment_led: false,
        };
        for word in words {
            let (name, level) = word.split_once('=')?;
            let level = match level {
                "0" => false,
                "1" => true,
                _ => return None,
            };
            match Intent::from_name(name) {
                None if name == "valid" => pins.valid = level,
                None if name == "armband" => pins.armband = level,
                None if name == "alignment" => pins.alignment_led = level,
                None => return None,
                Some(intent) if level => pins.high.push(intent),
                Some(_) => {}
            }
        }
        Some(pins)
    }

    /// Returns the microseconds since the newest byte from the controller; 0 if it was received while the line was
    /// being written.
    pub const fn since_last_byte_us(&self) -> u32 {
        let passed = self.at_us.wrapping_sub(self.last_byte_us);
        if passed > i32::MAX as u32 { 0 } else { passed }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_and_times_are_read_and_anything_else_is_no_line() {
        let line = "PINS 5200 5000 valid=1 relax=0 open=1 close=0 wave-in=0 wave-out=0 pinch=0 armband=1 alignment=1\r\n";
        let pins = PinLevels::parse(line).unwrap();
        assert!(pins.valid && pins.armband && pins.alignment_led);
        assert_eq!(pins.high, [Intent::Open]);
        assert_eq!(pins.since_last_byte_us(), 200);
        let overtaken = PinLevels {
            last_byte_us: 5229,
            ..pins
        };
        assert_eq!(overtaken.since_last_byte_us(), 0);
        for wrong in [
            "FAULT 900",
            "PINS 1",
            "PINS 1 2 valid=2",
            "PINS 1 2 thumb=1",
            "PINS 1 x valid=1",
        ] {
            assert_eq!(PinLevels::parse(wrong), None, "{wrong}");
        }
    }
}
