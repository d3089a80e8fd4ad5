//! Accesses of the core to peripherals, and what comes of events.

use super::bus::Peripheral;
use super::register::{RegisterKind, Written};
use super::{Chip, FICR, GPIO, ppi, uicr};
use crate::refusal::What;
use crate::time::us;

/// Reads of one value in a row after which a program polls, and the ticks that each further one takes.
const MANY: u32 = 64;
const POLL: u64 = us(20);

impl Chip {
    /// Returns the value that the program reads from a peripheral, or from UICR or FICR. A refused read gives 0.
    pub fn read(&mut self, address: u32, bytes: usize) -> u32 {
        if bytes != 4 || !address.is_multiple_of(4) {
            self.bus.refuse(address, What::Width { bytes });
            return 0;
        }
        let read = match address & !0xfff {
            FICR => self.ficr.read(address - FICR),
            uicr::BASE => self.uicr.read(address - uicr::BASE),
            _ => self.read_peripheral(address),
        };
        read.unwrap_or_else(|what| {
            self.bus.refuse(address, what);
            0
        })
    }

    fn read_peripheral(&mut self, address: u32) -> Result<u32, What> {
        self.check_owner(address, None)?;
        let Some((one, bus)) = self.peripheral(address) else {
            return Err(What::NoPeripheral);
        };
        let offset = address - one.registers().base;
        let held = one.registers().read(offset)?;
        if let Some(computed) = one.computed(offset, bus) {
            return Ok(computed);
        }
        self.note_poll(address, held);
        Ok(held)
    }

    /// Lets a program that polls do so slowly: nothing but time changes what it reads, and its instructions cost.
    fn note_poll(&mut self, address: u32, value: u32) {
        let (before, held, count) = self.polled;
        let count = if (before, held) == (address, value) {
            count + 1
        } else {
            0
        };
        self.polled = (address, value, count);
        if count >= MANY {
            self.bus.halt(POLL);
        }
    }

    /// Writes a value, as the program does, to a peripheral, or to UICR or FICR.
    pub fn write(&mut self, address: u32, bytes: usize, value: u32) {
        if bytes != 4 || !address.is_multiple_of(4) {
            return self.bus.refuse(address, What::Width { bytes });
        }
        let written = match address & !0xfff {
            FICR => self.ficr.write(address - FICR, value).map(|_| ()),
            uicr::BASE => self.write_uicr(address - uicr::BASE, value),
            _ => self.write_peripheral(address, value),
        };
        if let Err(what) = written {
            self.bus.refuse(address, what);
        }
        self.bus.attention = true;
        self.settle();
    }

    /// Writes a word of flash, as the program does; false if its controller does not let it.
    pub fn write_flash(&mut self, address: u32, bytes: usize, value: u32) -> bool {
        if !self.nvmc.writes() {
            return false;
        }
        if bytes != 4 || !address.is_multiple_of(4) {
            self.bus.refuse(address, What::Width { bytes });
        } else if let Err(what) = self.check_owner(address, Some(value)) {
            self.bus.refuse(address, what);
        } else {
            self.nvmc.write(address, value, &mut self.bus);
        }
        true
    }

    fn write_uicr(&mut self, offset: u32, value: u32) -> Result<(), What> {
        if !self.nvmc.writes() {
            let expected = "CONFIG of NVMC has to enable writing first";
            return Err(What::Value { value, expected });
        }
        let old = self.uicr.read(offset)?;
        self.uicr.put(offset, old & value);
        self.bus.halt(self.nvmc.times.write);
        Ok(())
    }

    fn write_peripheral(&mut self, address: u32, value: u32) -> Result<(), What> {
        self.check_owner(address, Some(value))?;
        self.polled = (0, 0, 0);
        let Some((one, bus)) = self.peripheral(address) else {
            return Err(What::NoPeripheral);
        };
        let offset = address - one.registers().base;
        // GPIO, GPIOTE, and what takes pins: CLOCK, UARTE, PWM.
        let pins = matches!(
            one.registers().base & !0xfff,
            GPIO | 0x4000_0000 | 0x4000_2000 | 0x4000_6000 | 0x4001_c000
        );
        match one.registers().write(offset, value)? {
            Written::Nothing => {}
            Written::Task => one.task(offset, bus),
            Written::Stored(offset) => one.stored(offset, bus),
        }
        self.pins_are_stale |= pins;
        match address.checked_sub(self.ppi.base) {
            Some(offset) if offset < 0x1000 => self.check_channel(offset),
            _ => Ok(()),
        }
    }

