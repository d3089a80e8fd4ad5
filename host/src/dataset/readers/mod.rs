//! Files of recordings: the published formats, and what their readers share.

mod beside;
mod columns;
pub(crate) mod error;
pub(crate) mod excerpt;
mod fault;
pub(crate) mod formats;
pub(crate) mod label_file;
mod labels;
pub(crate) mod mat;
pub mod npy;
pub(crate) mod open;
pub(crate) mod path;
mod recognition;
pub(crate) mod separator;
mod shape;
mod table;
mod text;
pub(crate) mod why;
