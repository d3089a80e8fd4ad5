//! The tables of a study, in the paper's layout, as Markdown and CSV.

mod ablation;
mod differences;
mod events;
mod folds;
mod heading;
mod offsets;
mod page;
mod scores;
mod section;
mod sheet;

pub(crate) use folds::folds;
pub(crate) use page::page;
