//! WDT, the watchdog (product specification, 6.36). Once it runs, nothing but its reset or a loss of power ends it.

use super::bus::{Bus, Peripheral, Reset};
use super::register::{INTEN, Registers, registers};
use crate::time::{low_frequency, of_low_frequency};

/// Value of a reload request (6.36.4.9).
const RELOAD: u32 = 0x6e52_4635;
/// Periods of the low-frequency clock from the event to the reset.
const WARNING: u64 = 2;

registers![
    TASKS_START = task(0x000),
    EVENTS_TIMEOUT = event(0x100),
    INTENSET = set(0x304, INTEN, 1),
    INTENCLR = clear(0x308, INTEN, 1),
    RUNSTATUS = read_only(0x400),
    REQSTATUS = read_only(0x404).reset(1),
    CRV = read_write(0x504, !0).reset(!0),
    RREN = read_write(0x508, 0xff).reset(1),
    CONFIG = read_write(0x50c, 1 | 1 << 3).reset(1),
    RR = write_only(0x600, !0).times(8),
];

#[derive(Default, Debug)]
pub struct Watchdog {
    registers: Registers,
    /// The period of the low-frequency clock in which the counter is 0.
    expires: Option<u64>,
    has_warned: bool,
}

impl Watchdog {
    /// After a loss of power or its own reset.
    pub fn new() -> Self {
        Self {
            registers: Registers::new("WDT", 0x4001_0000, TABLE),
            ..Self::default()
        }
    }

    fn reload(&mut self, now: u64) {
        let period = low_frequency(now);
        // (CRV + 1) / 32768 seconds (6.36.1).
        self.expires = Some(period + u64::from(self.registers.get(CRV)) + 1);
    }
}

impl Peripheral for Watchdog {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn stored(&mut self, offset: u32, bus: &mut Bus) {
        let value = self.registers.get(offset);
        match offset {
            CRV if value < 0xf => {
                self.unexpected(offset, bus, "at least 15");
            }
            CRV | RREN | CONFIG if self.expires.is_some() => {
                self.unexpected(
                    offset,
                    bus,
                    "the watchdog runs, and cannot be configured any more",
                );
            }
            RR.. => {
                let number = (offset - RR) / 4;
                let is_enabled = self.registers.get(RREN) >> number & 1 == 1;
                if value != RELOAD {
                    return self.unexpected(offset, bus, "only 0x6e524635 reloads");
                }
                if self.expires.is_none() || !is_enabled {
                    return;
                }
                // It reloads once every enabled register was written.
                let waiting = self.registers.get(REQSTATUS) & !(1 << number);
                self.registers.put(REQSTATUS, waiting);
                if waiting == 0 {
                    self.registers.put(REQSTATUS, self.registers.get(RREN));
                    self.reload(bus.now);
                }
            }
            _ => {}
        }
    }

    fn task(&mut self, _: u32, bus: &mut Bus) {
        if self.expires.is_none() {
            bus.watchdog_runs = true;
            self.registers.put(RUNSTATUS, 1);
            self.registers.put(REQSTATUS, self.registers.get(RREN));
            self.reload(bus.now);
        }
    }

    fn next(&self) -> Option<u64> {
        let expires = self.expires?;
        let warns = if self.has_warned { WARNING } else { 0 };
        Some(of_low_frequency(expires + warns))
    }

    fn due(&mut self, bus: &mut Bus) {
        if self.has_warned {
            self.expires = None;
            bus.reset(Reset::Watchdog);
        } else {
            self.has_warned = true;
            self.raise(EVENTS_TIMEOUT, bus);
        }
    }
}
