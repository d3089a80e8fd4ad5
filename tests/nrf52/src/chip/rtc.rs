//! RTC1, a real-time counter (product specification, 6.22): 24 bits at the low-frequency clock. Not modelled: its prescaler, its
//! stop, ticks, and events without an interrupt.

use super::bus::{Bus, Peripheral};
use super::register::{INTEN, Registers, registers};
use crate::time::{low_frequency, of_low_frequency};

const ENABLES: u32 = 1 << 1 | 0xf << 16;
const MASK: u64 = 0xff_ffff;
const CHANNELS: u32 = 4;

registers![
    TASKS_START = task(0x000),
    TASKS_CLEAR = task(0x008),
    EVENTS_OVRFLW = event(0x104),
    EVENTS_COMPARE = event(0x140).times(CHANNELS),
    INTENSET = set(0x304, INTEN, ENABLES),
    INTENCLR = clear(0x308, INTEN, ENABLES),
    COUNTER = read_only(0x504),
    CC = read_write(0x540, 0xff_ffff).times(CHANNELS),
];

#[derive(Default, Debug)]
pub struct Rtc {
    registers: Registers,
    runs: bool,
    /// The period of the low-frequency clock in which the counter is 0: the one after a task, which takes effect at the
    /// clock's next edge (6.22.9). It ends before the counter counts.
    since: u64,
    /// Periods whose events have happened.
    seen: u64,
    /// Period, by channel, until which a channel's value may come too late to be noticed (6.22.7).
    blind_until: [u64; CHANNELS as usize],
}

impl Rtc {
    pub fn new() -> Self {
        Self {
            registers: Registers::new("RTC1", 0x4001_1000, TABLE),
            ..Self::default()
        }
    }

    /// The counter in a period of the low-frequency clock.
    fn value(&self, period: u64) -> u64 {
        let counted = if self.runs {
            period.saturating_sub(self.since)
        } else {
            0
        };
        counted & MASK
    }

    fn enabled(&self, bit: u32) -> bool {
        self.registers.get(INTEN) >> bit & 1 == 1
    }

    /// The next period in which something happens that is enabled.
    fn next_period(&self) -> Option<u64> {
        if !self.runs {
            return None;
        }
        let from = self.seen.max(self.since);
        let value = self.value(from);
        let ahead = |target: u64| match target.wrapping_sub(value) & MASK {
            0 => MASK + 1,
            ahead => ahead,
        };
        let compares = (0..CHANNELS)
            .filter(|channel| self.enabled(16 + channel))
            .map(|channel| ahead(self.registers.get(CC + 4 * channel).into()));
        let overflow = self.enabled(1).then(|| ahead(0));
        Some(from + compares.chain(overflow).min()?)
    }
}

impl Peripheral for Rtc {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn computed(&mut self, offset: u32, bus: &mut Bus) -> Option<u32> {
        (offset == COUNTER).then(|| self.value(low_frequency(bus.now)) as u32)
    }

    fn stored(&mut self, offset: u32, bus: &mut Bus) {
        let period = low_frequency(bus.now);
        match offset {
            CC.. if (offset - CC) / 4 < CHANNELS => {
                // A value that is one ahead may not match: two ahead does.
                self.blind_until[(offset - CC) as usize / 4] = period + 2;
            }
            // What becomes enabled does not look back.
            _ if self.runs => self.seen = self.seen.max(period),
            _ => {}
        }
    }

    fn task(&mut self, offset: u32, bus: &mut Bus) {
        let period = low_frequency(bus.now);
        match offset {
            TASKS_START if !bus.low_frequency_runs => {
                self.untimely(offset, bus, "while the low-frequency clock does not run");
            }
            TASKS_START if self.runs => {}
            TASKS_START => {
                self.runs = true;
                (self.since, self.seen) = (period + 1, period + 1);
            }
            _ => (self.since, self.seen) = (period + 1, period + 1),
        }
    }

    fn next(&self) -> Option<u64> {
        self.next_period().map(of_low_frequency)
    }

    fn due(&mut self, bus: &mut Bus) {
        while let Some(period) = self
            .next_period()
            .filter(|period| of_low_frequency(*period) <= bus.now)
        {
            let value = self.value(period);
            self.seen = period;
            for channel in 0..CHANNELS {
                let matches = u64::from(self.registers.get(CC + 4 * channel)) == value;
                let blind = period < self.blind_until[channel as usize];
                if matches && !blind && self.enabled(16 + channel) {
                    self.raise(EVENTS_COMPARE + 4 * channel, bus);
                }
            }
            if value == 0 && self.enabled(1) {
                self.raise(EVENTS_OVRFLW, bus);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::Memory;

    #[test]
    fn a_counter_is_zero_for_a_whole_period_whenever_it_starts() {
        let mut bus = Bus::new(Memory::new(64, 64, 0));
        bus.low_frequency_runs = true;
        for start in 0..of_low_frequency(2) {
            let mut rtc = Rtc::new();
            bus.now = start;
            rtc.task(TASKS_START, &mut bus);
            let passed = [0, of_low_frequency(1) - 1, of_low_frequency(2)];
            let values = passed.map(|ticks| {
                bus.now = start + ticks;
                rtc.computed(COUNTER, &mut bus)
            });
            assert_eq!(values[..2], [Some(0); 2], "{start}");
            assert!(values[2] > Some(0), "{start}");
        }
    }
}
