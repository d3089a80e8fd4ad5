//! The chip around the core: peripherals, the interconnect between them, pins, and what a reset does.

mod access;
mod bus;
mod clock_and_power;
mod ficr;
mod gpio;
mod gpiote;
mod nvmc;
mod outside;
mod ownership;
mod pins;
mod ppi;
mod pwm;
mod register;
mod rng;
mod rtc;
mod saadc;
mod temp;
mod timer;
mod uarte;
mod uicr;
mod usbd;
mod watchdog;

pub use bus::{Bus, Peripheral, Reset, Surroundings};
pub use nvmc::{FlashTimes, PAGE};
pub use ownership::Owner;
pub use uarte::Received;
pub use uicr::{APPROTECT, NFCPINS, REGOUT0, RESET_PINS};
pub use usbd::{Control, Usbd};

use crate::memory::Memory;
use clock_and_power::ClockAndPower;
use gpio::Gpio;
use gpiote::Gpiote;
use nvmc::Nvmc;
use pwm::Pwm;
use register::Registers;
use rng::Rng;
use rtc::Rtc;
use saadc::Saadc;
use timer::Timer;
use uarte::Uarte;
use watchdog::Watchdog;

/// Base address of the ports of pins.
const GPIO: u32 = 0x5000_0000;
/// Base address of FICR, which the factory wrote.
const FICR: u32 = ficr::BASE;

/// Model of a chip.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ChipModel {
    /// 1 MiB of flash, 256 KiB of RAM.
    Nrf52840,
    /// 512 KiB of flash, 64 KiB of RAM.
    Nrf52832,
}

impl ChipModel {
    pub const fn flash(self) -> u32 {
        match self {
            Self::Nrf52840 => 1024 * 1024,
            Self::Nrf52832 => 512 * 1024,
        }
    }

    pub const fn ram(self) -> u32 {
        match self {
            Self::Nrf52840 => 256 * 1024,
            Self::Nrf52832 => 64 * 1024,
        }
    }

    const fn ports(self) -> u32 {
        match self {
            Self::Nrf52840 => 2,
            Self::Nrf52832 => 1,
        }
    }

    const fn flash_times(self) -> FlashTimes {
        match self {
            Self::Nrf52840 => FlashTimes::NRF52840,
            Self::Nrf52832 => FlashTimes::NRF52832,
        }
    }
}

/// The chip without its core.
#[derive(Debug)]
pub struct Chip {
    /// Time, memory, and what peripherals ask of the core.
    pub bus: Bus,
    pub model: ChipModel,
    clock_and_power: ClockAndPower,
    uarte: Uarte,
    gpiote: Gpiote,
    timers: [Timer; 3],
    rtc: Rtc,
    temp: Registers,
    rng: Rng,
    watchdog: Watchdog,
    pub nvmc: Nvmc,
    ppi: Registers,
    pwm: Pwm,
    saadc: Saadc,
    usbd: Usbd,
    errata: Registers,
    ports: [Gpio; 2],
    ficr: Registers,
    uicr: Registers,
    /// Owner of the part of the chip that is taken.
    pub owner: Owner,
    /// Changes of levels: when, which pin, to what.
    pub changes: Vec<(u64, u32, Option<bool>)>,
    /// Tick at which something happens by itself next.
    next: u64,
    /// True if a level may have changed.
    pins_are_stale: bool,
    /// Newest register that was read, its value, and how often it was in a row.
    polled: (u32, u32, u32),
}

impl Chip {
    /// A blank chip, at the moment that power comes.
    pub fn new(model: ChipModel, garbage: u64) -> Self {
        let memory = Memory::new(model.flash(), model.ram(), garbage);
        let mut chip = Self::with(model, Bus::new(memory));
        chip.settle();
        chip
    }

