//! The five tasks. They meet only in [`messages`](crate::messages).
//!
//! All run on one executor in thread mode, in turns. The longest turn is one patch of inference,
//! 3.5 ms on a chip (estimated, without wait states); `trouble` queues 320 ms of notifications meanwhile.

#[cfg(feature = "uf2")]
pub mod battery;
pub mod control;
pub mod inference;
pub mod output;
pub mod radio;
pub mod watchdog;
