//! EGU, interrupts that software triggers (product specification, 6.8).

use super::bus::{Bus, Peripheral};
use super::register::{INTEN, Register, Registers, clear, event, read_write, set, task};

const TRIGGERED: u32 = 0x100;
const CHANNELS: u32 = 16;

const TABLE: &[Register] = &[
    task("TASKS_TRIGGER", 0x000).times(CHANNELS),
    event("EVENTS_TRIGGERED", TRIGGERED).times(CHANNELS),
    read_write("INTEN", INTEN, 0xffff),
    set("INTENSET", 0x304, INTEN, 0xffff),
    clear("INTENCLR", 0x308, INTEN, 0xffff),
];

#[derive(Debug)]
pub struct Egu {
    registers: Registers,
}

impl Egu {
    pub fn new(name: &'static str, base: u32) -> Self {
        Self {
            registers: Registers::new(name, base, TABLE),
        }
    }
}

impl Peripheral for Egu {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn task(&mut self, offset: u32, bus: &mut Bus) {
        self.raise(TRIGGERED + offset, bus);
    }
}
