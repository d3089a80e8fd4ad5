//! Files of recordings: the published formats, and what their readers share.

mod beside;
mod columns;
pub(crate) mod error;
pub mod excerpt;
mod fault;
pub mod formats;
pub mod label_file;
mod labels;
pub mod mat;
pub mod npy;
pub mod open;
pub(crate) mod path;
mod recognition;
pub(crate) mod separator;
mod shape;
mod table;
mod text;
pub(crate) mod why;
