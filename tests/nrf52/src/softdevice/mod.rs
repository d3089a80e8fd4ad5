//! A SoftDevice as the program sees it: its documented supervisor calls and events, with armbands on the other side.
//!
//! None of Nordic's code runs here. What a call takes, answers and refuses is in the headers that come with the library's
//! bindings; the SoftDevice's own time on the core, its needs of memory and the limits of its queues are not modelled.

pub mod boot;
mod calls;
mod events;
mod flash;
mod gap;
mod gattc;

use std::collections::VecDeque;

use shared::myo::Address;

use crate::air::Air;
use crate::chip::{Chip, Owner};
use crate::core::{Core, INTERRUPTS};
use crate::memory::{Memory, give, take};
use crate::refusal::{What, needs, wrong};
use calls::{answer, call};
pub use flash::{Fate, Flash};

/// Kind of SoftDevice.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum SoftDeviceKind {
    /// S140 7.x, for the nRF52840.
    #[default]
    S140,
    /// S132 7.x, for the nRF52832.
    S132,
}

impl SoftDeviceKind {
    /// Address at which the program begins: the end of its flash (release notes of S140 7.3.0 and S132 7.3.0).
    pub const fn program(self) -> u32 {
        match self {
            Self::S140 => 0x2_7000,
            Self::S132 => 0x2_6000,
        }
    }
}

/// Address at which the program's RAM begins, as `memory.x` has it for both.
const RAM_END: u32 = 0x2000_4000;
/// Address at which it could begin. The release notes say what a SoftDevice needs at least, 0x1668 bytes; what one
/// connection of 15 ms and an ATT MTU of 23 add only a SoftDevice says, when it is enabled. This is a guess: half of
/// what it is given.
const RAM_NEED: u32 = 0x2000_3000;
/// Priorities that it keeps for itself (S140 specification, "Interrupt model and processor availability").
const RESERVED: [u8; 3] = [0, 1, 4];
/// The priority of supervisor calls (same place).
const CALL_PRIORITY: u8 = 4;
/// Interrupts that it handles itself: CLOCK, RADIO, TIMER0, RTC0, TEMP, RNG, ECB, CCM, EGU5.
const OWN: [u16; 9] = [0, 1, 8, 11, 12, 13, 14, 15, 25];
/// The interrupt that tells the program of events, and the priority that it is given when the SoftDevice is enabled
/// (nrf_sdh.c of Nordic's SDK: "Interrupt priority has already been set by the stack").
pub const EVENTS: u16 = 22;
const EVENTS_PRIORITY: u8 = 6;
/// The first of the calls that need Bluetooth to be enabled (`BLE_SVC_BASE`).
const FIRST_OF_BLUETOOTH: u8 = 0x60;

/// A SoftDevice.
#[derive(Default, Debug)]
pub struct SoftDevice {
    kind: SoftDeviceKind,
    is_enabled: bool,
    speaks_bluetooth: bool,
    events: VecDeque<Vec<u8>>,
    chip_events: VecDeque<u32>,
    interrupts: bool,
    whitelist: Vec<Address>,
    /// Identifier of the armband's request for parameters that the program has not answered.
    asked: Option<u8>,
    /// Address to which the data of an advertisement goes.
    scan_buffer: u32,
    /// The radio, and the armbands.
    pub air: Air,
    /// Operations of flash.
    pub flash: Flash,
    /// True if the program has asked for the high-frequency crystal between radio events too.
    pub keeps_crystal: bool,
}

impl SoftDevice {
    /// Creates a SoftDevice without armbands in reach.
    pub fn new(kind: SoftDeviceKind) -> Self {
        Self {
            kind,
            ..Self::default()
        }
    }

    /// Returns the address at which the program's RAM begins.
    pub const fn ram_end(&self) -> u32 {
        RAM_END
    }

    pub fn reset(&mut self, now: u64) {
        self.air.reset(now);
        self.flash.reset();
        *self = Self {
            air: std::mem::take(&mut self.air),
            flash: std::mem::take(&mut self.flash),
            ..Self::new(self.kind)
        };
    }

    fn push(&mut self, event: Vec<u8>) {
        self.events.push_back(event);
        self.interrupts = true;
    }

    fn push_chip_event(&mut self, event: u32) {
        self.chip_events.push_back(event);
        self.interrupts = true;
    }

    /// Returns true, once, if the program is to be told of events.
    pub fn take_interrupt(&mut self) -> bool {
        std::mem::take(&mut self.interrupts)
    }

    /// Returns the tick at which something happens by itself next, if something does.
    pub fn next(&self) -> Option<u64> {
        self.flash.next().into_iter().chain(self.air.next()).min()
    }

    pub fn advance(&mut self, chip: &mut Chip) {
        self.finish_flash(chip);
        self.air.advance(chip.bus.now);
        while let Some(event) = self.air.take() {
            self.tell(event, &chip.bus.memory);
        }
        chip.bus.attention |= self.interrupts;
    }

