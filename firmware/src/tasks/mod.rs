//! The four tasks and what lies between them.
//!
//! ```text
//! radio --Packets--> inference --Lines--> output --> UART
//!                        |                   ^
//!                        +---Shown-----------+-----> pins, LEDs
//! watchdog: feeds while the other three come round
//! ```
//!
//! All run on one executor in thread mode, in turns. The longest turn is one patch of inference,
//! far below the 300 ms of notifications that the radios keep waiting.

pub mod inference;
pub mod output;
pub mod radio;
pub mod watchdog;

use shared::stream::link_sequence::Packet;

use crate::queue::Queue;

/// Samples on their way to the inference: 320 ms of them.
pub type Packets = Queue<Packet, 32>;

/// See [`Packets`].
pub static PACKETS: Packets = Queue::new();
