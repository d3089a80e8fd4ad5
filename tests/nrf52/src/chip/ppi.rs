//! PPI, the programmable interconnect (product specification, 6.16): an event of one peripheral starts tasks of others.
//! The fixed channels 20 to 31 belong to the radio, which is not modelled; neither are groups.

use super::register::{Registers, registers};

/// Channels with ends of one's own.
const CHANNELS: u32 = 20;

registers![
    CHEN = read_write(0x500, !0),
    CHENSET = set(0x504, CHEN, !0),
    CHENCLR = clear(0x508, CHEN, !0),
    CH_EEP = read_write(0x510, !0).times(CHANNELS).every(8),
    CH_TEP = read_write(0x514, !0).times(CHANNELS).every(8),
    FORK_TEP = read_write(0x910, !0).times(32),
];

pub fn new() -> Registers {
    Registers::new("PPI", 0x4001_f000, TABLE)
}

/// Addresses of the tasks that an event starts.
pub fn tasks(ppi: &Registers, event: u32) -> Vec<u32> {
    let enabled = ppi.get(CHEN);
    (0..CHANNELS)
        .filter(|channel| enabled >> channel & 1 == 1)
        .filter(|channel| ppi.get(CH_EEP + 8 * channel) == event)
        .flat_map(|channel| [CH_TEP + 8 * channel, FORK_TEP + 4 * channel])
        .map(|offset| ppi.get(offset))
        .filter(|task| *task != 0)
        .collect()
}

/// Both ends of a register that names one: whether it is an event's, and the address.
pub fn end(ppi: &Registers, offset: u32) -> Option<(bool, u32)> {
    let in_channels = (CH_EEP..CH_EEP + 8 * CHANNELS).contains(&offset);
    let is_event = in_channels && (offset - CH_EEP).is_multiple_of(8);
    let address = ppi.get(offset);
    (address != 0 && (in_channels || offset >= FORK_TEP)).then_some((is_event, address))
}