    fn check_owner(&self, address: u32, written: Option<u32>) -> Result<(), What> {
        self.owner.refuses(address, written).map_or(Ok(()), Err)
    }

    /// Refuses ends of channels that are no event, or no task.
    fn check_channel(&mut self, offset: u32) -> Result<(), What> {
        let Some((is_event, end)) = ppi::end(&self.ppi, offset) else {
            return Ok(());
        };
        let kind = if is_event {
            RegisterKind::Event
        } else {
            RegisterKind::Task
        };
        let fits = self.peripheral(end).is_some_and(|(one, _)| {
            let offset = end.wrapping_sub(one.registers().base);
            offset < 0x1000 && one.registers().is(offset, kind)
        });
        match (fits, is_event) {
            (true, _) => Ok(()),
            (false, true) => Err(What::NoEvent),
            (false, false) => Err(What::NoTask),
        }
    }

    /// Carries events through shortcuts and the interconnect until nothing is left to do.
    pub(super) fn settle(&mut self) {
        while let Some(event) = self.bus.events.pop_front() {
            if let Some((one, _)) = self.peripheral(event) {
                let base = one.registers().base;
                for task in one.shorts(event - base) {
                    self.start(base + task);
                }
            }
            for task in ppi::tasks(&self.ppi, event) {
                self.start(task);
            }
        }
        if std::mem::take(&mut self.pins_are_stale) {
            self.settle_pins();
            self.check_pins();
        }
        let (all, _) = self.clocked();
        let next = all.iter().filter_map(|one| one.next()).min();
        self.next = next.unwrap_or(u64::MAX);
    }

    fn start(&mut self, task: u32) {
        self.pins_are_stale |= task & !0xfff == self.gpiote.registers().base;
        if let Some((one, bus)) = self.peripheral(task) {
            let offset = task - one.registers().base;
            one.task(offset, bus);
        }
    }

    fn settle_pins(&mut self) {
        let (gpiote, pwm) = (&self.gpiote, &self.pwm);
        for (number, port) in (0..self.model.ports()).zip(&mut self.ports) {
            let before: Vec<_> = (0..32).map(|pin| port.level(pin)).collect();
            let taken = |pin| gpiote.drives(pin).or_else(|| pwm.drives(pin));
            port.settle(|pin| taken(32 * number + pin));
            for (pin, before) in (0..32).zip(before) {
                let level = port.level(pin);
                if level != before {
                    self.changes.push((self.bus.now, 32 * number + pin, level));
                }
            }
        }
    }

    /// Returns the tick at which something happens by itself next.
    pub fn next(&self) -> u64 {
        self.next
    }

    /// Lets time pass, and everything happen that is due by then.
    pub fn advance(&mut self, until: u64) {
        while self.next <= until && self.bus.reset.is_none() {
            self.bus.now = self.bus.now.max(self.next);
            let (all, bus) = self.clocked();
            for one in all {
                if one.next().is_some_and(|at| at <= bus.now) {
                    one.due(bus);
                }
            }
            self.pins_are_stale |= self.pwm.pin().is_some();
            self.bus.attention = true;
            self.settle();
        }
        self.bus.now = self.bus.now.max(until);
    }

    /// Levels of the interrupts, by their numbers: a peripheral's is that of its address (6.1.1).
    pub fn interrupts(&mut self) -> u64 {
        let mut levels = 0;
        for number in 0..0x28 {
            if let Some((one, _)) = self.peripheral(0x4000_0000 | number << 12)
                && one.registers().interrupts()
            {
                levels |= 1 << number;
            }
        }
        levels
    }
}
