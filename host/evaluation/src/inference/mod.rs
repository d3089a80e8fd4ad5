//! Inference over whole recordings, as a device does it: the logits of a model file at every patch.
//!
//! The output has one form for teacher, float student and integer student: after each patch, logits of
//! that patch and of the five before it ([`LookBackLogits`](shared::model::LookBackLogits), newest
//! first, unused classes 0). The code that smooths and scores them is the same for all models.

use shared::stream::normalizer::Normalizer;
use shared::stream::preprocess::{Preprocessing, clean};
use shared::units::{CleanSample, Sample};

mod device;
pub mod stream;

pub use device::{integer_logits, outputs};

/// Input of a model from the samples of a stream, from its beginning: preprocessed as in training, and as a board does
/// it.
#[must_use]
pub fn input(samples: &[Sample], preprocessing: Preprocessing) -> Vec<CleanSample> {
    let mut wearer = preprocessing.normalized.then(Normalizer::new);
    let samples = samples.iter().map(|&sample| match &mut wearer {
        Some(wearer) => wearer.push(sample),
        None => sample,
    });
    clean(samples, preprocessing.median).collect()
}
