//! What teacher, student and baselines share to be trained: the loop, the schedule, losses, dropout.

pub mod augmentation;
pub mod dropout;
pub mod ema;
pub mod fit;
pub mod loss;
pub mod schedule;
pub mod tensor;
