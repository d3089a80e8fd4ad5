//! The whole: core, chip, SoftDevice and armbands, in virtual time.

use std::ops::Range;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard};

use rsemu::core::space::AddressSpace;

use crate::address_space::{Shared, address_space, lock};
use crate::air::Air;
use crate::chip::{Chip, ChipModel, Reset};
use crate::controller::Controller;
use crate::core::Core;
use crate::image::Image;
use crate::refusal::{Refusal, What};
use crate::softdevice::{EVENTS, SoftDevice, boot};
use crate::time::HZ;

/// The upper byte of a supervisor call's instruction.
const CALL: u16 = 0xdf;

/// Something that the program did, besides its work.
#[derive(Clone, Debug)]
pub enum Incident {
    /// It started, for this reason.
    Started(Reset),
    HardFault(String),
}

#[derive(Debug)]
pub struct Machine {
    core: Core,
    space: Arc<AddressSpace>,
    chip: Arc<Mutex<Chip>>,
    shared: Arc<Shared>,
    image: Image,
    now: u64,
    interrupts: u64,
    /// RAM that a boot loader uses after every reset, before the program starts. None without one.
    pub boot_loader_ram: Option<Range<u32>>,
    /// The SoftDevice, where the image needs one.
    pub softdevice: Option<SoftDevice>,
    /// Nordic's controller library, where the image has it.
    pub controller: Option<Controller>,
    /// Incidents, each with the tick at which it happened.
    pub incidents: Vec<(u64, Incident)>,
}

impl Machine {
    /// A chip with this image, as it was flashed, at the moment that power comes. RAM holds what `garbage` gives.
    pub fn new(
        model: ChipModel,
        image: Image,
        softdevice: Option<SoftDevice>,
        garbage: u64,
    ) -> Self {
        let chip = Chip::new(model, garbage);
        let memory = chip.bus.memory.clone();
        for (address, bytes) in &image.segments {
            memory.program(*address, bytes);
        }
        if softdevice.is_some() {
            boot::install(&memory, image.start());
        }
        let chip = Arc::new(Mutex::new(chip));
        let shared = Arc::new(Shared::default());
        let space = address_space(&memory, &chip, &shared, softdevice.as_ref());
        let space = Arc::new(space);
        let controller = image.library().map(Controller::new);
        Self {
            core: Core::new(Arc::clone(&space)),
            space,
            chip,
            shared,
            image,
            now: 0,
            interrupts: 0,
            boot_loader_ram: None,
            softdevice,
            controller,
            incidents: vec![(0, Incident::Started(Reset::Power))],
        }
    }

