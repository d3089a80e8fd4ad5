//! PWM0 (product specification, 6.17): one value for one channel, in a counter that counts up. Loops, longer sequences, shortcuts
//! and the other channels are not modelled.

use super::bus::{Bus, Peripheral};
use super::register::{INTEN, Register, Registers, clear, event, read_write, set, task};
use crate::refusal::What;

const STOP: u32 = 0x004;
const START: u32 = 0x008;
const STOPPED: u32 = 0x104;
const STARTED: u32 = 0x108;
const SEQUENCE_END: u32 = 0x110;
const PERIOD_END: u32 = 0x118;
const ENABLE: u32 = 0x500;
const TOP: u32 = 0x508;
const PRESCALER: u32 = 0x50c;
const PTR: u32 = 0x520;
const CNT: u32 = 0x524;
const PSEL: u32 = 0x560;
const INTERRUPTS: u32 = 0xfe;
const DISCONNECTED: u32 = 1 << 31;
/// Bit of a value: the pin is high first, and falls at the value.
const FALLS: u16 = 1 << 15;

const TABLE: &[Register] = &[
    task("TASKS_STOP", STOP),
    task("TASKS_SEQSTART", START),
    event("EVENTS_STOPPED", STOPPED),
    event("EVENTS_SEQSTARTED", STARTED).times(2),
    event("EVENTS_SEQEND", SEQUENCE_END).times(2),
    event("EVENTS_PWMPERIODEND", PERIOD_END),
    event("EVENTS_LOOPSDONE", 0x11c),
    read_write("SHORTS", 0x200, 0),
    set("INTENSET", 0x304, INTEN, INTERRUPTS),
    clear("INTENCLR", 0x308, INTEN, !0),
    read_write("ENABLE", ENABLE, 1),
    read_write("MODE", 0x504, 0),
    read_write("COUNTERTOP", TOP, 0x7fff).reset(0x3ff),
    read_write("PRESCALER", PRESCALER, 7),
    read_write("DECODER", 0x510, 0),
    read_write("LOOP", 0x514, 0),
    read_write("SEQ.PTR", PTR, !0),
    read_write("SEQ.CNT", CNT, 0x7fff),
    read_write("SEQ.REFRESH", 0x528, 0xff_ffff).reset(1),
    read_write("SEQ.ENDDELAY", 0x52c, 0),
    read_write("PSEL.OUT", PSEL, !0).times(4).reset(!0),
];

#[derive(Debug)]
pub struct Pwm {
    registers: Registers,
    /// Tick at which the period began, while there is one.
    began: Option<u64>,
    value: u16,
    /// Value of the next period.
    following: u16,
    stops: bool,
    now: u64,
}

impl Pwm {
    pub fn new() -> Self {
        Self {
            registers: Registers::new("PWM0", 0x4001_c000, TABLE),
            began: None,
            value: 0,
            following: 0,
            stops: false,
            now: 0,
        }
    }

    /// Pin of the channel, while the peripheral is enabled.
    pub fn pin(&self) -> Option<u32> {
        let pin = self.registers.get(PSEL);
        (self.registers.get(ENABLE) == 1 && pin & DISCONNECTED == 0).then_some(pin & 0x3f)
    }

    /// Returns the level that it drives a pin to, if it does. Between its pulses' periods the port does.
    pub fn drives(&self, pin: u32) -> Option<bool> {
        let began = self.began.filter(|_| self.pin() == Some(pin))?;
        let is_first = self.now - began < self.edge();
        Some(is_first == (self.value & FALLS != 0))
    }

    /// Ticks of the core's clock in one count: 16 MHz, divided.
    fn count(&self) -> u64 {
        4 << self.registers.get(PRESCALER)
    }

    fn period(&self) -> u64 {
        u64::from(self.registers.get(TOP)) * self.count()
    }

    /// Ticks from the period's beginning to the edge in it.
    fn edge(&self) -> u64 {
        (u64::from(self.value & !FALLS) * self.count()).min(self.period())
    }

    /// Ticks for which the pin is high in the period that is running.
    pub fn high(&self) -> Option<u64> {
        self.began?;
        let falls = self.value & FALLS != 0;
        Some(if falls {
            self.edge()
        } else {
            self.period() - self.edge()
        })
    }

    fn begin(&mut self, bus: &Bus) {
        self.began = Some(bus.now);
        self.value = self.following;
        self.now = bus.now;
    }
}

impl Peripheral for Pwm {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn stored(&mut self, offset: u32, bus: &mut Bus) {
        let value = self.registers.get(offset);
        let wrong = match offset {
            ENABLE | TOP | PRESCALER if self.began.is_some() => Some("no pulses may be running"),
            TOP if value < 3 => Some("3 at least"),
            CNT if value != 1 => Some("1: longer sequences are not modelled"),
            // The first alone.
            _ if offset > PSEL && value & DISCONNECTED == 0 => {
                Some("other channels are not modelled")
            }
            _ => None,
        };
        if let Some(expected) = wrong {
            self.unexpected(offset, bus, expected);
        }
    }

    fn task(&mut self, offset: u32, bus: &mut Bus) {
        let address = self.registers.get(PTR);
        let when = match offset {
            STOP => {
                self.stops |= self.began.is_some();
                return;
            }
            _ if self.registers.get(ENABLE) == 0 => Some("while it is disabled"),
            _ if self.registers.get(CNT) == 0 => Some("without a value"),
            // What it does then is not specified.
            _ if self.stops => Some("while it is stopping"),
            _ => None,
        };
        if let Some(when) = when {
            return self.untimely(offset, bus, when);
        }
        let half = bus
            .memory
            .half(address)
            .filter(|_| bus.memory.is_ram(address, 2));
        let Some(value) = half else {
            return self.refuse(PTR, bus, What::NoDma { address, length: 2 });
        };
        self.following = value;
        self.raise(STARTED, bus);
        self.raise(SEQUENCE_END, bus);
        if self.began.is_none() {
            self.begin(bus);
        }
    }

    fn next(&self) -> Option<u64> {
        let began = self.began?;
        let edges = [began + self.edge(), began + self.period()];
        edges.into_iter().find(|at| *at > self.now)
    }

    fn due(&mut self, bus: &mut Bus) {
        self.now = bus.now;
        let is_over = self
            .began
            .is_some_and(|began| began + self.period() <= bus.now);
        if !is_over {
            return;
        }
        self.raise(PERIOD_END, bus);
        if std::mem::take(&mut self.stops) {
            self.began = None;
            self.raise(STOPPED, bus);
        } else {
            self.begin(bus);
        }
    }
}
