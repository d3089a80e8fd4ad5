//! Which samples of a window are hidden from the model, drawn anew every time.
//!
//! The rules are those that the reference implementation runs with (its mixture with the curriculum
//! switched off): Poisson spans, end of window, around a transition, everything.

use rand::RngExt;
use rand_distr::{Distribution, Poisson};
use serde::{Deserialize, Serialize};

/// Mean length of a masked span, in samples (lambda of the Poisson draw).
const SPAN_MEAN: f64 = 7.0;
/// Samples masked on either side of a transition.
pub const TRANSITION_BUFFER: usize = 50;

/// What the model has to fill in.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Task {
    /// EMG is whole, intents are masked.
    Intent,
    /// Intents are visible, EMG is masked.
    Emg,
    /// Both are masked.
    Joint,
    /// No labels: EMG is masked, intents are cut off from attention.
    SelfSupervised,
}

/// Masks of one window, one flag a sample; `true` hides the sample and puts it into the loss.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Masks {
    /// Hidden EMG samples, all eight channels at once.
    pub emg: Vec<bool>,
    /// Hidden intents.
    pub intent: Vec<bool>,
    /// Whether attention between EMG and intents is blocked.
    pub blocked: bool,
}

/// How the hidden samples of a mask lie.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Kind {
    PoissonSpans,
    EndOfWindow,
    AroundTransition,
    Everything,
}

impl Task {
    /// Draws the masks of a window of so many samples.
    ///
    /// `last_before_change` is the position of the window's last sample before its first label
    /// change, if it has one.
    pub fn draw(
        self,
        window: usize,
        last_before_change: Option<usize>,
        rng: &mut impl RngExt,
    ) -> Masks {
        let none = || vec![false; window];
        match self {
            Self::Intent => {
                let kind = intent_kind(window, last_before_change, rng);
                let intent = draw_mask(window, kind, fraction(kind, rng), last_before_change, rng);
                Masks {
                    emg: none(),
                    intent,
                    blocked: false,
                }
            }
            Self::Emg => {
                let kind = span_or_end(rng);
                let emg = draw_mask(window, kind, fraction(kind, rng), None, rng);
                Masks {
                    emg,
                    intent: none(),
                    blocked: false,
                }
            }
            Self::Joint => {
                // One kind and one fraction for both, but each modality draws its own spans.
                let kind = span_or_end(rng);
                let fraction = fraction(kind, rng);
                let emg = draw_mask(window, kind, fraction, None, rng);
                let intent = draw_mask(window, kind, fraction, None, rng);
                Masks {
                    emg,
                    intent,
                    blocked: false,
                }
            }
            Self::SelfSupervised => {
                let fraction = rng.random_range(0.20..0.65);
                let emg = draw_mask(window, Kind::PoissonSpans, fraction, None, rng);
                Masks {
                    emg,
                    intent: none(),
                    blocked: true,
                }
            }
        }
    }
}

fn span_or_end(rng: &mut impl RngExt) -> Kind {
    if rng.random_bool(0.99) {
        Kind::PoissonSpans
    } else {
        Kind::EndOfWindow
    }
}

fn intent_kind(window: usize, last_before_change: Option<usize>, rng: &mut impl RngExt) -> Kind {
    let far = window.saturating_sub(TRANSITION_BUFFER);
    match last_before_change {
        Some(t) if t > TRANSITION_BUFFER && t < far => {
            if rng.random_bool(0.5) {
                Kind::AroundTransition
            } else {
                Kind::Everything
            }
        }
        Some(t) if t == TRANSITION_BUFFER || t == far => Kind::Everything,
        _ => {
            if rng.random_bool(0.99) {
                Kind::Everything
            } else {
                span_or_end(rng)
            }
        }
    }
}

fn fraction(kind: Kind, rng: &mut impl RngExt) -> f64 {
    match kind {
        Kind::EndOfWindow => rng.random_range(0.30..0.60),
        _ => rng.random_range(0.30..0.75),
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a fraction of a window"
)]
fn draw_mask(
    window: usize,
    kind: Kind,
    fraction: f64,
    last_before_change: Option<usize>,
    rng: &mut impl RngExt,
) -> Vec<bool> {
    let hidden = (window as f64 * fraction) as usize;
    let mut mask = vec![false; window];
    match (kind, last_before_change) {
        (Kind::PoissonSpans, _) => mask = poisson_spans(window, hidden, rng),
        (Kind::EndOfWindow, _) => mask[window - hidden..].fill(true),
        (Kind::AroundTransition, Some(t)) => {
            mask[t - TRANSITION_BUFFER..t + TRANSITION_BUFFER].fill(true);
        }
        (Kind::AroundTransition, None) | (Kind::Everything, _) => mask.fill(true),
    }
    mask
}

/// A mask of one window: spans are marked until exactly `hidden` distinct samples are, at most all.
///
/// A span that falls wholly on marked samples adds nothing and is drawn again; this thins out the
/// first and last samples of a window, as in the reference.
///
/// # Panics
/// Never: the mean length of a span is a constant that suits a Poisson draw.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a Poisson draw is a small count"
)]
pub fn poisson_spans(window: usize, hidden: usize, rng: &mut impl RngExt) -> Vec<bool> {
    let lengths = Poisson::new(SPAN_MEAN).expect("7 is a valid mean");
    let mut mask = vec![false; window];
    let mut missing = hidden.min(window);
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

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use shared::units::WINDOW;

    fn share(mask: &[bool]) -> usize {
        mask.iter().filter(|&&hidden| hidden).count()
    }

    #[test]
    fn spans_hide_exactly_the_asked_number_of_samples() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for hidden in [0, 1, 180, 300, 450, WINDOW] {
            assert_eq!(share(&poisson_spans(WINDOW, hidden, &mut rng)), hidden);
        }
    }

    #[test]
    fn a_transition_in_the_middle_is_hidden_alone_or_with_everything() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for _ in 0..200 {
            let masks = Task::Intent.draw(WINDOW, Some(300), &mut rng);
            assert_eq!(share(&masks.emg), 0);
            match share(&masks.intent) {
                100 => assert!(masks.intent[250..350].iter().all(|&hidden| hidden)),
                hidden => assert_eq!(hidden, WINDOW),
            }
        }
    }

    #[test]
    fn emg_task_leaves_every_intent_visible() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for _ in 0..100 {
            let masks = Task::Emg.draw(WINDOW, Some(10), &mut rng);
            assert_eq!(share(&masks.intent), 0);
            assert!((180..450).contains(&share(&masks.emg)));
        }
    }

    #[test]
    fn only_the_self_supervised_task_blocks_attention() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        for task in [Task::Intent, Task::Emg, Task::Joint] {
            assert!(!task.draw(WINDOW, None, &mut rng).blocked);
        }
        let masks = Task::SelfSupervised.draw(WINDOW, None, &mut rng);
        assert!(masks.blocked);
        assert_eq!(share(&masks.intent), 0);
        assert!((120..390).contains(&share(&masks.emg)));
    }
}
