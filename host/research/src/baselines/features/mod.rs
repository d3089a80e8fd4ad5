//! Input features of the baselines, computed from one window of EMG.

mod extraction;
mod moving;
mod scaling;

pub(super) use extraction::FeatureExtraction;
