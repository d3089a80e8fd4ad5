//! The student: its float network, its distillation and its quantization.

pub mod distillation;
pub mod model;
pub mod quantization;
