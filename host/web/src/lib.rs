//! Sources of a stream, as the messages that the page takes; without I/O, on a PC and as WebAssembly in a browser.
//!
//! ```text
//! source: playback, board, armband   -- events -->  the page (host/web/page)
//!                                    <- requests -
//! ```
//!
//! [`engine`] runs a source, on a thread of `myointent live` or in a worker of the page that needs no program.

#![deny(missing_docs)]
#![deny(unsafe_code)]

pub mod armband;
mod blocks;
pub mod board;
pub mod calibration;
pub mod demo;
mod dialogue;
mod electrodes;
pub mod engine;
pub mod event;
#[cfg(target_family = "wasm")]
mod exports;
mod flashed;
pub mod installer;
pub mod outcome;
pub mod page;
pub mod person;
pub mod playback;
pub mod radio;
pub mod record;
pub mod request;
pub mod said;
pub mod scored_pipeline;
mod scores;
mod simulated_armband;
mod simulated_board;

/// Shipped three-class model.
pub use models::THREE_CLASS as SHIPPED;
