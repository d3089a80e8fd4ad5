//! Communication between the tasks: queues, shared states, three heartbeats.
//!
//! ```text
//! radio ---packets---> inference ---UartMessage---> output ---> UART, USB
//!   |                      |                          ^
//!   +----------------------+--------- PinState -------+-------> pins, LEDs
//!   |                      |                          |
//!   +------Requests--------+------- control --Answer--+
//!   +-- installation <-----+----------+
//!
//! radio, inference, output ---Heartbeat---> watchdog
//! ```

pub mod armband;
#[cfg(any(feature = "uf2", test))]
pub mod battery;
pub mod calibration;
pub mod heartbeat;
#[cfg(feature = "uf2")]
pub mod hid;
#[cfg(feature = "uf2")]
pub mod imu;
pub mod model;
pub mod packets;
pub mod pin_state;
mod queue;
pub mod raw;
pub mod requests;
pub mod uart;
#[cfg(any(feature = "uf2", test))]
pub mod usb;
