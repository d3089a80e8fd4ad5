//! Surroundings of the chip: levels of pins, the UART's line, a programmer.

use super::timer::Timer;
use super::{Chip, FICR, Received, ficr, uicr};
use crate::time::HZ;

/// Ticks of a byte that comes at 115200 baud.
const BYTE: u64 = HZ * 10 / 115_200;

impl Chip {
    /// The level of a pin; none where nothing drives nor pulls it.
    pub fn level(&self, pin: u32) -> Option<bool> {
        self.ports[pin as usize / 32].level(pin % 32)
    }

    /// Ticks for which PWM0's pin is high in the period that is running; none while it makes no pulses.
    pub fn pulse(&self) -> Option<u64> {
        self.pwm.high()
    }

    /// Drives a pin from outside, or lets it go.
    pub fn drive(&mut self, pin: u32, level: Option<bool>) {
        self.ports[pin as usize / 32].drive(pin % 32, level);
        self.pins_are_stale = true;
        self.settle();
    }

    /// Puts bytes on the UART's line, one after the other at the rate of 115200 baud, from this time on or after those
    /// that are on it.
    pub fn receive(&mut self, from: u64, bytes: impl IntoIterator<Item = (u8, bool)>) {
        let mut at = self
            .uarte
            .line
            .back()
            .map_or(from, |last| last.at.max(from));
        for (byte, is_broken) in bytes {
            at += BYTE;
            self.uarte.line.push_back(Received {
                at,
                byte,
                is_broken,
            });
        }
        self.settle();
    }

    /// Returns the bytes that the UART has sent, each with the tick at which its last bit was over.
    pub fn sent(&self) -> &[(u64, u8)] {
        &self.uarte.sent
    }

    /// Sets if RXDRDY comes for bytes whose stop bit is missing.
    pub fn count_broken_bytes(&mut self, counts: bool) {
        self.uarte.counts_broken = counts;
    }

    /// Returns true if RAM can be trusted after the core has slept.
    pub fn keeps_ram_asleep(&self) -> bool {
        let trim = self.ficr.get(ficr::ERRATUM108);
        self.clock_and_power.keeps_ram_asleep(trim)
    }

    /// Returns the source of the low-frequency clock, while it runs.
    pub fn low_frequency_source(&self) -> Option<u32> {
        self.clock_and_power.low_frequency_source()
    }

    /// Starts the crystal of the high-frequency clock, as the radio's library does.
    pub fn start_crystal(&mut self) {
        self.clock_and_power.start_crystal(&mut self.bus);
        self.settle();
    }

    /// Gives the low-frequency clock its crystal, as the SoftDevice does.
    pub fn start_slow_crystal(&mut self) {
        self.clock_and_power.start_slow_crystal();
        self.check_pins();
    }

    /// TIMER0 counts microseconds from now on: a time slot begins.
    pub fn start_slot_timer(&mut self) {
        self.timers[0] = Timer::of_microseconds("TIMER0", 0x4000_8000, self.bus.now);
        self.settle();
    }

    pub fn stop_slot_timer(&mut self) {
        self.timers[0] = Timer::new("TIMER0", 0x4000_8000);
        self.settle();
    }

    pub fn uicr(&self, offset: u32) -> u32 {
        self.uicr.get(offset)
    }

    /// Puts a word into UICR, as a programmer does.
    pub fn program_uicr(&mut self, offset: u32, value: u32) {
        self.uicr.put(offset, value);
    }

    pub fn name_of(&mut self, address: u32) -> String {
        match address & !0xfff {
            FICR => self.ficr.name_of(address - FICR),
            uicr::BASE => self.uicr.name_of(address - uicr::BASE),
            _ => match self.peripheral(address) {
                Some((one, _)) => {
                    let registers = one.registers();
                    registers.name_of(address - registers.base)
                }
                None => format!("{address:#010x}"),
            },
        }
    }
}
