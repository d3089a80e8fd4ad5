//! Equality with the numbers of the published reference code.

#[path = "golden/cases.rs"]
mod cases;
#[path = "golden/files.rs"]
mod files;
#[path = "golden/masking.rs"]
mod masking;
#[path = "golden/model.rs"]
mod model;
#[path = "golden/schedule.rs"]
mod schedule;
#[path = "golden/smoother.rs"]
mod smoother;
#[path = "golden/statistics.rs"]
mod statistics;
#[path = "golden/training_step.rs"]
mod training_step;
#[path = "golden/transition.rs"]
mod transition;
