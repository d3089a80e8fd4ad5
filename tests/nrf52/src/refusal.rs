//! Refusals of the emulated chip: a real one would do something that the program does not mean.

use std::fmt;

/// Reason to refuse an access, a task or a call.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum What {
    #[error("is not modelled: add it to the peripheral's table, with what it does")]
    NotModelled,
    #[error("belongs to no peripheral of this chip")]
    NoPeripheral,
    /// Peripherals take whole words alone (product specification, 6.1.3).
    #[error("is accessed with {bytes} bytes: expected a word of 4")]
    Width { bytes: usize },
    #[error("is read: it can only be written")]
    NotReadable,
    #[error("is written {value:#x}: it can only be read")]
    NotWritable { value: u32 },
    #[error("is written {value:#x}: a program writes 0 to an event, to clear it")]
    EventSet { value: u32 },
    #[error("is written {value:#x}: the bits {reserved:#x} are reserved")]
    Reserved { value: u32, reserved: u32 },
    #[error("is written {value:#x}: {expected}")]
    Value { value: u32, expected: &'static str },
    #[error("is triggered {when}")]
    Untimely { when: &'static str },
    #[error("is configured for something else: {why}")]
    Pin { why: &'static str },
    #[error("is the end of a channel of the interconnect, and is no task")]
    NoTask,
    #[error("is the start of a channel of the interconnect, and is no event")]
    NoEvent,
    #[error("is given {address:#010x} and {length} bytes: DMA reaches RAM alone")]
    NoDma { address: u32, length: u32 },
    #[error("belongs to the SoftDevice, which is enabled")]
    SoftDevices,
    #[error("belongs to the controller's library, which is initialized")]
    Controllers,
    #[error("is an instruction of Nordic's library, none of which is executed")]
    LibraryCode,
    #[error("is a call that is not modelled, with the arguments {arguments:x?}")]
    UnknownCall { arguments: [u32; 4] },
    #[error("is a call {why}")]
    WrongCall { why: String },
    #[error(
        "comes while interrupt {interrupt} has priority {priority}: a SoftDevice reserves 0, 1 and 4, the controller's library takes 0 for RADIO, TIMER0 and RTC0 alone"
    )]
    Priority { interrupt: u16, priority: u8 },
    #[error("is a supervisor call in an IT block, which the emulated core does not support")]
    CallInItBlock,
    #[error(
        "sleeps, and RAM cannot be trusted afterwards: erratum 108 asks for a write to 0x40000ee4 before"
    )]
    RamIsLost,
    #[error("is where the core locked up")]
    LockedUp,
}

/// Something that was refused, and where.
#[derive(Clone, Debug, thiserror::Error)]
pub struct Refusal {
    /// Milliseconds since power came.
    pub at_ms: f64,
    /// Name of the register, address or call that was accessed.
    pub subject: String,
    /// Reason for the refusal.
    pub what: What,
    /// Place at which the program was: a function or an address.
    pub place: String,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            at_ms,
            subject,
            what,
            place,
        } = self;
        write!(f, "at {at_ms:.3} ms, in {place}: {subject} {what}")
    }
}

/// Refuses a call unless its condition is met.
pub fn needs(is_met: bool, otherwise: &str) -> Result<(), What> {
    match is_met {
        true => Ok(()),
        false => Err(wrong(otherwise)),
    }
}

/// Creates the reason to refuse a call.
pub fn wrong(why: &str) -> What {
    What::WrongCall {
        why: why.to_owned(),
    }
}
