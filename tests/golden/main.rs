//! Equality with the numbers of the published reference code.

mod cases;
mod files;
mod masking;
mod model;
mod schedule;
mod smoother;
mod statistics;
mod training_step;
mod transition;
