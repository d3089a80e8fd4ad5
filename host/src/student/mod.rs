pub mod any_encoder;
pub mod distillation;
pub mod model;
