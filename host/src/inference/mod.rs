//! Inference over whole recordings: the logits of a model at every patch.
//!
//! The output has one form for teacher, float student and integer student: after each patch, logits of
//! that patch and of the five before it ([`LookBackLogits`](shared::model::LookBackLogits), newest
//! first, unused classes 0). The code that smooths and scores them is the same for all models.

mod device;
mod student;
mod teacher;

pub use device::{integer_logits, outputs};
pub(crate) use student::student_logits;
pub(crate) use teacher::teacher_logits;

#[cfg(test)]
mod tests;