    pub fn chip(&self) -> MutexGuard<'_, Chip> {
        lock(&self.chip)
    }

    pub fn core(&mut self) -> &mut Core {
        &mut self.core
    }

    pub fn image(&self) -> &Image {
        &self.image
    }

    /// The radio and the armbands.
    ///
    /// # Panics
    /// If the image has neither a SoftDevice nor Nordic's library.
    pub fn air(&self) -> &Air {
        let controller = self.controller.as_ref().map(|one| &one.air);
        let air = controller.or(self.softdevice.as_ref().map(|one| &one.air));
        air.expect("an image with a radio")
    }

    /// The radio and the armbands, to be changed.
    ///
    /// # Panics
    /// If the image has neither a SoftDevice nor Nordic's library.
    pub fn air_mut(&mut self) -> &mut Air {
        let controller = self.controller.as_mut().map(|one| &mut one.air);
        let air = controller.or(self.softdevice.as_mut().map(|one| &mut one.air));
        air.expect("an image with a radio")
    }

    /// Ticks since power came first.
    pub fn now(&self) -> u64 {
        self.now
    }

    pub fn run(&mut self, ticks: u64) -> Result<(), Refusal> {
        self.run_until(self.now + ticks, |_| false)
    }

    /// Runs until a condition holds, which is looked at whenever something happens, or until a time.
    pub fn run_until(&mut self, end: u64, done: impl Fn(&Self) -> bool) -> Result<(), Refusal> {
        while self.now < end && !done(self) {
            let next = self.next().min(end);
            self.run_instructions(next)?;
            self.shared.now.store(self.now, Ordering::Relaxed);
            self.advance();
            if self.chip().bus.attention {
                self.attend()?;
            }
        }
        Ok(())
    }

    /// Runs instructions until something else has to be done.
    fn run_instructions(&mut self, until: u64) -> Result<(), Refusal> {
        let mut count = 0_u32;
        while self.now < until {
            self.shared.now.store(self.now, Ordering::Relaxed);
            self.now += self.core.step();
            count += 1;
            self.enter_library()?;
            if self.shared.attention.load(Ordering::Relaxed) {
                return self.attend();
            }
            if count.is_multiple_of(16) {
                if self.core.sleeps() {
                    self.check_sleep()?;
                    self.now = self.now.max(until);
                }
                if count.is_multiple_of(256) {
                    self.look()?;
                }
            }
        }
        Ok(())
    }

    /// Answers in place of Nordic's library, if the program has come to it.
    fn enter_library(&mut self) -> Result<(), Refusal> {
        let Some(controller) = &mut self.controller else {
            return Ok(());
        };
        if !controller.holds(self.core.place()) {
            return Ok(());
        }
        let mut chip = lock(&self.chip);
        chip.advance(self.now);
        let outcome = controller.enter(&mut chip, &mut self.core);
        drop(chip);
        self.shared.attention.store(true, Ordering::Relaxed);
        outcome.map_err(|(subject, what)| self.refusal(subject, what))
    }

    fn check_sleep(&mut self) -> Result<(), Refusal> {
        if self.chip().keeps_ram_asleep() {
            return Ok(());
        }
        Err(self.refusal("the core".to_owned(), What::RamIsLost))
    }

    /// Looks for what only shows in the core.
    fn look(&mut self) -> Result<(), Refusal> {
        if self.core.is_locked_up() {
            return Err(self.refusal(format!("{:#010x}", self.core.place()), What::LockedUp));
        }
        if self.core.asks_for_reset() {
            self.reset(Reset::Software);
        }
        Ok(())
    }

    /// Returns the tick at which something happens by itself next.
    fn next(&self) -> u64 {
        let chip = self.chip().next();
        let softdevice = self.softdevice.as_ref().and_then(SoftDevice::next);
        let controller = self.controller.as_ref().and_then(Controller::next);
        let radio = softdevice.into_iter().chain(controller).min();
        chip.min(radio.unwrap_or(u64::MAX)).max(self.now + 1)
    }

    fn advance(&mut self) {
        let mut chip = lock(&self.chip);
        chip.advance(self.now);
        if let Some(softdevice) = &mut self.softdevice {
            softdevice.advance(&mut chip);
        }
        if let Some(controller) = &mut self.controller {
            controller.advance(&mut chip);
        }
    }

    /// Does what peripherals, calls and tests have asked for.
    fn attend(&mut self) -> Result<(), Refusal> {
        self.shared.attention.store(false, Ordering::Relaxed);
        self.take_call()?;
        if self.shared.hard_fault.swap(false, Ordering::Relaxed) {
            self.note_hard_fault()?;
        }
        let mut chip = lock(&self.chip);
        chip.advance(self.now);
        chip.bus.attention = false;
        let halt = std::mem::take(&mut chip.bus.halt);
        if halt > 0 {
            self.now += halt;
            chip.advance(self.now);
        }
        let refused = chip.bus.refused.take();
        let subject = refused.as_ref().map(|(address, _)| chip.name_of(*address));
        let reset = chip.bus.reset.take();
        let interrupts = chip.interrupts();
        drop(chip);
        if let Some(((_, what), subject)) = refused.zip(subject) {
            return Err(self.refusal(subject, what));
        }
        if let Some(why) = reset {
            self.reset(why);
            return Ok(());
        }
        if interrupts != self.interrupts {
            self.interrupts = interrupts;
            self.core.set_interrupts(interrupts);
        }
        if let Some(softdevice) = &mut self.softdevice
            && softdevice.take_interrupt()
        {
            self.core.pend(EVENTS);
        }
        if let Some(controller) = &mut self.controller {
            for interrupt in controller.take_interrupts() {
                self.core.pend(interrupt);
            }
        }
        Ok(())
    }

    fn take_call(&mut self) -> Result<(), Refusal> {
        let frame = self.shared.call.swap(0, Ordering::Relaxed) as u32;
        if frame == 0 {
            return Ok(());
        }
        let mut chip = lock(&self.chip);
        chip.advance(self.now);
        let memory = chip.bus.memory.clone();
        let word = |number: u32| memory.word(frame + 4 * number).unwrap_or_default();
        let arguments = [0, 1, 2, 3].map(word);
        // The call is the instruction before the one that it returns to; its number is in the lower byte.
        let number = memory.read(word(6) - 2, 1).map_or(0, |byte| byte[0]);
        let Some(softdevice) = &mut self.softdevice else {
            return Ok(());
        };
        let answer = softdevice.call(number, arguments, &mut chip, &mut self.core);
        drop(chip);
        match answer {
            Ok(code) => {
                memory.write(frame, &code.to_le_bytes());
                Ok(())
            }
            Err(what) => Err(self.refusal(format!("SVC {number}"), what)),
        }
    }

    /// Notes a hard fault, with the place that its stacked registers say.
    fn note_hard_fault(&mut self) -> Result<(), Refusal> {
        let memory = self.chip().bus.memory.clone();
        let stacked = memory.word(self.core.stack_pointer() + 24);
        let stacked = stacked.unwrap_or_default();
        let place = self.image.place(stacked);
        // A supervisor call that may not be taken is a hard fault without a status of its own. rsemu says where it would
        // return to, a core where it is.
        let before = [stacked, stacked.wrapping_sub(2)];
        let mut codes = before.into_iter().filter_map(|at| memory.half(at));
        let call = codes.find(|code| code >> 8 == CALL).map(|code| code & 0xff);
        if let Some(number) = call.filter(|_| self.core.fault_status() == 0) {
            let what = if self.core.was_in_it_block() {
                What::CallInItBlock
            } else {
                let why = "from a priority that may not call, or with interrupts disabled";
                What::WrongCall {
                    why: why.to_owned(),
                }
            };
            return Err(self.refusal(format!("SVC {number} in {place}"), what));
        }
        self.incidents.push((self.now, Incident::HardFault(place)));
        Ok(())
    }

    pub fn reset(&mut self, why: Reset) {
        let mut chip = lock(&self.chip);
        chip.advance(self.now);
        chip.reset(why);
        if why == Reset::Power {
            // Other garbage each time.
            chip.bus.memory.lose_power(self.now);
        }
        if let Some(ram) = self.boot_loader_ram.clone() {
            chip.bus.memory.scramble(ram, self.now);
        }
        drop(chip);
        if let Some(softdevice) = &mut self.softdevice {
            softdevice.reset(self.now);
        }
        if let Some(controller) = &mut self.controller {
            controller.reset(self.now);
        }
        self.core = Core::new(Arc::clone(&self.space));
        self.interrupts = 0;
        self.shared.call.store(0, Ordering::Relaxed);
        self.incidents.push((self.now, Incident::Started(why)));
    }

    fn refusal(&self, subject: String, what: What) -> Refusal {
        Refusal {
            at_ms: self.now as f64 * 1000.0 / HZ as f64,
            subject,
            what,
            place: self.image.place(self.core.place()),
        }
    }
}
