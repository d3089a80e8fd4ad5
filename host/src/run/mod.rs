//! A run: the preset, the resolved configuration, and the steps from recordings to a judged model file.

pub mod plan;
pub mod preset;
pub mod stage;
pub mod trial;
