//! Windows of recordings: the input of a baseline at one instant, and the labels of its frames.

mod corpus;
mod frame_layout;

pub(super) use corpus::{PaddedStream, Window, WindowedCorpus};
pub(super) use frame_layout::FrameLayout;