    pub fn call(
        &mut self,
        number: u8,
        arguments: [u32; 4],
        chip: &mut Chip,
        core: &mut Core,
    ) -> Result<u32, What> {
        if self.is_enabled {
            check_priorities(core)?;
        }
        let is_first = number == call::SOFTDEVICE_ENABLE;
        needs(
            self.is_enabled != is_first,
            "at the wrong time: the SoftDevice is enabled once",
        )?;
        let is_first = matches!(number, call::BLE_CFG_SET | call::BLE_ENABLE);
        let needs_bluetooth = number >= FIRST_OF_BLUETOOTH;
        needs(
            !needs_bluetooth || self.speaks_bluetooth != is_first,
            "at the wrong time: Bluetooth is configured, and then enabled once",
        )?;
        let now = chip.bus.now;
        let memory = chip.bus.memory.clone();
        let [first, second, third, fourth] = arguments;
        match number {
            call::SOFTDEVICE_ENABLE => self.enable(first, second, chip, core)?,
            call::FLASH_PAGE_ERASE => return self.erase(first, chip),
            call::FLASH_WRITE => return self.write(arguments, chip),
            call::CLOCK_HFCLK_REQUEST => {
                self.keeps_crystal = true;
                chip.start_crystal();
            }
            call::EVT_GET => match self.chip_events.pop_front() {
                Some(event) => give(&memory, first, &event.to_le_bytes())?,
                None => return Ok(answer::NOT_FOUND),
            },
            call::BLE_CFG_SET => {}
            call::BLE_ENABLE => self.enable_bluetooth(first, &memory)?,
            call::BLE_EVT_GET => return self.give_event(first, second, &memory),
            call::GAP_WHITELIST_SET => self.set_whitelist(first, second as u8, &memory)?,
            // Transmission power is not modelled.
            call::GAP_TX_POWER_SET => {}
            // It has ended, and the program does not know yet.
            call::GAP_SCAN_START if first == 0 && !self.air.scans() => {
                return Ok(answer::INVALID_STATE);
            }
            call::GAP_SCAN_START => self.start_scan(first, second, now, &memory)?,
            call::GAP_SCAN_STOP if self.air.stop_scan(now) => {}
            call::GAP_CONNECT => self.connect([second, third, fourth], now, &memory)?,
            call::GAP_CONNECT_CANCEL if self.air.cancel_connect(now) => {}
            // It has ended, and the program does not know yet.
            call::GAP_SCAN_STOP | call::GAP_CONNECT_CANCEL => return Ok(answer::INVALID_STATE),
            call::GAP_CONN_PARAM_UPDATE => {
                return self.update_parameters(first as u16, second, now, &memory);
            }
            call::GAP_DISCONNECT => return Ok(self.disconnect(first as u16, now)),
            // It does not change what the armband, a device of Bluetooth 4.0, can do.
            call::GAP_DATA_LENGTH_UPDATE => return Ok(self.answer_of(first as u16)),
            call::GATTC_READ => return Ok(self.read_attribute(first as u16, second as u16)),
            call::GATTC_WRITE => {
                return self.write_attribute(first as u16, second, &memory);
            }
            _ => return Err(What::UnknownCall { arguments }),
        }
        Ok(answer::SUCCESS)
    }

    fn enable(
        &mut self,
        clock: u32,
        fault_handler: u32,
        chip: &mut Chip,
        core: &mut Core,
    ) -> Result<(), What> {
        needs(fault_handler != 0, "without a handler of faults")?;
        check_priorities(core)?;
        // Source, two intervals of calibration, accuracy (`nrf_clock_lf_cfg_t`).
        let clock = take(&chip.bus.memory, clock, 4)?;
        let is_calibrated = clock[1] != 0;
        needs(
            clock[0] <= 2 && is_calibrated == (clock[0] == 0),
            "for another clock than the crystal, the synthesized one or the RC clock with calibration",
        )?;
        core.set_call_priority(CALL_PRIORITY);
        core.set_priority(EVENTS, EVENTS_PRIORITY);
        self.is_enabled = true;
        if clock[0] == 1 {
            chip.start_slow_crystal();
        }
        chip.owner = Owner::SoftDevice;
        Ok(())
    }

    fn enable_bluetooth(&mut self, ram: u32, memory: &Memory) -> Result<(), What> {
        let given = memory.word(ram).unwrap_or_default();
        needs(
            given >= RAM_NEED,
            "with a start of RAM that leaves too little",
        )?;
        give(memory, ram, &RAM_NEED.to_le_bytes())?;
        self.speaks_bluetooth = true;
        Ok(())
    }

    fn give_event(&mut self, into: u32, length: u32, memory: &Memory) -> Result<u32, What> {
        needs(
            into.is_multiple_of(4),
            "with a buffer that is not aligned to a word",
        )?;
        let Some(event) = self.events.front() else {
            return Ok(answer::NOT_FOUND);
        };
        let given = memory.half(length).unwrap_or_default();
        let fits = usize::from(given) >= event.len();
        needs(fits, "with a buffer that is too short")?;
        give(memory, into, event)?;
        give(memory, length, &(event.len() as u16).to_le_bytes())?;
        self.events.pop_front();
        Ok(answer::SUCCESS)
    }
}

/// Refuses enabled interrupts that have a priority of the SoftDevice's, or are its own.
fn check_priorities(core: &Core) -> Result<(), What> {
    for interrupt in (0..INTERRUPTS).filter(|interrupt| !OWN.contains(interrupt)) {
        if let Some(priority) = core
            .priority(interrupt)
            .filter(|one| RESERVED.contains(one))
        {
            return Err(What::Priority {
                interrupt,
                priority,
            });
        }
    }
    match OWN.into_iter().find(|own| core.priority(*own).is_some()) {
        Some(own) => Err(wrong(&format!(
            "while interrupt {own}, its own, is enabled"
        ))),
        None => Ok(()),
    }
}
