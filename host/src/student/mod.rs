pub mod distillation;
pub mod model;
pub mod quantization;
