//! TIMER (product specification, 6.30): counts the high-frequency clock, or tasks. TIMER3 and TIMER4 are not modelled.

use super::bus::{Bus, Peripheral};
use super::register::{INTEN, Registers, registers};

const INTERRUPTS: u32 = 0x3f << 16;
/// Channels of TIMER0 to TIMER2.
const CHANNELS: u32 = 4;

registers![
    TASKS_START = task(0x000),
    TASKS_STOP = task(0x004),
    TASKS_COUNT = task(0x008),
    TASKS_CLEAR = task(0x00c),
    TASKS_CAPTURE = task(0x040).times(CHANNELS),
    EVENTS_COMPARE = event(0x140).times(CHANNELS),
    SHORTS = read_write(0x200, 0x3f | 0x3f << 8),
    INTENSET = set(0x304, INTEN, INTERRUPTS),
    INTENCLR = clear(0x308, INTEN, INTERRUPTS),
    MODE = read_write(0x504, 3),
    BITMODE = read_write(0x508, 3),
    PRESCALER = read_write(0x510, 0xf).reset(4),
    CC = read_write(0x540, !0).times(CHANNELS),
];

#[derive(Default, Debug)]
pub struct Timer {
    registers: Registers,
    runs: bool,
    /// Tick at which the counter was `count`.
    since: u64,
    count: u64,
    /// Matches up to then have become events.
    seen: u64,
}

impl Timer {
    pub fn new(name: &'static str, base: u32) -> Self {
        Self {
            registers: Registers::new(name, base, TABLE),
            ..Self::default()
        }
    }

    /// A timer that counts microseconds from this tick on, with 32 bits.
    pub fn of_microseconds(name: &'static str, base: u32, now: u64) -> Self {
        let mut timer = Self::new(name, base);
        timer.registers.put(BITMODE, 3);
        timer.runs = true;
        (timer.since, timer.seen) = (now, now);
        timer
    }

    fn counts_tasks(&self) -> bool {
        self.registers.get(MODE) != 0
    }

    fn mask(&self) -> u64 {
        match self.registers.get(BITMODE) {
            0 => 0xffff,
            1 => 0xff,
            2 => 0xff_ffff,
            _ => 0xffff_ffff,
        }
    }

    /// Ticks of the core's clock in one count: 16 MHz, divided.
    fn period(&self) -> u64 {
        4 << self.registers.get(PRESCALER)
    }

    fn value(&self, now: u64) -> u64 {
        let counted = if self.runs && !self.counts_tasks() {
            (now - self.since) / self.period()
        } else {
            0
        };
        (self.count + counted) & self.mask()
    }

    /// Time of the first match after what was seen.
    fn next_match(&self) -> Option<u64> {
        if !self.runs || self.counts_tasks() {
            return None;
        }
        let from = self.seen.max(self.since);
        let (mask, value) = (self.mask(), self.value(from));
        let counted = (from - self.since) / self.period();
        let ahead = |channel: u32| {
            let compare = u64::from(self.registers.get(CC + 4 * channel)) & mask;
            match compare.wrapping_sub(value) & mask {
                0 => mask + 1,
                ahead => ahead,
            }
        };
        let first = (0..CHANNELS).map(ahead).min()?;
        Some(self.since + (counted + first) * self.period())
    }

    fn raise_matches(&mut self, value: u64, bus: &mut Bus) {
        for channel in 0..CHANNELS {
            let compare = u64::from(self.registers.get(CC + 4 * channel)) & self.mask();
            if compare == value {
                self.raise(EVENTS_COMPARE + 4 * channel, bus);
            }
        }
    }
}

impl Peripheral for Timer {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn stored(&mut self, offset: u32, bus: &mut Bus) {
        let value = self.registers.get(offset);
        let wrong = match offset {
            MODE if value == 3 => Some("0 for a timer, 1 or 2 for a counter"),
            PRESCALER if value > 9 => Some("at most 9"),
            // Both only while it is stopped (6.30.5).
            BITMODE | PRESCALER | MODE if self.runs => Some("the timer has to be stopped"),
            _ => None,
        };
        if let Some(expected) = wrong {
            self.unexpected(offset, bus, expected);
        }
    }

    fn task(&mut self, offset: u32, bus: &mut Bus) {
        match offset {
            TASKS_START if self.runs => {}
            TASKS_START => {
                self.runs = true;
                (self.since, self.seen) = (bus.now, bus.now);
            }
            TASKS_STOP => {
                self.count = self.value(bus.now);
                self.runs = false;
            }
            TASKS_COUNT if self.runs && self.counts_tasks() => {
                self.count = (self.count + 1) & self.mask();
                self.raise_matches(self.count, bus);
            }
            TASKS_COUNT => {}
            TASKS_CLEAR => {
                self.count = 0;
                (self.since, self.seen) = (bus.now, bus.now);
            }
            _ => {
                let captured = self.value(bus.now);
                self.registers
                    .put(CC + (offset - TASKS_CAPTURE), captured as u32);
            }
        }
    }

    fn shorts(&self, event: u32) -> Vec<u32> {
        let channel = (event - EVENTS_COMPARE) / 4;
        let shorts = self.registers.get(SHORTS);
        let clears = (shorts >> channel & 1 == 1).then_some(TASKS_CLEAR);
        let stops = (shorts >> (channel + 8) & 1 == 1).then_some(TASKS_STOP);
        clears.into_iter().chain(stops).collect()
    }

    fn next(&self) -> Option<u64> {
        self.next_match()
    }

    fn due(&mut self, bus: &mut Bus) {
        let now = bus.now;
        while let Some(at) = self.next_match().filter(|at| *at <= now) {
            let value = self.value(at);
            self.seen = at;
            self.raise_matches(value, bus);
        }
    }
}
