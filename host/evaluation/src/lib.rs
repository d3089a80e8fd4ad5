//! Evaluation: from a model's logits over whole recordings to labels and to scores of these labels.

#![deny(missing_docs)]

pub mod calibration;
mod candidate;
mod condition;
mod cued;
mod difference;
mod error;
mod evaluated_recording;
#[cfg(test)]
mod fixture;
mod floor;
mod group;
pub mod inference;
pub mod label_files;
pub mod label_score;
mod measure;
pub mod metric;
pub mod model_evaluation;
pub mod report;
pub mod results;
mod score;
mod smoothing;
mod system;

pub use candidate::{Candidate, integer_candidate};
pub use condition::{LookAhead, Truth};
pub use cued::{Cued, cued};
pub use difference::Difference;
pub use error::EvaluationError;
pub use evaluated_recording::EvaluatedRecording;
pub use floor::{EnergyDetector, constant};
pub use group::Group;
pub use measure::Measure;
pub use score::{ALL, BUFFERS, Score, score, score_all, score_labels};
pub use score::{confusion, gestures};
pub use smoothing::{SmoothedLabels, smooth};
pub use system::{CONSTANT, ENERGY, System};
