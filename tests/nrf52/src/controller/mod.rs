//! Nordic's controller library and MPSL, its scheduler, as the program sees them: their documented functions, with the
//! [`air`](crate::air) on the other side.
//!
//! The libraries' instructions never run. The image is the one that is flashed, libraries included. When the program calls a
//! function of theirs, the emulation answers in its place; another instruction among theirs is refused. What a function
//! takes, answers and refuses is in the headers that come with the library's bindings (mpsl.h, mpsl_clock.h,
//! mpsl_timeslot.h, sdc.h, sdc_soc.h, sdc_hci.h) and in the Bluetooth Core Specification (volume 4, part E).

mod acl;
mod commands;
mod hci;
mod library;
mod memory;
mod mpsl;
mod sdc;
mod timeslot;

use std::collections::VecDeque;
use std::ops::Range;

use crate::address_space::RETURN;
use crate::air::Air;
use crate::chip::Chip;
use crate::core::{Core, INTERRUPTS};
use crate::memory::{Memory, give, take};
use crate::refusal::{What, needs, wrong};
use hci::Hci;
pub use library::Library;
use mpsl::Mpsl;
use sdc::Sdc;
use timeslot::Timeslot;

/// Answers (`nrf_errno.h`).
mod answer {
    pub const SUCCESS: i32 = 0;
    pub const AGAIN: i32 = -35;
}

/// The interrupts of RADIO, TIMER0 and RTC0, which have priority 0 and are the library's.
const HIGH: [u16; 3] = [1, 8, 11];
const TIMER0: u16 = 8;
/// The interrupt of CLOCK and POWER.
const CLOCK: u16 = 0;

/// A function of the program that the library calls.
#[derive(Clone, Copy, Debug)]
struct Callback {
    function: u32,
    arguments: [u32; 2],
}

/// A call of the program's that the library has not answered yet: where it returns to, and what it waits for.
#[derive(Clone, Copy, Debug)]
enum Frame {
    /// `mpsl_low_priority_process`: callbacks, one after the other.
    Low(u32),
    /// The interrupt of TIMER0: the start of a time slot.
    Start(u32),
}

#[derive(Default, Debug)]
pub struct Controller {
    library: Library,
    frames: Vec<Frame>,
    /// Callbacks that wait for `mpsl_low_priority_process`.
    callbacks: VecDeque<Callback>,
    mpsl: Mpsl,
    sdc: Sdc,
    hci: Hci,
    /// Time slots, in which flash is written.
    pub timeslot: Timeslot,
    /// Interrupts that are to become pending.
    interrupts: Vec<u16>,
    /// Bytes that it needs beyond those of its macros: for tests.
    pub more_bytes: u32,
    /// The radio, and the armbands.
    pub air: Air,
}

impl Controller {
    /// Creates the controller of an image with this library.
    pub fn new(library: Library) -> Self {
        Self {
            library,
            ..Self::default()
        }
    }

    pub fn reset(&mut self, now: u64) {
        self.air.reset(now);
        self.timeslot.reset();
        *self = Self {
            air: std::mem::take(&mut self.air),
            timeslot: std::mem::take(&mut self.timeslot),
            more_bytes: self.more_bytes,
            ..Self::new(std::mem::take(&mut self.library))
        };
    }

    pub fn take_interrupts(&mut self) -> Vec<u16> {
        std::mem::take(&mut self.interrupts)
    }

    pub const fn library(&self) -> &Library {
        &self.library
    }

    /// Returns the addresses of the memory that the program has given it, once it is enabled.
    pub fn memory(&self) -> Option<Range<u32>> {
        let memory = self.sdc.memory.as_ref();
        memory.map(|(at, bytes)| *at..*at + bytes.len() as u32)
    }

    /// Returns true if an address is among the library's instructions.
    pub fn holds(&self, address: u32) -> bool {
        self.library.range.contains(&address)
    }

    /// Returns the tick at which something happens by itself next, if something does.
    pub fn next(&self) -> Option<u64> {
        let radio = self.air.next().filter(|_| !self.timeslot.is_granted());
        let all = [radio, self.timeslot.next(), self.mpsl.next()];
        all.into_iter().flatten().min()
    }

    pub fn advance(&mut self, chip: &mut Chip) {
        let now = chip.bus.now;
        if let Some(callback) = self.mpsl.crystal_callback(now) {
            self.call_later(callback, [0, 0]);
        }
        self.advance_timeslot(chip);
        // In a time slot the radio is the program's.
        if !self.timeslot.is_granted() {
            self.air.advance(now);
        }
        while let Some(event) = self.air.take() {
            self.tell(event);
        }
        chip.bus.attention |= !self.interrupts.is_empty();
    }

    /// Answers the program at an instruction of the library's, or calls it back.
    pub fn enter(&mut self, chip: &mut Chip, core: &mut Core) -> Result<(), (String, What)> {
        let place = core.place();
        if place == self.library.gate() {
            let outcome = self.returned(chip, core);
            return outcome.map_err(|what| ("a callback of the library's".to_owned(), what));
        }
        let Some(name) = self.library.functions.get(&place).cloned() else {
            return Err((format!("{place:#010x}"), What::LibraryCode));
        };
        let outcome = self.call(&name, chip, core);
        outcome.map_err(|what| (name, what))
    }

