//! Input features of the baselines: what each computes from one window of EMG.

mod butterworth;
mod extraction;
mod scaling;
mod spectrum;
mod time_domain;

pub(super) use extraction::{FILTER_ORDERS, FeatureExtraction};
