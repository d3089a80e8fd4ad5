//! From a model's outputs over whole recordings to labels and to numbers about them.

pub mod judge;
pub mod metric;
pub mod track;
pub mod trial;
