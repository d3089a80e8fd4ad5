//! Offline aggregation as in the reference: labels of a whole recording from its overlapping windows.
//!
//! The paper's numbers were computed this way: look-ahead of 50 samples, hold of 20, mean logits of all
//! rows from a sample on. It is more favourable than streaming. Before the first window ends, that window
//! classifies samples whose future it contains, and a label is assigned to the sample it refers to, as if
//! the look-ahead took no time. The causal form that devices run is `shared::stream::smoother`.
//!
//! One detail of the reference is left out: it ignores a row whose logit of class 0 is exactly -1.0.
//! Source: ReactEMG's public code; compared with its output in `tests/golden/offline.rs`.

mod aggregation;
mod error;
mod windows;

pub use aggregation::{OfflineAggregation, Vote};
pub use error::OfflineError;
pub use windows::WindowLogits;
