//! Refusals of the emulated chip: a real one would do something that the program does not mean.

use std::fmt;

/// Reason to refuse an access, a task or a call.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum What {
    /// The table of the peripheral does not list it.
    #[error("is not modelled: add it to the peripheral's table, with what it does")]
    NotModelled,
    /// The place belongs to no peripheral of this chip.
    #[error("belongs to no peripheral of this chip")]
    NoPeripheral,
    /// Peripherals take whole words alone (product specification, 6.1.3).
    #[error("is accessed with {bytes} bytes: expected a word of 4")]
    Width {
        /// Bytes of the access.
        bytes: usize,
    },
    /// A task or a register that is written alone.
    #[error("is read: it can only be written")]
    NotReadable,
    /// A status.
    #[error("is written {value:#x}: it can only be read")]
    NotWritable {
        /// Value that was written.
        value: u32,
    },
    /// An event that the program sets.
    #[error("is written {value:#x}: a program writes 0 to an event, to clear it")]
    EventSet {
        /// Value that was written.
        value: u32,
    },
    /// Reserved bits.
    #[error("is written {value:#x}: the bits {reserved:#x} are reserved")]
    Reserved {
        /// Value that was written.
        value: u32,
        /// Reserved bits of the register.
        reserved: u32,
    },
    /// A value that the register does not know.
    #[error("is written {value:#x}: {expected}")]
    Value {
        /// Value that was written.
        value: u32,
        /// Description of the values that are allowed.
        expected: &'static str,
    },
    /// A task that makes no sense now.
    #[error("is triggered {when}")]
    Untimely {
        /// State in which it was triggered, in words.
        when: &'static str,
    },
    /// A pin that is used for something else.
    #[error("is configured for something else: {why}")]
    Pin {
        /// Holder of the pin, or what the pin lacks.
        why: &'static str,
    },
    /// The interconnect leads to no task.
    #[error("is the end of a channel of the interconnect, and is no task")]
    NoTask,
    /// The interconnect comes from no event.
    #[error("is the start of a channel of the interconnect, and is no event")]
    NoEvent,
    /// DMA reaches RAM alone.
    #[error("is given {address:#010x} and {length} bytes: DMA reaches RAM alone")]
    NoDma {
        /// Address of the buffer.
        address: u32,
        /// Bytes of the buffer.
        length: u32,
    },
    /// A part of the chip that the SoftDevice has taken.
    #[error("belongs to the SoftDevice, which is enabled")]
    SoftDevices,
    /// A part of the chip that Nordic's controller library has taken.
    #[error("belongs to the controller's library, which is initialized")]
    Controllers,
    /// An instruction of Nordic's library that is not the start of a function that is modelled.
    #[error("is an instruction of Nordic's library, none of which is executed")]
    LibraryCode,
    /// A call with this number is not modelled.
    #[error("is a call that is not modelled, with the arguments {arguments:x?}")]
    UnknownCall {
        /// Its arguments.
        arguments: [u32; 4],
    },
    /// A call that the SoftDevice or the library does not expect.
    #[error("is a call {why}")]
    WrongCall {
        /// Description of what is wrong.
        why: String,
    },
    /// An interrupt with a priority of somebody else's.
    #[error(
        "comes while interrupt {interrupt} has priority {priority}: a SoftDevice reserves 0, 1 and 4, the controller's library takes 0 for RADIO, TIMER0 and RTC0 alone"
    )]
    Priority {
        /// Its number.
        interrupt: u16,
        /// Its priority.
        priority: u8,
    },
    /// A supervisor call in an IT block: the emulated core would lose its state.
    #[error("is a supervisor call in an IT block, which the emulated core does not support")]
    CallInItBlock,
    /// Sleep after which RAM may hold anything.
    #[error(
        "sleeps, and RAM cannot be trusted afterwards: erratum 108 asks for a write to 0x40000ee4 before"
    )]
    RamIsLost,
    /// Two faults, one in the other.
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

/// Creates the reason to refuse a call.
pub fn wrong(why: &str) -> What {
    What::WrongCall {
        why: why.to_owned(),
    }
}
