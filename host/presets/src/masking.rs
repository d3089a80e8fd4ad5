//! Random masks: the samples of a window that the model does not see and has to predict.
//!
//! The distribution is that of the reference implementation with its curriculum switched off: Poisson
//! spans, the end of the window, around a transition, or everything.

use rand::RngExt;
use rand_distr::{Distribution, Poisson};
use serde::{Deserialize, Serialize};

/// Mean length of a masked span, in samples (lambda of the Poisson draw).
const SPAN_MEAN: f64 = 7.0;
/// Samples masked on either side of a transition.
pub const TRANSITION_BUFFER: usize = 50;

/// A training task: what is masked and has to be predicted.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Task {
    /// EMG is visible, intents are masked.
    Intent,
    /// Intents are visible, EMG is masked.
    Emg,
    /// EMG and intents are masked.
    Joint,
    /// EMG is masked, attention to and from intents is blocked: for windows without labels.
    SelfSupervised,
}

/// Masks of one window, one flag per sample; `true` masks the sample and puts it into the loss.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Masks {
    /// Masked EMG samples, all eight channels together.
    pub emg: Vec<bool>,
    /// Masked intents.
    pub intent: Vec<bool>,
    /// Whether attention between EMG and intents is blocked.
    pub blocked: bool,
}

/// Arrangement of the masked samples.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum MaskType {
    PoissonSpans,
    EndOfWindow,
    AroundTransition,
    Everything,
}

impl Task {
    /// Draws the masks of a window of `window` samples.
    ///
    /// `last_before_change` is the position of the last sample before the window's first label change,
    /// if there is one.
    pub fn draw(
        self,
        window: usize,
        last_before_change: Option<usize>,
        rng: &mut impl RngExt,
    ) -> Masks {
        let mut emg = vec![false; window];
        let mut intent = emg.clone();
        match self {
            Self::Intent => {
                let mask_type = intent_mask_type(window, last_before_change, rng);
                let fraction = fraction(mask_type, rng);
                intent = draw_mask(window, mask_type, fraction, last_before_change, rng);
            }
            Self::Emg | Self::Joint => {
                // One type and one fraction for both modalities, but spans of their own.
                let mask_type = span_or_end(rng);
                let fraction = fraction(mask_type, rng);
                emg = draw_mask(window, mask_type, fraction, None, rng);
                if self == Self::Joint {
                    intent = draw_mask(window, mask_type, fraction, None, rng);
                }
            }
            Self::SelfSupervised => {
                let fraction = rng.random_range(0.20..0.65);
                emg = draw_mask(window, MaskType::PoissonSpans, fraction, None, rng);
            }
        }
        Masks {
            emg,
            intent,
            blocked: self == Self::SelfSupervised,
        }
    }
}

fn span_or_end(rng: &mut impl RngExt) -> MaskType {
    if rng.random_bool(0.99) {
        MaskType::PoissonSpans
    } else {
        MaskType::EndOfWindow
    }
}

fn intent_mask_type(
    window: usize,
    last_before_change: Option<usize>,
    rng: &mut impl RngExt,
) -> MaskType {
    let far = window.saturating_sub(TRANSITION_BUFFER);
    match last_before_change {
        Some(t) if t > TRANSITION_BUFFER && t < far => {
            if rng.random_bool(0.5) {
                MaskType::AroundTransition
            } else {
                MaskType::Everything
            }
        }
        Some(t) if t == TRANSITION_BUFFER || t == far => MaskType::Everything,
        _ => {
            if rng.random_bool(0.99) {
                MaskType::Everything
            } else {
                span_or_end(rng)
            }
        }
    }
}

fn fraction(mask_type: MaskType, rng: &mut impl RngExt) -> f64 {
    match mask_type {
        MaskType::EndOfWindow => rng.random_range(0.30..0.60),
        _ => rng.random_range(0.30..0.75),
    }
}

fn draw_mask(
    window: usize,
    mask_type: MaskType,
    fraction: f64,
    last_before_change: Option<usize>,
    rng: &mut impl RngExt,
) -> Vec<bool> {
    let masked = (window as f64 * fraction) as usize;
    let mut mask = vec![false; window];
    match (mask_type, last_before_change) {
        (MaskType::PoissonSpans, _) => mask = poisson_spans(window, masked, rng),
        (MaskType::EndOfWindow, _) => mask[window - masked..].fill(true),
        (MaskType::AroundTransition, Some(t)) => {
            mask[t - TRANSITION_BUFFER..t + TRANSITION_BUFFER].fill(true);
        }
        (MaskType::AroundTransition, None) | (MaskType::Everything, _) => mask.fill(true),
    }
    mask
}

/// A mask of one window made of spans of random length, until exactly `masked` samples are masked, at most all.
///
/// Spans may overlap, so the first and last samples of a window are masked less often, as in the
/// reference.
///
/// # Panics
/// Never: the mean length of a span is a constant, valid for a Poisson distribution.
pub fn poisson_spans(window: usize, masked: usize, rng: &mut impl RngExt) -> Vec<bool> {
    let lengths = Poisson::new(SPAN_MEAN).expect("7 is a valid mean");
    let mut mask = vec![false; window];
    let mut missing = masked.min(window);
    while missing > 0 {
        let length = lengths.sample(rng) as usize;
        if length == 0 || length >= mask.len() {
            continue;
        }
        let length = length.min(missing);
        let start = rng.random_range(0..=mask.len() - length);
        for sample in &mut mask[start..start + length] {
            missing -= usize::from(!*sample);
            *sample = true;
        }
    }
    mask
}
