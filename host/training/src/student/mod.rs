//! The student: the float twin of the device's encoder, its training by distillation, its quantization.

mod batch;
pub mod dequantization;
pub mod ensemble;
mod forward;
#[cfg(feature = "flex")]
mod fused;
pub mod learner;
pub mod model;
pub mod onnx;
pub(crate) mod quantization;
mod sequence;
