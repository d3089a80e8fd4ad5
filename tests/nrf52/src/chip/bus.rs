//! State that peripherals share: time, memory, events on their way, and what they ask of the core.

use std::collections::VecDeque;

use super::clock_and_power::LFXO;
use super::register::Registers;
use crate::memory::Memory;
use crate::refusal::What;

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Reset {
    Power,
    Pin,
    Watchdog,
    /// The program asked for it, by the core's AIRCR.
    Software,
}

/// State that peripherals share.
#[derive(Debug)]
pub struct Bus {
    /// Ticks since power came.
    pub now: u64,
    pub memory: Memory,
    /// Addresses of events that have happened and not yet reached the interconnect.
    pub events: VecDeque<u32>,
    /// Ticks that the core is to be halted.
    pub halt: u64,
    pub reset: Option<Reset>,
    /// First refusal: the address, and what is wrong.
    pub refused: Option<(u32, What)>,
    pub low_frequency_runs: bool,
    pub crystal_runs: bool,
    /// Thousandths by which the high-frequency clock is fast while its crystal does not run. A test sets it; HFINT is off by
    /// 20 at most (5.4.7).
    pub inaccuracy: i64,
    /// Ticks that the crystal of the low-frequency clock takes to start; `None` if there is none. A test sets it.
    pub slow_crystal: Option<u64>,
    /// True if the watchdog runs, and with it the RC oscillator of the low-frequency clock.
    pub watchdog_runs: bool,
    /// Parts of the board around the chip.
    pub board: Surroundings,
    /// True if something has changed that the core has to know.
    pub attention: bool,
}

/// Parts of a board around the chip, as far as the program has to know.
#[derive(Clone, Copy, Default, Debug)]
pub struct Surroundings {
    /// True if the supply is at VDDH, so that levels of pins are what UICR.REGOUT0 says.
    pub is_high_voltage: bool,
    /// Inductors of the DC/DC converters: of the core's supply, and of VDDH.
    pub inductors: [bool; 2],
}

impl Bus {
    /// Creates the state at the moment that power comes.
    pub fn new(memory: Memory) -> Self {
        Self {
            now: 0,
            memory,
            events: VecDeque::new(),
            halt: 0,
            reset: None,
            refused: None,
            low_frequency_runs: false,
            crystal_runs: false,
            inaccuracy: 0,
            slow_crystal: Some(LFXO),
            watchdog_runs: false,
            board: Surroundings::default(),
            attention: true,
        }
    }

    /// Returns the state after a reset, which leaves time, memory and what a test has set.
    pub fn after_reset(&self) -> Self {
        Self {
            now: self.now,
            refused: self.refused.clone(),
            inaccuracy: self.inaccuracy,
            slow_crystal: self.slow_crystal,
            board: self.board,
            ..Self::new(self.memory.clone())
        }
    }

    /// Refuses something. The first refusal ends the run.
    pub fn refuse(&mut self, address: u32, what: What) {
        self.attention = true;
        self.refused.get_or_insert((address, what));
    }

    pub fn reset(&mut self, why: Reset) {
        self.attention = true;
        self.reset.get_or_insert(why);
    }

    /// Thousandths by which the high-frequency clock is fast now.
    pub const fn fast(&self) -> i64 {
        if self.crystal_runs {
            0
        } else {
            self.inaccuracy
        }
    }

    pub fn halt(&mut self, ticks: u64) {
        self.attention = true;
        self.halt += ticks;
    }
}

/// A part of the chip with registers of its own. `new` gives its state after a reset.
pub trait Peripheral: std::fmt::Debug + Send {
    fn registers(&mut self) -> &mut Registers;

    /// Returns the value that the program reads, where that is not what the register holds.
    fn computed(&mut self, _offset: u32, _bus: &mut Bus) -> Option<u32> {
        None
    }

    /// The register at this offset was written.
    fn stored(&mut self, _offset: u32, _bus: &mut Bus) {}

    fn task(&mut self, _offset: u32, _bus: &mut Bus) {}

    /// Tasks that this event starts by a shortcut.
    fn shorts(&self, _event: u32) -> Vec<u32> {
        Vec::new()
    }

    /// Returns the tick at which it does something by itself next, if it does.
    fn next(&self) -> Option<u64> {
        None
    }

    /// It is that time.
    fn due(&mut self, _bus: &mut Bus) {}

    fn raise(&mut self, event: u32, bus: &mut Bus) {
        let registers = self.registers();
        registers.put(event, 1);
        bus.events.push_back(registers.base + event);
        bus.attention = true;
    }

    /// Refuses what was done to one of its registers.
    fn refuse(&mut self, offset: u32, bus: &mut Bus, what: What) {
        bus.refuse(self.registers().base + offset, what);
    }

    /// Refuses a task or a write at this time.
    fn untimely(&mut self, offset: u32, bus: &mut Bus, when: &'static str) {
        self.refuse(offset, bus, What::Untimely { when });
    }

    /// Refuses the value that a register was given.
    fn unexpected(&mut self, offset: u32, bus: &mut Bus, expected: &'static str) {
        let value = self.registers().get(offset);
        self.refuse(offset, bus, What::Value { value, expected });
    }
}

/// Registers that hold what is written, and do nothing.
impl Peripheral for Registers {
    fn registers(&mut self) -> &mut Registers {
        self
    }
}
