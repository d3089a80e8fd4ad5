//! Alignment: by how many of eight places the armband is turned, and on which arm it is worn.
//!
//! The wearer opens the hand [`GESTURES`] times, with rest between. Their [`Profile`], the logarithm of each electrode's
//! mean activity, is compared in all 16 placements with the [`Template`] of the model, a normal density over the profiles
//! of the people whom it was trained on. The nearest placement is the [`Alignment`]; if it is not near enough, or another
//! one is as near, nothing is changed. Integer arithmetic throughout.
//!
//! Why an open hand, why twice, why this density, and what it gains: docs/alignment.md. Normal densities with a shrunk
//! covariance: Friedman, *Regularized discriminant analysis*, JASA 84, 1989.

mod aligner;
mod gesture;
mod placement;
mod profile;
mod template;
mod trigger;

pub use aligner::{Aligner, GESTURES, Outcome, Poor, Progress, TIMEOUT_PATCHES};
pub use placement::Alignment;
pub use profile::{OCTAVE, Profile};
pub use template::{Fit, PRECISION_ONE, TEMPLATE_BYTES, Template, TemplateError};
pub use trigger::Trigger;
