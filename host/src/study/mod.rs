//! The paper's comparisons on the recordings at hand.

pub mod job;
pub mod variant;
