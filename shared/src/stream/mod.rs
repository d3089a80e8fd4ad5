//! From raw samples to a label in time: cleaning, the window's ring, smoothing, the safe state.

pub mod link_sequence;
pub mod preprocess;
pub mod ring;
pub mod safe_state;
pub mod smoother;
