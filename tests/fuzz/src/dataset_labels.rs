//! What the readers import of the host's `dataset::labels`.

#[path = "../../../host/src/dataset/labels/activity.rs"]
pub(crate) mod activity;
#[path = "../../../host/src/dataset/labels/envelope.rs"]
mod envelope;
#[path = "../../../host/src/dataset/labels/lag.rs"]
pub mod lag;
#[path = "../../../host/src/dataset/labels/motion.rs"]
pub(crate) mod motion;
#[path = "../../../host/src/dataset/labels/runs.rs"]
pub(crate) mod runs;
