//! The core, a Cortex-M4F: rsemu's, with interrupts held back within IT blocks.
//!
//! rsemu 0.0.7 saves xPSR without the state of an IT block when it takes an exception (`exec.rs`, `exception_entry`), so
//! that the rest of the block runs unconditionally after the return. A real core saves it (ARMv7-M Architecture Reference
//! Manual, B1.5.6). Interrupts may come at any instruction, so one that waits for the end of a block, four instructions at
//! most, is within what a real core does. `tests/nrf52/core.rs` shows the fault and that it is avoided.

use std::sync::Arc;

use rsemu::core::space::AddressSpace;
use rsemu::cpu::arm::v7m::sys::Exception;
use rsemu::cpu::arm::v7m::{ArmV7m, Config};

/// Interrupts of the chip.
pub const INTERRUPTS: u16 = 48;

/// The bits of xPSR that say how far an IT block is.
const IT: u32 = 0x3f << 10 | 3 << 25;
/// The exception of a supervisor call, and a hard fault's.
const HARD_FAULT: u16 = 3;

#[derive(Debug)]
pub struct Core {
    cpu: ArmV7m,
    holds_interrupts_back: bool,
    /// True if the last hard fault began in an IT block.
    was_in_it_block: bool,
}

impl Core {
    /// Creates the core at a reset. It reads its stack pointer and where it starts from the words at address 0.
    pub fn new(space: Arc<AddressSpace>) -> Self {
        // nRF52 chips have no bit bands (product specification, 4.1).
        let cpu = ArmV7m::new(Config::CORTEX_M4F.with_bit_band(false));
        cpu.attach_space(space);
        Self {
            cpu,
            holds_interrupts_back: true,
            was_in_it_block: false,
        }
    }

    /// Returns the core as the library has it, with its fault.
    pub fn as_released(self) -> Self {
        Self {
            holds_interrupts_back: false,
            ..self
        }
    }

    /// Runs an instruction, or takes an exception; returns the cycles that it took.
    pub fn step(&mut self) -> u64 {
        if self.cpu.xpsr() & IT == 0 || !self.holds_interrupts_back {
            return self.cpu.step();
        }
        let mut registers = self.cpu.regs();
        if registers.primask {
            return self.cpu.step();
        }
        registers.primask = true;
        self.cpu.set_regs(registers);
        let cycles = self.cpu.step();
        let mut registers = self.cpu.regs();
        registers.primask = false;
        self.cpu.set_regs(registers);
        // Held back, a supervisor call becomes a hard fault.
        self.was_in_it_block = self.is_in_hard_fault();
        cycles
    }

    /// Returns true if the hard fault that it handles began in an IT block.
    pub fn was_in_it_block(&self) -> bool {
        self.was_in_it_block && self.is_in_hard_fault()
    }

    /// Returns the status of faults (CFSR). It is 0 for a fault that was escalated.
    pub fn fault_status(&self) -> u32 {
        const CFSR: u32 = 0xe000_ed28;
        let status = self.cpu.with_sys(|system| system.read_word(CFSR, true));
        status.unwrap_or_default()
    }

    pub fn register(&self, number: u8) -> u32 {
        self.cpu.reg(number)
    }

    pub fn set_register(&mut self, number: u8, value: u32) {
        self.cpu.set_reg(number, value);
    }

    pub fn enable(&mut self, interrupt: u16) {
        const ISER: u32 = 0xe000_e100;
        let address = ISER + u32::from(interrupt / 32) * 4;
        self.cpu
            .with_sys(|system| system.write_word(address, 1 << (interrupt % 32)));
    }

    pub fn disable(&mut self, interrupt: u16) {
        const ICER: u32 = 0xe000_e180;
        let address = ICER + u32::from(interrupt / 32) * 4;
        self.cpu
            .with_sys(|system| system.write_word(address, 1 << (interrupt % 32)));
    }

    pub fn stack_pointer(&self) -> u32 {
        self.cpu.msp()
    }

    /// Returns the address at which it is.
    pub fn place(&self) -> u32 {
        self.cpu.pc()
    }

    /// Lets it go on elsewhere.
    pub fn jump(&mut self, address: u32) {
        self.cpu.set_pc(address);
    }

    /// Returns true if it sleeps until an interrupt.
    pub fn sleeps(&self) -> bool {
        self.cpu.is_asleep()
    }

    /// Returns true if a fault in a fault has stopped it.
    pub fn is_locked_up(&self) -> bool {
        self.cpu.is_locked_up()
    }

    /// Returns true if the program asked for a reset, by AIRCR.
    pub fn asks_for_reset(&self) -> bool {
        self.cpu.reset_requested()
    }

    pub fn is_in_handler(&self) -> bool {
        self.cpu.regs().in_handler()
    }

    pub fn is_in_hard_fault(&self) -> bool {
        self.cpu.current_exception() == Exception(HARD_FAULT)
    }

    pub fn set_interrupts(&mut self, levels: u64) {
        for number in 0..INTERRUPTS {
            self.cpu.set_irq(number, levels >> number & 1 == 1);
        }
    }

    pub fn pend(&mut self, interrupt: u16) {
        self.cpu.pend_irq(interrupt);
    }

    /// The priority of an interrupt, if it is enabled: 0 to 7, three bits (product specification, 4.1).
    pub fn priority(&self, interrupt: u16) -> Option<u8> {
        let exception = Exception(interrupt + 16);
        self.cpu.with_sys(|system| {
            let priority = system.priority_of(exception) >> 5;
            system.is_enabled(exception).then_some(priority as u8)
        })
    }

    pub fn set_priority(&mut self, interrupt: u16, priority: u8) {
        const IPR: u32 = 0xe000_e400;
        let address = IPR + u32::from(interrupt / 4) * 4;
        let place = 8 * (interrupt % 4) + 5;
        self.cpu.with_sys(|system| {
            let others = system.read_word(address, true).unwrap_or_default() & !(7 << place);
            system.write_word(address, others | u32::from(priority) << place);
        });
    }

    pub fn set_call_priority(&mut self, priority: u8) {
        const SHPR2: u32 = 0xe000_ed1c;
        self.cpu
            .with_sys(|system| system.write_word(SHPR2, u32::from(priority) << 29));
    }
}
