//! Files of recordings: the published formats, and what their readers share.

pub(crate) mod error;
pub(crate) mod formats;
pub mod label_file;
pub mod mat;
pub mod npy;
pub mod open;
pub mod path;
pub(crate) mod table;
