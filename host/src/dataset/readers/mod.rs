//! Files of recordings: the published formats, and what their readers share.

pub(crate) mod error;
pub(crate) mod excerpt;
pub(crate) mod formats;
pub(crate) mod label_file;
mod labels;
mod layout;
pub(crate) mod mat;
pub mod npy;
pub(crate) mod open;
mod path;
mod table;
mod text;
pub(crate) mod why;
