//! Steps of a stream beside the model: link sequence numbers, normalization to the
//! wearer, alignment, preprocessing, the sample ring, the smoother, the lock, the safe
//! state, the strength.

pub mod alignment;
pub mod link_sequence;
pub mod lock;
pub mod normalizer;
pub mod preprocess;
pub mod ring;
pub mod safe_state;
pub mod smoother;
pub mod strength;
