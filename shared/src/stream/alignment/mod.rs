//! Alignment: by how many of eight places the armband is turned, and on which arm it is worn.
//!
//! The wearer opens the hand [`GESTURES`] times, with rest between. Their [`Profile`], the logarithm of each electrode's
//! mean activity, is compared in all 16 placements with the [`Template`] of the model, a normal density over the profiles
//! of the people whom it was trained on. The nearest placement is the [`Alignment`]; if it is not near enough, or another
//! one is as near, nothing is changed. Where one on the other arm is nearly as near, the model's logits decide with the
//! template ([`ArmDecision`]), unless it was told on which arm the armband is ([`Arm`]). Integer arithmetic, but for these.
//!
//! Why an open hand, why twice, why this density, and what it gains: docs/alignment.md. Normal densities with a shrunk
//! covariance: Friedman, *Regularized discriminant analysis*, JASA 84, 1989.

mod aligner;
mod arm_decision;
mod gesture;
mod outcome;
mod placement;
mod profile;
mod template;
mod trigger;

pub use aligner::{Aligner, AlignmentProgress, GESTURES, TIMEOUT_PATCHES};
pub use arm_decision::{ArmDecision, Next};
pub use outcome::{AlignmentOutcome, Poor};
pub use placement::{Alignment, Arm};
pub use profile::{COUNT, OCTAVE, Profile};
pub use template::{Fit, Fits, NAT, PRECISION_ONE, TEMPLATE_BYTES, Template, TemplateError};
pub use trigger::Trigger;
