//! Alignment on recordings: the template of a model, and the gestures with which a person would align the armband.
//!
//! The device's side is [`shared::stream::alignment`]. Measurements are in docs/alignment.md.

mod open_hand;
mod openings;
pub(crate) mod rotation;
mod template;

pub use open_hand::open_hand;
pub use openings::{Openings, openings};
pub use template::{FEWEST_PEOPLE, template};
