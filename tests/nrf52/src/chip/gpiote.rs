//! GPIOTE (product specification, 6.10): tasks that set and clear pins. Their task for what CONFIG says and events of pins are not modelled.

use super::bus::{Bus, Peripheral};
use super::register::{INTEN, Registers, registers};

pub const CHANNELS: u32 = 8;
const INTERRUPTS: u32 = 0xff | 1 << 31;

registers![
    TASKS_SET = task(0x030).times(CHANNELS),
    TASKS_CLR = task(0x060).times(CHANNELS),
    EVENTS_IN = event(0x100).times(CHANNELS),
    EVENTS_PORT = event(0x17c),
    INTENSET = set(0x304, INTEN, INTERRUPTS),
    INTENCLR = clear(0x308, INTEN, INTERRUPTS),
    CONFIG = read_write(0x510, 3 | 0x3f << 8 | 3 << 16 | 1 << 20).times(CHANNELS),
];

/// Modes of a channel (6.10.4).
const DISABLED: u32 = 0;
const TASK: u32 = 3;

#[derive(Debug)]
pub struct Gpiote {
    registers: Registers,
    levels: [bool; CHANNELS as usize],
}

impl Gpiote {
    pub fn new() -> Self {
        Self {
            registers: Registers::new("GPIOTE", 0x4000_6000, TABLE),
            levels: [false; CHANNELS as usize],
        }
    }

    /// Returns the level that a channel drives a pin to, if any. Pins of the second port follow those of the first.
    pub fn drives(&self, pin: u32) -> Option<bool> {
        let channel = self.of_pin(pin).next()?;
        Some(self.levels[channel as usize])
    }

    pub fn channels(&self, pin: u32) -> usize {
        self.of_pin(pin).count()
    }

    fn of_pin(&self, pin: u32) -> impl Iterator<Item = u32> {
        (0..CHANNELS).filter(move |channel| {
            let config = self.registers.get(CONFIG + 4 * channel);
            config & 3 == TASK && config >> 8 & 0x3f == pin
        })
    }
}

impl Peripheral for Gpiote {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn stored(&mut self, offset: u32, bus: &mut Bus) {
        let Some(channel) = offset.checked_sub(CONFIG).map(|distance| distance / 4) else {
            return;
        };
        let value = self.registers.get(offset);
        match value & 3 {
            // The level to begin with is set when the channel is configured.
            TASK => self.levels[channel as usize] = value >> 20 & 1 == 1,
            DISABLED => {}
            _ => {
                self.unexpected(offset, bus, "events of pins are not modelled");
            }
        }
    }

    fn task(&mut self, offset: u32, bus: &mut Bus) {
        let channel = (offset % TASKS_SET) / 4;
        let config = self.registers.get(CONFIG + 4 * channel);
        if config & 3 != TASK {
            return self.untimely(offset, bus, "while its channel is not in task mode");
        }
        self.levels[channel as usize] = offset < TASKS_CLR;
    }
}
