//! Equality with the numbers that the published reference code gave.

#[path = "golden/cases.rs"]
mod cases;
#[path = "golden/files.rs"]
mod files;
#[path = "golden/offline.rs"]
mod offline;
#[path = "golden/preprocess.rs"]
mod preprocess;
#[path = "golden/smoother.rs"]
mod smoother;
#[path = "golden/transition.rs"]
mod transition;
