//! Sources of a stream, as the messages that the page takes; without I/O, on a PC and as WebAssembly in a browser.
//!
//! ```text
//! source: playback, board, armband   -- events -->  the page (host/web/page)
//!                                    <- requests -
//! ```
//!
//! `myointent live` runs the sources on a thread and serves the page; in the page that needs no program, [`tab`] runs them
//! in a worker.

#![deny(missing_docs)]
#![deny(unsafe_code)]

pub mod armband;
pub mod board;
pub mod calibration;
pub mod demo;
mod dialogue;
pub mod electrodes;
pub mod event;
#[cfg(target_family = "wasm")]
mod exports;
pub mod installer;
pub mod outcome;
pub mod page;
pub mod person;
pub mod playback;
pub mod radio;
pub mod record;
pub mod request;
pub mod scored_pipeline;
mod scores;
mod shared_cue;
pub mod tab;

pub use self::dialogue::Losses;
pub use self::shared_cue::SharedCue;
/// Shipped three-class model.
pub use models::THREE_CLASS as SHIPPED;
