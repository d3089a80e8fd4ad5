//! The session with a Myo armband as a state machine without I/O: from an advertisement to samples in
//! order.
//!
//! Nothing here reads a clock or depends on a radio. A radio driver passes events and their time to
//! [`MyoSession`] and carries out the [`Action`]s that it returns, in order:
//!
//! ```text
//! radio --MyoEvent, Millis--> MyoSession --Action--> radio     Scan, Connect, Discover, Read, Write ...
//!                                  |
//!                                  +-----Action----> pipeline  Deliver, Gap, StreamEnded
//! ```
//!
//! The session follows one armband: its settings' or the bound one. [`binding`] keeps it over restarts.
//!
//! `advertisement` recognises the armband, `characteristic` and `uuid` identify its GATT attributes,
//! `command` encodes commands, `packet` parses values, and `sequence` merges the notifications of four
//! lanes into one stream. Sources: the vendor's header `myohw.h`,
//! open drivers and captures; there is no full specification.

mod action;
mod address;
mod advertisement;
mod arrival_timing;
pub mod attribute_pdu;
mod back_off;
pub mod binding;
mod characteristic;
mod command;
mod connection_parameters;
mod counters;
mod discovery;
mod event;
mod lane;
mod order;
mod packet;
mod progress;
mod scan;
mod sequence;
mod session;
mod set_up;
pub mod signaling;
mod stream_monitor;
mod uuid;

pub use action::{Action, Payload};
pub use address::{Address, AddressError, AddressKind};
pub use characteristic::{Characteristic, Found};
pub use command::EmgMode;
pub use connection_parameters::{ConnectionParameters, LOOK_MS, ParameterHold};
pub use counters::Counters;
pub use discovery::{Attribute, Discovery};
pub use event::MyoEvent;
pub use lane::Lane;
pub use packet::{FirmwareVersion, Imu, Pair};
pub use progress::RadioProgress;
pub use session::{Following, MyoSession, Phase, Settings};
pub use uuid::Uuid;

/// Whether a session knows the IMU.
const IMU: bool = cfg!(any(feature = "imu", test));
