//! TIMER (product specification, 6.30): counts the high-frequency clock, or tasks.

use super::bus::{Bus, Peripheral};
use super::register::{INTEN, Register, Registers, clear, event, read_write, set, task};

const START: u32 = 0x000;
const STOP: u32 = 0x004;
const COUNT: u32 = 0x008;
const CLEAR: u32 = 0x00c;
const SHUTDOWN: u32 = 0x010;
const CAPTURE: u32 = 0x040;
const COMPARE: u32 = 0x140;
const SHORTS: u32 = 0x200;
const MODE: u32 = 0x504;
const BITMODE: u32 = 0x508;
const PRESCALER: u32 = 0x510;
const CC: u32 = 0x540;
const INTERRUPTS: u32 = 0x3f << 16;

macro_rules! table {
    ($channels:literal) => {
        &[
            task("TASKS_START", START),
            task("TASKS_STOP", STOP),
            task("TASKS_COUNT", COUNT),
            task("TASKS_CLEAR", CLEAR),
            task("TASKS_SHUTDOWN", SHUTDOWN),
            task("TASKS_CAPTURE", CAPTURE).times($channels),
            event("EVENTS_COMPARE", COMPARE).times($channels),
            read_write("SHORTS", SHORTS, 0x3f | 0x3f << 8),
            set("INTENSET", 0x304, INTEN, INTERRUPTS),
            clear("INTENCLR", 0x308, INTEN, INTERRUPTS),
            read_write("MODE", MODE, 3),
            read_write("BITMODE", BITMODE, 3),
            read_write("PRESCALER", PRESCALER, 0xf).reset(4),
            read_write("CC", CC, !0).times($channels),
        ]
    };
}

/// TIMER0 to TIMER2 have four channels, TIMER3 and TIMER4 six.
const FOUR: &[Register] = table!(4);
const SIX: &[Register] = table!(6);

#[derive(Debug)]
pub struct Timer {
    registers: Registers,
    channels: u32,
    runs: bool,
    /// Tick at which the counter was `count`.
    since: u64,
    count: u64,
    /// Matches up to then have become events.
    seen: u64,
}

impl Timer {
    pub fn new(name: &'static str, base: u32, channels: u32) -> Self {
        Self {
            registers: Registers::new(name, base, if channels == 4 { FOUR } else { SIX }),
            channels,
            runs: false,
            since: 0,
            count: 0,
            seen: 0,
        }
    }

    /// A timer that counts microseconds from this tick on, with 32 bits.
    pub fn of_microseconds(name: &'static str, base: u32, now: u64) -> Self {
        let mut timer = Self::new(name, base, 4);
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
        let first = (0..self.channels).map(ahead).min()?;
        Some(self.since + (counted + first) * self.period())
    }

    fn raise_matches(&mut self, value: u64, bus: &mut Bus) {
        for channel in 0..self.channels {
            let compare = u64::from(self.registers.get(CC + 4 * channel)) & self.mask();
            if compare == value {
                self.raise(COMPARE + 4 * channel, bus);
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
            START if self.runs => {}
            START => {
                self.runs = true;
                (self.since, self.seen) = (bus.now, bus.now);
            }
            STOP | SHUTDOWN => {
                self.count = self.value(bus.now);
                self.runs = false;
                if offset == SHUTDOWN {
                    self.count = 0;
                }
            }
            COUNT if self.runs && self.counts_tasks() => {
                self.count = (self.count + 1) & self.mask();
                self.raise_matches(self.count, bus);
            }
            COUNT => {}
            CLEAR => {
                self.count = 0;
                (self.since, self.seen) = (bus.now, bus.now);
            }
            _ => {
                let captured = self.value(bus.now);
                self.registers.put(CC + (offset - CAPTURE), captured as u32);
            }
        }
    }

    fn shorts(&self, event: u32) -> Vec<u32> {
        let channel = (event - COMPARE) / 4;
        let shorts = self.registers.get(SHORTS);
        let clears = (shorts >> channel & 1 == 1).then_some(CLEAR);
        let stops = (shorts >> (channel + 8) & 1 == 1).then_some(STOP);
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
