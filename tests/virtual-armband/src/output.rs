//! Files that a board of the tests writes, and a line of the pins' one:
//! `PINS <time us> <last HCI byte us> valid=0 relax=0 ... pinch=0 alignment=0`.

use std::fmt;

use shared::intent::Intent;

/// Name of the file with the lines of UART0.
pub const LINES: &str = "uart0.out";
/// Name of the file with every change of the pins' levels.
pub const LEVELS: &str = "uart2.out";
/// Name of the simulated board's log of events: a word, the microseconds since the start, and details.
pub const EVENTS: &str = "events.out";

/// State of the pins from one instant on.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct PinLevels {
    /// Time of the board's clock, in microseconds.
    pub at_us: u64,
    /// Time at which the newest byte from the controller was received, on the same clock.
    pub last_byte_us: u64,
    /// Level of the `valid` pin.
    pub valid: bool,
    /// Intents whose pin is high.
    pub high: Vec<Intent>,
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
    pub const fn since_last_byte_us(&self) -> u64 {
        self.at_us.saturating_sub(self.last_byte_us)
    }
}

impl fmt::Display for PinLevels {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            at_us,
            last_byte_us,
            valid,
            high,
            alignment_led,
        } = self;
        write!(
            formatter,
            "PINS {at_us} {last_byte_us} valid={}",
            u8::from(*valid)
        )?;
        for intent in Intent::ALL {
            let level = u8::from(high.contains(&intent));
            write!(formatter, " {}={level}", intent.name())?;
        }
        write!(formatter, " alignment={}", u8::from(*alignment_led))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_and_times_are_read_as_written_and_anything_else_is_no_line() {
        let line = "PINS 5200 5000 valid=1 relax=0 open=1 close=0 wave-in=0 wave-out=0 pinch=0 alignment=1";
        let pins = PinLevels::parse(&format!("{line}\r\n")).unwrap();
        assert_eq!(pins.to_string(), line);
        assert!(pins.valid && pins.alignment_led);
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
