//! Evaluation: from a model's logits over whole recordings to labels and to scores of these labels.

mod candidate;
mod condition;
pub mod metric;
mod score;
mod smoothing;
mod trial;

pub use candidate::Candidate;
pub use condition::{LookAhead, Truth};
pub use score::{ALL, BUFFERS, EvaluationError, Score};
pub(crate) use score::{confusion, offsets, score};
pub(crate) use smoothing::smooth;
pub use trial::Trial;
