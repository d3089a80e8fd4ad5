//! The armband, from an advertisement to samples in order: what to do next, and never how.
//!
//! Nothing here does I/O, reads a clock or knows a radio. An adapter tells [`MyoSession`] what
//! happened and when, and carries out the [`Action`]s that come back, in their order:
//!
//! ```text
//! radio --Event, Millis--> MyoSession --Action--> radio     Scan, Connect, Discover, Read, Write ...
//!                               |
//!                               +-----Action----> pipeline  Deliver, Gap, StreamEnded
//! ```
//!
//! The way in: [`advertisement`] finds the armband, [`characteristic`] and [`uuid`] name what it
//! offers, [`command`] tells it what to do, [`packet`] reads what it sends, and a sequence of
//! [`lane`]s becomes one stream again. What the armband does is stated by nobody but those who
//! watched it: the numbers come from the vendor's header `myohw.h` and from open drivers.

pub mod action;
pub mod address;
pub mod advertisement;
mod back_off;
pub mod characteristic;
pub mod command;
pub mod counters;
pub mod event;
pub mod lane;
mod order;
mod pace;
pub mod packet;
mod scan;
mod sequence;
pub mod session;
mod set_up;
mod stream;
pub mod uuid;

pub use action::{Action, Payload};
pub use address::{Address, AddressKind};
pub use characteristic::{Characteristic, Found, Service};
pub use command::{Command, EmgMode};
pub use counters::Counters;
pub use event::Event;
pub use lane::Lane;
pub use packet::{FirmwareVersion, Pair};
pub use session::{MyoSession, Phase, Settings};
pub use uuid::Uuid;

use crate::units::Millis;

/// Milliseconds from `earlier` to `now`; none have passed where the clock seems to run backwards,
/// as it does when a callback's stamp is handed on late.
const fn elapsed(now: Millis, earlier: Millis) -> u32 {
    let difference = now.since(earlier);
    if difference > i32::MAX as u32 {
        0
    } else {
        difference
    }
}
