//! Virtual Myo armband for tests, without a clock and without a radio: its driver passes the time.
//!
//! The simulated board (`firmware/src/board/simulated`) and the emulated chip (`tests/nrf52`) put their radios in front
//! of it. Scenarios and the files that boards write are the same for both, and are here too.
#![deny(missing_docs)]
#![forbid(unsafe_code)]

mod armband;
mod behaviour;
pub mod gatt;
mod output;
mod scenario;

pub use armband::{Armband, Notification};
pub use behaviour::{ArmbandFault, Behaviour, Corruption, End};
pub use output::{EVENTS, LEVELS, LINES, PinLevels};
pub use scenario::{ADDRESS, Act, Acts, BoardFault, Scenario, Stranger, armbands, framed};
