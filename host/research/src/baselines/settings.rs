//! Training settings of the baselines.

use serde::Serialize;

/// Training settings of all baselines; the defaults are for two cores.
///
/// Against the reference's (stride 30, 12 epochs, learning rate 1e-4, an LSTM time step every sample): a higher learning rate,
/// a quarter of the windows and a third of the epochs (the validation loss is lowest after one to three), and fewer time steps.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct BaselineSettings {
    /// Samples between the ends of consecutive training windows.
    pub(crate) stride: usize,
    /// Number of passes over all training windows.
    pub(crate) epochs: usize,
    /// Number of windows per optimizer step.
    pub(crate) batch: usize,
    /// Constant learning rate.
    pub(crate) learning_rate: f64,
    /// Decoupled weight decay of every parameter.
    pub(crate) weight_decay: f32,
    /// Samples between consecutive LSTM time steps, 1 to 500.
    pub(crate) lstm_step: usize,
}

impl Default for BaselineSettings {
    fn default() -> Self {
        Self {
            stride: 120,
            epochs: 4,
            batch: 128,
            learning_rate: 5e-4,
            weight_decay: 0.01,
            lstm_step: 25,
        }
    }
}
