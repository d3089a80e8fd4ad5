//! What the tasks send each other: two queues, one shared state, three heartbeats.
//!
//! ```text
//! radio ---packets---> inference ---UartMessage---> output ---> UART
//!   |                      |                          ^
//!   +----------------------+--------- PinState -------+-------> pins, LEDs
//!
//! radio, inference, output ---Heartbeat---> watchdog
//! ```

pub mod heartbeat;
pub mod packets;
pub mod pin_state;
mod queue;
pub mod uart;