    fn call(&mut self, name: &str, chip: &mut Chip, core: &mut Core) -> Result<(), What> {
        let link = core.register(14);
        match name {
            "MPSL_IRQ_TIMER0_Handler" => {
                if let Some(callback) = self.timeslot.begin() {
                    self.frames.push(Frame::Start(link));
                    self.call_back(callback, core);
                    return Ok(());
                }
            }
            "MPSL_IRQ_CLOCK_Handler" | "MPSL_IRQ_RADIO_Handler" | "MPSL_IRQ_RTC0_Handler" => {}
            "mpsl_low_priority_process" => {
                check_low(core)?;
                self.check_memory(&chip.bus.memory)?;
                self.frames.push(Frame::Low(link));
                self.go_on(link, core);
                return Ok(());
            }
            _ => {
                check_low(core)?;
                let arguments = [0, 1, 2, 3].map(|number| core.register(number));
                let value = self.answer(name, arguments, chip, core)?;
                core.set_register(0, value);
            }
        }
        return_to(link, core);
        Ok(())
    }

    fn answer(
        &mut self,
        name: &str,
        arguments: [u32; 4],
        chip: &mut Chip,
        core: &mut Core,
    ) -> Result<u32, What> {
        if let Some(command) = name.strip_prefix("sdc_hci_cmd_") {
            needs(self.sdc.is_enabled(), "before sdc_enable")?;
            check_priorities(core)?;
            let status = self.command(command, arguments, chip)?;
            return Ok(status.into());
        }
        let value = match name {
            "mpsl_init" => self.init(arguments, chip, core)?,
            _ if !self.mpsl.is_initialized() => return Err(wrong("before mpsl_init")),
            "mpsl_clock_hfclk_src_request" => self.request_crystal(arguments, chip)?,
            "mpsl_timeslot_session_count_set" => self.set_sessions(arguments, &chip.bus.memory)?,
            "mpsl_timeslot_session_open" => self.open_session(arguments, &chip.bus.memory)?,
            "mpsl_timeslot_session_close" => self.close_session(arguments),
            "mpsl_timeslot_request" => self.request_slot(arguments, chip)?,
            "sdc_hci_get" => self.give_message(arguments, &chip.bus.memory)?,
            "sdc_hci_data_put" => self.put_data(arguments, &chip.bus.memory)?,
            name if name.starts_with("sdc_") => self.configure(name, arguments, chip, core)?,
            _ => return Err(What::UnknownCall { arguments }),
        };
        Ok(value.cast_unsigned())
    }

    /// A function of the program that the library has called returns.
    fn returned(&mut self, chip: &mut Chip, core: &mut Core) -> Result<(), What> {
        match self.frames.last() {
            None => Err(What::LibraryCode),
            Some(Frame::Low(link)) => {
                self.go_on(*link, core);
                Ok(())
            }
            Some(Frame::Start(link)) => {
                let link = *link;
                self.frames.pop();
                self.end_of_start(core.register(0), chip)?;
                return_to(link, core);
                Ok(())
            }
        }
    }

    /// Calls the next callback that waits for low priority, or returns from there.
    fn go_on(&mut self, link: u32, core: &mut Core) {
        match self.callbacks.pop_front() {
            Some(callback) => self.call_back(callback, core),
            None => {
                self.frames.pop();
                return_to(link, core);
            }
        }
    }

    fn call_back(&self, callback: Callback, core: &mut Core) {
        for (number, value) in (0..).zip(callback.arguments) {
            core.set_register(number, value);
        }
        core.set_register(14, self.library.gate() | 1);
        core.jump(callback.function & !1);
    }

    /// Calls a function of the program from `mpsl_low_priority_process`, and asks for that.
    fn call_later(&mut self, function: u32, arguments: [u32; 2]) {
        self.callbacks.push_back(Callback {
            function,
            arguments,
        });
        self.interrupts.push(self.mpsl.low_interrupt());
    }

    /// Refuses what the program has written to the library's memory.
    fn check_memory(&self, memory: &Memory) -> Result<(), What> {
        let all = self.sdc.memory.iter().chain(&self.timeslot.memory);
        for (at, bytes) in all {
            let is_whole = memory.read(*at, bytes.len() as u32).as_ref() == Some(bytes);
            needs(
                is_whole,
                &format!("after its memory at {at:#x} was written"),
            )?;
        }
        Ok(())
    }
}

/// Refuses a call from an interrupt: those that are not for interrupts may not interrupt each other (MPSL's documentation,
/// "Thread safety").
fn check_low(core: &Core) -> Result<(), What> {
    needs(!core.is_in_handler(), "from an interrupt")
}

/// Returns from a function of the library's, by an instruction: to return from an interrupt takes one.
fn return_to(link: u32, core: &mut Core) {
    core.set_register(14, link);
    core.jump(RETURN);
}

/// Refuses enabled interrupts of the program's with the library's priority, and the library's with another one.
fn check_priorities(core: &Core) -> Result<(), What> {
    for interrupt in 0..INTERRUPTS {
        let Some(priority) = core.priority(interrupt) else {
            continue;
        };
        if (priority == 0) != HIGH.contains(&interrupt) {
            return Err(What::Priority {
                interrupt,
                priority,
            });
        }
    }
    Ok(())
}

/// Memory that is the library's from now on: filled, so that a write shows.
fn own(memory: &Memory, address: u32, length: u32) -> Result<(u32, Vec<u8>), What> {
    let bytes = vec![0xa5; length as usize];
    give(memory, address, &bytes)?;
    Ok((address, bytes))
}
