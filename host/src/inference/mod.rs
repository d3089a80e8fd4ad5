//! What a model says at every patch of a recording, whichever model it is.
//!
//! Teacher, float student and integer student give the same: after each patch, logits for that patch
//! and the five before it ([`LookBackLogits`](shared::model::LookBackLogits), newest first, unused
//! classes 0). Everything after this point is the same code for all.

pub mod device;
mod student;
mod teacher;

pub use device::integer_logits;
pub use student::student_logits;
pub use teacher::teacher_logits;
