//! Samples on their way from the radio to the inference.

use shared::stream::link_sequence::Packet;

use super::queue::Queue;

/// Queue of 32 packets of two samples: 320 ms.
pub type Packets = Queue<Packet, 32>;

/// Packets from the radio to the inference.
pub static PACKETS: Packets = Queue::new();
