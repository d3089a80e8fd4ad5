//! The files that every board of the tests writes ([`crate::output`]): lines, and levels of the pins.

use std::fmt::Write as _;
use std::path::Path;

use nrf52::time::us;
use shared::intent::Intent;
use virtual_armband::{LEVELS, LINES, PinLevels};

use super::Board;

/// Ticks within which levels change together: one pin after the other.
const TOGETHER: u64 = us(50);

impl Board {
    /// Writes the files into a folder.
    pub fn write_output(&self, folder: &Path) -> anyhow::Result<()> {
        std::fs::write(folder.join(LINES), self.text())?;
        std::fs::write(folder.join(LEVELS), self.levels())?;
        Ok(())
    }

    /// A line for each change of levels.
    fn levels(&self) -> String {
        let chip = self.machine.chip();
        let received = &self.machine.air().received;
        let mut levels = [None; 64];
        let mut lines = String::new();
        let changes = chip.changes.iter();
        let mut changes = changes
            .filter(|(_, pin, _)| *pin != self.pins.strength)
            .peekable();
        while let Some((at, pin, level)) = changes.next() {
            levels[*pin as usize] = *level;
            if changes
                .peek()
                .is_some_and(|(next, ..)| next - at < TOGETHER)
            {
                continue;
            }
            let is_high = |pin: u32| levels[pin as usize] == Some(true);
            let is_lit = |pin: u32| levels[pin as usize] == Some(self.pins.led_on);
            let before = received.partition_point(|(received, _)| received <= at);
            let last = before.checked_sub(1).map_or(0, |last| received[last].0);
            let labels = Intent::ALL.into_iter().zip(self.pins.intents);
            let [.., alignment_led] = self.pins.leds;
            let line = PinLevels {
                at_us: at / us(1),
                last_byte_us: last / us(1),
                valid: is_high(self.pins.valid),
                high: labels
                    .filter(|(_, pin)| is_high(*pin))
                    .map(|(intent, _)| intent)
                    .collect(),
                alignment_led: is_lit(alignment_led),
            };
            // Writing to a string cannot fail.
            let _ = writeln!(lines, "{line}");
        }
        lines
    }
}
