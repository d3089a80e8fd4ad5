pub mod any_encoder;
pub mod distillation;
pub mod model;
pub mod quantization;
