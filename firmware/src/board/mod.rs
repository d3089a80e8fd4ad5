//! Pins, clocks and wiring of a board; no decisions.

mod nrf52840;

pub use nrf52840::Board;
