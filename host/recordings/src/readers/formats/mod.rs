//! A reader for each format that no description reads: bytes or text of a file in, recordings or damage out.

pub(crate) mod emg_epn;
pub(crate) mod libemg;
