//! CLOCK and POWER, which share their base address (product specification, 5.4 and 5.3).
//!
//! Clocks take their time to start. Where a test says so, the high-frequency clock is off on the UART's line until its
//! crystal runs, and the crystal of the low-frequency clock starts late or never. The supply is ideal.

use super::ChipModel;
use super::bus::{Bus, Peripheral, Reset};
use super::register::{INTEN, Registers, registers};
use crate::time::{ms, us};

/// Ticks after a stop, or a reset, in which the RC oscillator must not be started: erratum 132 of the nRF52832.
const ERRATUM_132: std::ops::RangeInclusive<u64> = us(66)..=us(138);
const INTERRUPTS: u32 = 0x3 | 1 << 2 | 0x1f << 5;

/// HFCLKSTAT and LFCLKSTAT: running (5.4.6).
const RUNNING: u32 = 1 << 16;
/// Sources of the low-frequency clock: RC oscillator, crystal.
const RC: u32 = 0;
const XTAL: u32 = 1;

/// Ticks that the crystal of the high-frequency clock takes to start (5.4.7).
const HFXO: u64 = us(360);

registers![
    TASKS_HFCLKSTART = task(0x000),
    TASKS_HFCLKSTOP = task(0x004),
    TASKS_LFCLKSTART = task(0x008),
    TASKS_LFCLKSTOP = task(0x00c),
    EVENTS_HFCLKSTARTED = event(0x100),
    EVENTS_LFCLKSTARTED = event(0x104),
    EVENTS_POFWARN = event(0x108),
    INTENSET = set(0x304, INTEN, INTERRUPTS),
    INTENCLR = clear(0x308, INTEN, INTERRUPTS),
    RESETREAS = one_clears(0x400, 0xf | 0x1f << 16),
    HFCLKRUN = read_only(0x408),
    HFCLKSTAT = read_only(0x40c),
    LFCLKRUN = read_only(0x414),
    LFCLKSTAT = read_only(0x418),
    LFCLKSRCCOPY = read_only(0x41c),
    GPREGRET = read_write(0x51c, 0xff),
    GPREGRET2 = read_write(0x520, 0xff),
    LFCLKSRC = read_write(0x518, 3 | 3 << 16),
    // Of the access port, on the same address (4.8.1).
    APPROTECT_DISABLE = read_write(0x558, 0xff),
    DCDCEN = read_write(0x578, 1),
    DCDCEN0 = read_write(0x580, 1),
    // Supply of the USB: it comes or goes, its regulator is ready (5.3.7).
    EVENTS_USBDETECTED = event(0x11c),
    EVENTS_USBREMOVED = event(0x120),
    EVENTS_USBPWRRDY = event(0x124),
    USBREGSTATUS = read_only(0x438),
    // Without a name: the workaround of erratum 108 of the nRF52832 writes it.
    ERRATUM108 = read_write(0xee4, 0x4f),
];

/// Registers that only the nRF52840 has, and those that only the nRF52832 has.
const ONLY_NRF52840: &[u32] = &[
    EVENTS_USBDETECTED,
    EVENTS_USBREMOVED,
    EVENTS_USBPWRRDY,
    USBREGSTATUS,
];
const ONLY_NRF52832: &[u32] = &[ERRATUM108];

/// Retained over every reset but the loss of power (5.3.6); the cable stays plugged.
const RETAINED: [u32; 4] = [RESETREAS, GPREGRET, GPREGRET2, USBREGSTATUS];

#[derive(Debug)]
pub struct ClockAndPower {
    registers: Registers,
    model: ChipModel,
    high: Option<u64>,
    /// Tick at which the low-frequency clock runs, from its source or, while the crystal starts, from the RC oscillator.
    low: Option<u64>,
    /// Tick at which it runs from its source.
    low_started: Option<u64>,
    /// Tick at which the low-frequency clock stopped.
    low_stopped: u64,
}

impl ClockAndPower {
    /// After a reset at this tick; `before` is what ran until then.
    pub fn new(model: ChipModel, why: Reset, now: u64, before: Option<&Self>) -> Self {
        let others = match model {
            ChipModel::Nrf52840 => ONLY_NRF52832,
            ChipModel::Nrf52832 => ONLY_NRF52840,
        };
        let registers = Registers::new("CLOCK/POWER", 0x4000_0000, TABLE);
        // A register of which there is none is not modelled.
        let mut registers = registers.changed(others, |one| one.count = 0);
        if let Some(before) = before.filter(|_| why != Reset::Power) {
            for offset in RETAINED {
                registers.put(offset, before.registers.get(offset));
            }
        }
        // RESETREAS (5.3.7.9): bits stay until they are cleared.
        let bit = match why {
            Reset::Power => 0,
            // With the bits that erratum 136 may set beside it: watchdog, software, lockup.
            Reset::Pin => 0xf,
            Reset::Watchdog => 1 << 1,
            Reset::Software => 1 << 2,
        };
        registers.put(RESETREAS, registers.get(RESETREAS) | bit);
        Self {
            registers,
            model,
            high: None,
            low: None,
            low_started: None,
            low_stopped: now,
        }
    }

    /// Returns the source of the low-frequency clock, while it runs.
    pub fn low_frequency_source(&self) -> Option<u32> {
        let status = self.registers.get(LFCLKSTAT);
        (status & RUNNING != 0).then_some(status & 3)
    }

    /// Returns true from the start of the low-frequency crystal on: its pins are taken.
    pub fn crystal_has_pins(&self) -> bool {
        self.registers.get(LFCLKRUN) == 1 && self.registers.get(LFCLKSRCCOPY) & 3 == XTAL
    }

