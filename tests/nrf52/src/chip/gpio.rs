//! GPIO, the pins of a port (product specification, 6.9): direction, level, pull and drive. Sensing is kept and does nothing.

use super::bus::{Bus, Peripheral};
use super::register::{Registers, registers};

/// Bytes from one port's registers to the next port's.
pub const PORT: u32 = 0x300;
/// PIN_CNF after a reset: an input whose buffer is disconnected.
const DISCONNECTED: u32 = 1 << 1;
const PIN_CNF_MASK: u32 = 0xf | 7 << 8 | 3 << 16;

registers![
    OUT = read_write(0x504, !0),
    OUTSET = set(0x508, OUT, !0),
    OUTCLR = clear(0x50c, OUT, !0),
    IN = read_only(0x510),
    DIR = read_write(0x514, !0),
    DIRSET = set(0x518, DIR, !0),
    DIRCLR = clear(0x51c, DIR, !0),
    LATCH = one_clears(0x520, !0),
    DETECTMODE = read_write(0x524, 1),
    PIN_CNF = read_write(0x700, PIN_CNF_MASK)
        .times(32)
        .reset(DISCONNECTED),
];

#[derive(Default, Debug)]
pub struct Gpio {
    registers: Registers,
    /// Levels that something outside drives: a mask, and the levels.
    outside: (u32, u32),
    /// Levels on the pins, where something drives or pulls them.
    levels: [Option<bool>; 32],
}

impl Gpio {
    pub fn new(name: &'static str, number: u32) -> Self {
        Self {
            registers: Registers::new(name, 0x5000_0000 + number * PORT, TABLE),
            ..Self::default()
        }
    }

    /// Drives a pin from outside, or lets it go.
    pub fn drive(&mut self, pin: u32, level: Option<bool>) {
        let bit = 1 << pin;
        let (mask, levels) = self.outside;
        self.outside = match level {
            Some(true) => (mask | bit, levels | bit),
            Some(false) => (mask | bit, levels & !bit),
            None => (mask & !bit, levels & !bit),
        };
    }

    /// Returns the port after a reset, which leaves what is driven from outside.
    pub fn after_reset(&self) -> Self {
        let Registers { name, base, .. } = self.registers;
        Self {
            registers: Registers::new(name, base, TABLE),
            outside: self.outside,
            ..Self::default()
        }
    }

    /// The level of a pin; none where nothing drives nor pulls it: it floats.
    pub fn level(&self, pin: u32) -> Option<bool> {
        self.levels[pin as usize]
    }

    pub fn is_output(&self, pin: u32) -> bool {
        self.registers.get(DIR) >> pin & 1 == 1
    }

    pub fn is_input(&self, pin: u32) -> bool {
        self.registers.get(PIN_CNF + 4 * pin) & 3 == 0
    }

    /// Returns true if a pin can be read, or is driven or pulled.
    pub fn is_used(&self, pin: u32) -> bool {
        self.registers.get(PIN_CNF + 4 * pin) & 0xf != DISCONNECTED
    }

    /// Sets every pin's level; `taken` says what a peripheral drives it to.
    pub fn settle(&mut self, taken: impl Fn(u32) -> Option<bool>) {
        for pin in 0..32 {
            let is_output = self.is_output(pin);
            let (driven, levels) = self.outside;
            let pull = self.registers.get(PIN_CNF + 4 * pin) >> 2 & 3;
            let level = if let Some(level) = taken(pin) {
                Some(level)
            } else if is_output {
                Some(self.registers.get(OUT) >> pin & 1 == 1)
            } else if driven >> pin & 1 == 1 {
                Some(levels >> pin & 1 == 1)
            } else {
                match pull {
                    1 => Some(false),
                    3 => Some(true),
                    _ => None,
                }
            };
            self.levels[pin as usize] = level;
        }
    }
}

impl Peripheral for Gpio {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn computed(&mut self, offset: u32, _: &mut Bus) -> Option<u32> {
        if offset != IN {
            return None;
        }
        let reads = |pin: &u32| {
            let is_connected = self.registers.get(PIN_CNF + 4 * pin) & DISCONNECTED == 0;
            is_connected && self.levels[*pin as usize] == Some(true)
        };
        Some((0..32).filter(reads).map(|pin| 1 << pin).sum())
    }

    /// DIR and the lowest bit of PIN_CNF are one register (6.9.2).
    fn stored(&mut self, offset: u32, _: &mut Bus) {
        if offset == DIR {
            for pin in 0..32 {
                let configuration = self.registers.get(PIN_CNF + 4 * pin) & !1;
                let direction = self.registers.get(DIR) >> pin & 1;
                self.registers
                    .put(PIN_CNF + 4 * pin, configuration | direction);
            }
        } else if let Some(distance) = offset.checked_sub(PIN_CNF) {
            let pin = distance / 4;
            let direction = self.registers.get(offset) & 1;
            let others = self.registers.get(DIR) & !(1 << pin);
            self.registers.put(DIR, others | direction << pin);
        }
    }
}
