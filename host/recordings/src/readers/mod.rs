//! Files of recordings: the published formats, and what their readers share.

pub(crate) mod error;
pub mod label_file;
pub(crate) mod libemg;
pub mod mat;
pub mod npy;
pub mod open;
pub mod path;
pub(crate) mod table;
