//! Commands that work on a run folder: the steps of a run, and all of them at once.

pub(super) mod distill;
pub(super) mod evaluate;
pub(super) mod export;
pub(super) mod quantize;
pub(super) mod quickstart;
pub(super) mod train;
