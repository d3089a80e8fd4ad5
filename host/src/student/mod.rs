pub mod distillation;
pub mod model;
