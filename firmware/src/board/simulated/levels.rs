//! The levels of all outputs as a line of text, for outputs that cannot be measured.

use core::fmt;

use shared::intent::Intent;

use crate::messages::pin_state::PinState;

/// `PINS`, the time, the time of the newest packet, then every level.
pub struct Levels {
    pub now_us: u64,
    /// Time at which the newest byte of a packet was received, on the same clock.
    pub last_received_us: u64,
    pub state: PinState,
}

impl fmt::Display for Levels {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            now_us,
            last_received_us,
            state,
        } = self;
        let valid = u8::from(state.status.valid());
        write!(formatter, "PINS {now_us} {last_received_us} valid={valid}")?;
        for intent in Intent::ALL {
            let level = u8::from(intent == state.status.label());
            write!(formatter, " {}={level}", intent.name())?;
        }
        let (armband, led) = (u8::from(state.armband), u8::from(state.alignment_led));
        writeln!(formatter, " armband={armband} alignment={led}")
    }
}
