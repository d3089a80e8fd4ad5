//! Two of the paper's baselines, LSTM and ED-TCN, trained and evaluated like the product's own models: same recordings,
//! split, smoother and metrics. Input features, network and training settings are their own.
//!
//! [`FeatureExtraction`] makes features of a window, a [`Network`](networks::Network) makes logits of the features, and
//! [`FrameLayout`](windows::FrameLayout) makes [`LookBackLogits`](shared::model::LookBackLogits) of the logits of the window's
//! frames. Dimensions are those of the reference's code, which differs from the paper's text in places.
//!
//! [`FeatureExtraction`]: features::FeatureExtraction

mod baseline;
mod features;
pub(crate) mod inference;
mod networks;
pub(crate) mod settings;
pub(crate) mod training;
mod windows;

pub(crate) use baseline::Baseline;
