//! Input features of the baselines, computed from one window of EMG.

mod butterworth;
mod extraction;
mod scaling;
mod spectrum;
mod time_domain;

pub(super) use extraction::{FILTER_ORDERS, FeatureExtraction};
