//! CLOCK and POWER, which share their base address (product specification, 5.4 and 5.3).
//!
//! Clocks take their time to start. Where a test says so, the high-frequency clock is off on the UART's line until its
//! crystal runs, and the crystal of the low-frequency clock starts late or never. The supply is ideal.

use super::ChipModel;
use super::bus::{Bus, Peripheral, Reset};
use super::register::{
    INTEN, Register, Registers, clear, event, one_clears, read_only, read_write, set, task,
};
use crate::time::{ms, us};

const HFCLKSTART: u32 = 0x000;
const HFCLKSTOP: u32 = 0x004;
const LFCLKSTART: u32 = 0x008;
const LFCLKSTOP: u32 = 0x00c;
const HFCLKSTARTED: u32 = 0x100;
const LFCLKSTARTED: u32 = 0x104;
const HFCLKRUN: u32 = 0x408;
const HFCLKSTAT: u32 = 0x40c;
const LFCLKRUN: u32 = 0x414;
const LFCLKSTAT: u32 = 0x418;
const LFCLKSRCCOPY: u32 = 0x41c;
const LFCLKSRC: u32 = 0x518;
const RESETREAS: u32 = 0x400;
const DCDCEN: u32 = 0x578;
const DCDCEN0: u32 = 0x580;
/// Register without a name that the workaround of erratum 108 of the nRF52832 writes.
const ERRATUM_108: u32 = 0xee4;
/// Ticks after a stop, or a reset, in which the RC oscillator must not be started: erratum 132 of the nRF52832.
const ERRATUM_132: std::ops::RangeInclusive<u64> = us(66)..=us(138);
const INTERRUPTS: u32 = 0x3 | 1 << 2 | 0x1f << 5;
/// Supply of the USB: it comes or goes, its regulator is ready (5.3.7).
const USBDETECTED: u32 = 0x11c;
const USBREMOVED: u32 = 0x120;
const USBPWRRDY: u32 = 0x124;
const USBREGSTATUS: u32 = 0x438;

/// HFCLKSTAT and LFCLKSTAT: running (5.4.6).
const RUNNING: u32 = 1 << 16;
/// Sources of the low-frequency clock: RC oscillator, crystal.
const RC: u32 = 0;
const XTAL: u32 = 1;

/// Ticks that the crystal of the high-frequency clock takes to start (5.4.7).
const HFXO: u64 = us(360);

macro_rules! table {
    ($($more:expr),*) => {
        &[
    task("TASKS_HFCLKSTART", HFCLKSTART),
    task("TASKS_HFCLKSTOP", HFCLKSTOP),
    task("TASKS_LFCLKSTART", LFCLKSTART),
    task("TASKS_LFCLKSTOP", LFCLKSTOP),
    event("EVENTS_HFCLKSTARTED", HFCLKSTARTED),
    event("EVENTS_LFCLKSTARTED", LFCLKSTARTED),
    event("EVENTS_POFWARN", 0x108),
    set("INTENSET", 0x304, INTEN, INTERRUPTS),
    clear("INTENCLR", 0x308, INTEN, INTERRUPTS),
    one_clears("RESETREAS", RESETREAS, 0xf | 0x1f << 16),
    read_only("HFCLKRUN", HFCLKRUN),
    read_only("HFCLKSTAT", HFCLKSTAT),
    read_only("LFCLKRUN", LFCLKRUN),
    read_only("LFCLKSTAT", LFCLKSTAT),
    read_only("LFCLKSRCCOPY", LFCLKSRCCOPY),
    read_write("GPREGRET", 0x51c, 0xff),
    read_write("GPREGRET2", 0x520, 0xff),
    read_write("LFCLKSRC", LFCLKSRC, 3 | 3 << 16),
    // Of the access port, on the same address (4.8.1).
    read_write("APPROTECT.DISABLE", 0x558, 0xff),
    read_write("DCDCEN", DCDCEN, 1),
    read_write("DCDCEN0", DCDCEN0, 1),
    $($more),*
        ]
    };
}

const NRF52840: &[Register] = table!(
    event("EVENTS_USBDETECTED", USBDETECTED),
    event("EVENTS_USBREMOVED", USBREMOVED),
    event("EVENTS_USBPWRRDY", USBPWRRDY),
    read_only("USBREGSTATUS", USBREGSTATUS)
);
const NRF52832: &[Register] = table!(read_write("ERRATUM108", ERRATUM_108, 0x4f));

/// Retained over every reset but the loss of power (5.3.6); the cable stays plugged.
const RETAINED: [u32; 4] = [RESETREAS, 0x51c, 0x520, USBREGSTATUS];

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
        let table = match model {
            ChipModel::Nrf52840 => NRF52840,
            ChipModel::Nrf52832 => NRF52832,
        };
        let mut registers = Registers::new("CLOCK/POWER", 0x4000_0000, table);
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
            self.raise(USBDETECTED, bus);
            self.raise(USBPWRRDY, bus);
        } else {
            self.raise(USBREMOVED, bus);
        }
    }

    /// Starts the crystal of the high-frequency clock.
    pub fn start_crystal(&mut self, bus: &mut Bus) {
        self.task(HFCLKSTART, bus);
    }

    /// Returns true if RAM can be trusted after the core has slept, by the trim value that the factory wrote to FICR:
    /// erratum 108 of the nRF52832.
    pub fn keeps_ram_asleep(&self, trim: u32) -> bool {
        self.model != ChipModel::Nrf52832 || self.registers.get(ERRATUM_108) == trim & 0x4f
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
            HFCLKSTART => {
                self.registers.put(HFCLKRUN, 1);
                self.high = Some(bus.now + HFXO);
            }
            HFCLKSTOP => {
                self.high = None;
                bus.crystal_runs = false;
                self.registers.put(HFCLKRUN, 0);
                self.registers.put(HFCLKSTAT, 0);
            }
            LFCLKSTART => {
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
            self.raise(HFCLKSTARTED, bus);
        }
        let source = self.registers.get(LFCLKSRCCOPY) & 3;
        if self.low.take_if(|at| *at <= now).is_some() {
            self.run_low(if source == XTAL { RC } else { source }, bus);
        }
        if self.low_started.take_if(|at| *at <= now).is_some() {
            self.low = None;
            self.run_low(source, bus);
            self.raise(LFCLKSTARTED, bus);
        }
    }
}
