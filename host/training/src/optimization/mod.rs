//! Training of teacher, student and baselines: the loop, the learning-rate schedule, weight averaging, the loss, dropout,
//! augmentation.

mod checkpoint;
pub mod dropout;
mod ema;
mod epoch;
pub mod fit;
#[cfg(feature = "flex")]
pub(crate) mod kernels;
pub mod learner;
pub mod loss;
pub(crate) mod metrics;
pub mod optimizer;
pub mod tensor;
pub(crate) mod tune;
