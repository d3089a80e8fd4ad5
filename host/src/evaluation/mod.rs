//! Evaluation: from a model's logits over whole recordings to labels and to scores of these labels.

mod candidate;
mod condition;
mod cued;
mod difference;
mod floor;
mod group;
mod measure;
pub mod metric;
mod score;
mod smoothing;
mod trial;

pub use candidate::Candidate;
pub use condition::{LookAhead, Truth};
pub use cued::{Cued, cued};
pub use difference::Difference;
pub use floor::{CONSTANT, ENERGY, EnergyDetector, constant};
pub use group::Group;
pub use measure::Measure;
pub use score::{ALL, BUFFERS, EvaluationError, Score, score, score_all};
pub(crate) use score::{confusion, gestures};
pub(crate) use smoothing::smooth;
pub use trial::Trial;
