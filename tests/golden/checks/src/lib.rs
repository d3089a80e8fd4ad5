//! Golden checks, equal on a PC and on the emulated core.
//!
//! The PC reads the reference's files (tests/golden) into a [`Check`], and runs it or passes it as bytes to an image
//! for the emulated core.
#![no_std]
#![deny(missing_docs)]
#![forbid(unsafe_code)]

extern crate alloc;

pub mod preprocess;
pub mod smoother;

use alloc::vec::Vec;

use serde::{Deserialize, Serialize};

use preprocess::Recording;
use smoother::Set;

/// Check with its data.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub enum Check {
    /// Data of [`preprocess::whole`].
    WholeRecordings(Vec<Recording>),
    /// Data of [`preprocess::stream`].
    Stream(Vec<Recording>),
    /// Data of [`preprocess::rectified_first`].
    RectifiedFirst(Vec<Recording>),
    /// Data of [`preprocess::live_edges`].
    LiveEdges(Vec<Recording>),
    /// Data of [`smoother::live`].
    LiveLabels(Vec<Set>),
}

impl Check {
    /// Checks every case.
    ///
    /// # Panics
    /// Panics at the first case that differs from the reference, or if there is no case.
    pub fn run(&self) {
        let count = match self {
            Self::WholeRecordings(recordings) => each(recordings, preprocess::whole),
            Self::Stream(recordings) => each(recordings, preprocess::stream),
            Self::RectifiedFirst(recordings) => each(recordings, preprocess::rectified_first),
            Self::LiveEdges(recordings) => each(recordings, preprocess::live_edges),
            Self::LiveLabels(sets) => each(sets, smoother::live),
        };
        assert!(count > 0, "nothing to check");
    }
}

fn each<T>(cases: &[T], check: fn(&T)) -> usize {
    cases.iter().for_each(check);
    cases.len()
}