    /// A chip with all peripherals as they are when power comes.
    fn with(model: ChipModel, bus: Bus) -> Self {
        let (part, variant) = match model {
            ChipModel::Nrf52840 => (0x5_2840, *b"AAF0"),
            ChipModel::Nrf52832 => (0x5_2832, *b"AAG0"),
        };
        let (ram, flash) = (model.ram() / 1024, model.flash() / 1024);
        Self {
            bus,
            model,
            clock_and_power: ClockAndPower::new(model, Reset::Power, 0, None),
            uarte: Uarte::new(model == ChipModel::Nrf52832),
            gpiote: Gpiote::new(),
            timers: [
                Timer::new("TIMER0", 0x4000_8000),
                Timer::new("TIMER1", 0x4000_9000),
                Timer::new("TIMER2", 0x4000_a000),
            ],
            rtc: Rtc::new(),
            temp: temp::new(),
            rng: Rng::new(),
            watchdog: Watchdog::new(),
            nvmc: Nvmc::new(model.flash_times(), model.flash()),
            ppi: ppi::new(),
            pwm: Pwm::new(),
            saadc: Saadc::new(),
            usbd: Usbd::new(),
            errata: usbd::errata(),
            ports: [Gpio::new("P0", 0), Gpio::new("P1", 1)],
            ficr: ficr::of(part, variant, ram, flash),
            uicr: uicr::blank(),
            owner: Owner::Program,
            changes: Vec::new(),
            next: 0,
            pins_are_stale: true,
            polled: (0, 0, 0),
        }
    }

    /// Resets everything but memory; what a reset spares is said at each part (5.3.6).
    pub fn reset(&mut self, why: Reset) {
        let (now, model) = (self.bus.now, self.model);
        let fresh = Self::with(model, self.bus.after_reset());
        let before = std::mem::replace(self, fresh);
        let clock = Some(&before.clock_and_power);
        self.clock_and_power = ClockAndPower::new(model, why, now, clock);
        // What happens outside of the chip goes on: the line, and what is counted of it.
        self.uarte.line = before.uarte.line;
        self.uarte.sent = before.uarte.sent;
        self.uarte.counts_broken = before.uarte.counts_broken;
        self.nvmc.partly_erased = before.nvmc.partly_erased;
        self.saadc.inputs = before.saadc.inputs;
        // A reset by software or by the pin leaves the watchdog running.
        if !matches!(why, Reset::Power | Reset::Watchdog) {
            self.watchdog = before.watchdog;
            self.bus.watchdog_runs = before.bus.watchdog_runs;
        }
        self.ports = [0, 1].map(|port: usize| before.ports[port].after_reset());
        self.uicr = before.uicr;
        self.changes = before.changes;
        self.settle();
    }

    /// Returns the peripherals that do something by themselves as time passes, and the bus.
    fn clocked(&mut self) -> ([&mut dyn Peripheral; 11], &mut Bus) {
        let [t0, t1, t2] = &mut self.timers;
        let all: [&mut dyn Peripheral; 11] = [
            &mut self.clock_and_power,
            t0,
            t1,
            t2,
            &mut self.rtc,
            &mut self.rng,
            &mut self.uarte,
            &mut self.watchdog,
            &mut self.saadc,
            &mut self.usbd,
            &mut self.pwm,
        ];
        (all, &mut self.bus)
    }

    fn peripheral(&mut self, address: u32) -> Option<(&mut dyn Peripheral, &mut Bus)> {
        let bus = &mut self.bus;
        let many = self.model == ChipModel::Nrf52840;
        let one: &mut dyn Peripheral = match address & !0xfff {
            0x4000_0000 => &mut self.clock_and_power,
            0x4000_2000 => &mut self.uarte,
            0x4000_6000 => &mut self.gpiote,
            0x4000_7000 => &mut self.saadc,
            0x4000_8000 => &mut self.timers[0],
            0x4000_9000 => &mut self.timers[1],
            0x4000_a000 => &mut self.timers[2],
            0x4000_c000 => &mut self.temp,
            0x4000_d000 => &mut self.rng,
            0x4001_0000 => &mut self.watchdog,
            0x4001_1000 => &mut self.rtc,
            0x4001_c000 => &mut self.pwm,
            0x4001_e000 => &mut self.nvmc,
            0x4001_f000 => &mut self.ppi,
            0x4002_7000 if many => &mut self.usbd,
            0x4006_e000 if many => &mut self.errata,
            GPIO if many && address >= GPIO + gpio::PORT + 0x500 => &mut self.ports[1],
            GPIO => &mut self.ports[0],
            _ => return None,
        };
        Some((one, bus))
    }
}