    /// Starts the crystal of the low-frequency clock, which runs when it returns.
    pub fn start_slow_crystal(&mut self) {
        for (offset, value) in [
            (LFCLKSRCCOPY, XTAL),
            (LFCLKRUN, 1),
            (LFCLKSTAT, RUNNING | XTAL),
        ] {
            self.registers.put(offset, value);
        }
    }

    /// LFCLKSTAT: the watchdog keeps the RC oscillator running (6.36).
    fn low_frequency_status(&self, bus: &Bus) -> u32 {
        match self.registers.get(LFCLKSTAT) {
            0 if bus.watchdog_runs => RUNNING | RC,
            status => status,
        }
    }

    fn run_low(&mut self, source: u32, bus: &mut Bus) {
        self.registers.put(LFCLKSTAT, RUNNING | source);
        bus.low_frequency_runs = true;
    }

    /// The supply of the USB comes or goes.
    pub fn plug(&mut self, is_plugged: bool, bus: &mut Bus) {
        self.registers.put(USBREGSTATUS, 3 * u32::from(is_plugged));
        if is_plugged {
            self.raise(EVENTS_USBDETECTED, bus);
            self.raise(EVENTS_USBPWRRDY, bus);
        } else {
            self.raise(EVENTS_USBREMOVED, bus);
        }
    }

    /// Starts the crystal of the high-frequency clock.
    pub fn start_crystal(&mut self, bus: &mut Bus) {
        self.task(TASKS_HFCLKSTART, bus);
    }

    /// Returns true if RAM can be trusted after the core has slept, by the trim value that the factory wrote to FICR:
    /// erratum 108 of the nRF52832.
    pub fn keeps_ram_asleep(&self, trim: u32) -> bool {
        self.model != ChipModel::Nrf52832 || self.registers.get(ERRATUM108) == trim & 0x4f
    }
}

/// Ticks that the RC oscillator takes to start, and the low-frequency clock from the high-frequency one (5.4.8 to 5.4.10).
const LFRC: u64 = us(600);
const LFSYNT: u64 = us(100);
/// Ticks that the crystal takes until it is stable.
pub const LFXO: u64 = ms(250);

impl Peripheral for ClockAndPower {
    fn registers(&mut self) -> &mut Registers {
        &mut self.registers
    }

    fn task(&mut self, offset: u32, bus: &mut Bus) {
        match offset {
            TASKS_HFCLKSTART => {
                self.registers.put(HFCLKRUN, 1);
                self.high = Some(bus.now + HFXO);
            }
            TASKS_HFCLKSTOP => {
                self.high = None;
                bus.crystal_runs = false;
                self.registers.put(HFCLKRUN, 0);
                self.registers.put(HFCLKSTAT, 0);
            }
            TASKS_LFCLKSTART => {
                let source = self.registers.get(LFCLKSRC);
                let is_early = ERRATUM_132.contains(&(bus.now - self.low_stopped));
                if source & 3 == 0 && self.model == ChipModel::Nrf52832 && is_early {
                    return self.untimely(
                        offset,
                        bus,
                        "66 to 138 us after it was stopped or reset: erratum 132",
                    );
                }
                self.registers.put(LFCLKRUN, 1);
                self.registers.put(LFCLKSRCCOPY, source);
                let (runs, started) = match source & 3 {
                    RC => (LFRC, Some(LFRC)),
                    XTAL => (LFRC, bus.slow_crystal),
                    _ => (LFSYNT, Some(LFSYNT)),
                };
                self.low = Some(bus.now + runs);
                self.low_started = started.map(|ticks| bus.now + ticks);
            }
            _ if self.low_frequency_status(bus) == 0 => {
                self.untimely(offset, bus, "while the low-frequency clock does not run");
            }
            _ => {
                (self.low, self.low_started) = (None, None);
                self.low_stopped = bus.now;
                bus.low_frequency_runs = false;
                self.registers.put(LFCLKRUN, 0);
                self.registers.put(LFCLKSTAT, 0);
            }
        }
    }

    fn computed(&mut self, offset: u32, bus: &mut Bus) -> Option<u32> {
        (offset == LFCLKSTAT).then(|| self.low_frequency_status(bus))
    }

    fn stored(&mut self, offset: u32, bus: &mut Bus) {
        let value = self.registers.get(offset);
        let is_running = self.low_frequency_status(bus) != 0 || self.low.is_some();
        let source = match self.registers.get(LFCLKRUN) {
            1 => self.registers.get(LFCLKSRCCOPY),
            _ => RC,
        };
        let [core, high] = bus.board.inductors;
        let expected = match offset {
            LFCLKSRC if is_running && value != source => {
                "the low-frequency clock runs, and its source must not change until it is stopped"
            }
            DCDCEN if value == 1 && !core => "the board has no inductor for it",
            DCDCEN0 if value == 1 && !high => "the board has no inductor for it",
            _ => return,
        };
        self.unexpected(offset, bus, expected);
    }

    fn next(&self) -> Option<u64> {
        let all = [self.high, self.low, self.low_started];
        all.into_iter().flatten().min()
    }

    fn due(&mut self, bus: &mut Bus) {
        let now = bus.now;
        if self.high.take_if(|at| *at <= now).is_some() {
            bus.crystal_runs = true;
            self.registers.put(HFCLKSTAT, RUNNING | 1);
            self.raise(EVENTS_HFCLKSTARTED, bus);
        }
        let source = self.registers.get(LFCLKSRCCOPY) & 3;
        if self.low.take_if(|at| *at <= now).is_some() {
            self.run_low(if source == XTAL { RC } else { source }, bus);
        }
        if self.low_started.take_if(|at| *at <= now).is_some() {
            self.low = None;
            self.run_low(source, bus);
            self.raise(EVENTS_LFCLKSTARTED, bus);
        }
    }
}
