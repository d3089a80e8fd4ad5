//! Inference over whole recordings with the float models: the logits at every patch, in the form of
//! [`evaluation::inference`].

mod student;
mod teacher;

pub use student::student_logits;
pub use teacher::teacher_logits;

#[cfg(test)]
mod tests;
