//! Parts of the chip that an enabled SoftDevice takes (S140 and S132 specifications, "Hardware peripherals"), and MPSL with
//! the controller (MPSL's documentation, "Integration notes").

use crate::refusal::What;

/// Owner of the part of the chip that is taken.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Owner {
    Program,
    SoftDevice,
    Controller,
    /// The controller's library, in a time slot: the radio, TIMER0 and flash are the program's.
    TimeSlot,
}

impl Owner {
    /// Returns the reason to refuse an access, if there is one. `written` is the value of a write.
    pub fn refuses(self, address: u32, written: Option<u32>) -> Option<What> {
        let is_taken = match self {
            Self::Program => false,
            Self::SoftDevice => is_softdevices(address, written),
            Self::Controller => is_controllers(address, written) || is_lent(address, written),
            Self::TimeSlot => is_controllers(address, written),
        };
        is_taken.then_some(match self {
            Self::SoftDevice => What::SoftDevices,
            _ => What::Controllers,
        })
    }
}

/// Peripherals that are its own, or that its calls alone may access.
const TAKEN: [u32; 13] = [
    // CLOCK and POWER, RADIO.
    0x4000_0000,
    0x4000_1000,
    // TIMER0, RTC0.
    0x4000_8000,
    0x4000_b000,
    // TEMP, RNG, ECB, CCM and AAR.
    0x4000_c000,
    0x4000_d000,
    0x4000_e000,
    0x4000_f000,
    // EGU1, EGU2, EGU4 and EGU5 with their software interrupts.
    0x4001_5000,
    0x4001_6000,
    0x4001_8000,
    0x4001_9000,
    // NVMC.
    0x4001_e000,
];

const PPI: u32 = 0x4001_f000;
/// The interconnect's channels 17 to 31.
const FIRST_CHANNEL: u32 = 17;

/// Returns true if an access is to something that MPSL and the controller have taken.
fn is_controllers(address: u32, written: Option<u32>) -> bool {
    match (address & !0xfff, address & 0xfff) {
        // Tasks and sources of CLOCK; POWER beside it is the program's.
        (0x4000_0000, 0x000..0x020 | 0x518 | 0x538) => written.is_some(),
        // RTC0, TEMP, ECB.
        (0x4000_b000 | 0x4000_c000 | 0x4000_e000, _) => true,
        (PPI, offset) => written.is_some_and(|value| is_taken_channel(offset, value)),
        _ => false,
    }
}

/// Returns true if an access is to something that the program has in a time slot.
fn is_lent(address: u32, written: Option<u32>) -> bool {
    match address & !0xfff {
        // RADIO, TIMER0, CCM and AAR.
        0x4000_1000 | 0x4000_8000 | 0x4000_f000 => true,
        // NVMC may be looked at; flash is written by way of it.
        0x4001_e000 | FLASH..FLASH_END => written.is_some(),
        _ => false,
    }
}

/// Flash, as it is written by the core.
const FLASH: u32 = 0;
const FLASH_END: u32 = 0x1000_0000;

/// Returns true if an access is to something that the SoftDevice has taken.
fn is_softdevices(address: u32, written: Option<u32>) -> bool {
    if address & !0xfff == PPI {
        return written.is_some_and(|value| is_taken_channel(address - PPI, value));
    }
    TAKEN.contains(&(address & !0xfff))
}

fn is_taken_channel(offset: u32, value: u32) -> bool {
    match offset {
        0x500..0x50c => value >> FIRST_CHANNEL != 0,
        0x510..0x5b0 => (offset - 0x510) / 8 >= FIRST_CHANNEL,
        0x910.. => (offset - 0x910) / 4 >= FIRST_CHANNEL,
        _ => false,
    }
}
