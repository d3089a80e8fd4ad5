//! What the product does not need: the paper's baselines, its comparisons and their tables, and the
//! reference's offline aggregation.

pub mod baselines;
pub mod cli;
pub mod comparison;
pub mod offline;
