//! PWM0 (product specification, 6.17): one value for one channel, in a counter that counts up. Loops, longer sequences, shortcuts
//! and the other channels are not modelled.

use super::bus::{Bus, Peripheral};
use super::register::{INTEN, Registers, registers};
use crate::refusal::What;

const INTERRUPTS: u32 = 0xfe;
const DISCONNECTED: u32 = 1 << 31;
/// Bit of a value: the pin is high first, and falls at the value.
const FALLS: u16 = 1 << 15;

registers![
    TASKS_STOP = task(0x004),
    TASKS_SEQSTART = task(0x008),
    EVENTS_STOPPED = event(0x104),
    EVENTS_SEQSTARTED = event(0x108).times(2),
    EVENTS_SEQEND = event(0x110).times(2),
    EVENTS_PWMPERIODEND = event(0x118),
    EVENTS_LOOPSDONE = event(0x11c),
    SHORTS = read_write(0x200, 0),
    INTENSET = set(0x304, INTEN, INTERRUPTS),
    INTENCLR = clear(0x308, INTEN, !0),
    ENABLE = read_write(0x500, 1),
    MODE = read_write(0x504, 0),
    COUNTERTOP = read_write(0x508, 0x7fff).reset(0x3ff),
    PRESCALER = read_write(0x50c, 7),
    DECODER = read_write(0x510, 0),
    LOOP = read_write(0x514, 0),
    SEQ_PTR = read_write(0x520, !0),
    SEQ_CNT = read_write(0x524, 0x7fff),
    SEQ_REFRESH = read_write(0x528, 0xff_ffff).reset(1),
    SEQ_ENDDELAY = read_write(0x52c, 0),
    PSEL_OUT = read_write(0x560, !0).times(4).reset(!0),
];

#[derive(Default, Debug)]
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
            ..Self::default()
        }
    }

    /// Pin of the channel, while the peripheral is enabled.
    pub fn pin(&self) -> Option<u32> {
        let pin = self.registers.get(PSEL_OUT);
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
        u64::from(self.registers.get(COUNTERTOP)) * self.count()
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
            ENABLE | COUNTERTOP | PRESCALER if self.began.is_some() => {
                Some("no pulses may be running")
            }
            COUNTERTOP if value < 3 => Some("3 at least"),
            SEQ_CNT if value != 1 => Some("1: longer sequences are not modelled"),
            // The first alone.
            _ if offset > PSEL_OUT && value & DISCONNECTED == 0 => {
                Some("other channels are not modelled")
            }
            _ => None,
        };
        if let Some(expected) = wrong {
            self.unexpected(offset, bus, expected);
        }
    }

    fn task(&mut self, offset: u32, bus: &mut Bus) {
        let address = self.registers.get(SEQ_PTR);
        let when = match offset {
            TASKS_STOP => {
                self.stops |= self.began.is_some();
                return;
            }
            _ if self.registers.get(ENABLE) == 0 => Some("while it is disabled"),
            _ if self.registers.get(SEQ_CNT) == 0 => Some("without a value"),
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
            return self.refuse(SEQ_PTR, bus, What::NoDma { address, length: 2 });
        };
        self.following = value;
        self.raise(EVENTS_SEQSTARTED, bus);
        self.raise(EVENTS_SEQEND, bus);
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
        self.raise(EVENTS_PWMPERIODEND, bus);
        if std::mem::take(&mut self.stops) {
            self.began = None;
            self.raise(EVENTS_STOPPED, bus);
        } else {
            self.begin(bus);
        }
    }
}
