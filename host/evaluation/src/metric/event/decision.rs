//! One decision a gesture = gestures whose decision is their label / gestures, mean over the labels.
//!
//! The decision is the active label that is emitted at most of the samples that the gesture owns
//! ([`gesture`](super::gesture)); of equal ones, the lower class number. A gesture without an active label has no decision.
//! When the label comes, how long it stays and what else is emitted there does not count.
//!
//! This is the rule *classification* of EMG-EPN-612 (Barona López et al., Sensors 20(21) 6327, 2020). Its rule
//! *recognition* also asks for a single run of the label, which overlaps with the gesture.
//!
//! Rest kept = rest spans that stay at rest / rest spans. A span is a run of at least four times the tolerance of rest
//! ([`activation`]). It stays at rest if no active label begins in it and none is emitted at its end: a label that is
//! let go late may reach into it.

use shared::intent::{Intent, MAX_CLASSES};

use super::summary::Tally;
use super::{TOLERANCE, activation, active};
use recordings::runs;

/// The decision over these samples; none without an active label.
pub(super) fn decision(emitted: &[Option<Intent>]) -> Option<Intent> {
    let mut samples = [0_usize; MAX_CLASSES];
    for label in emitted.iter().filter_map(|&label| active(label)) {
        samples[label.class()] += 1;
    }
    let most = samples.into_iter().max().filter(|&most| most > 0)?;
    let class = samples.iter().position(|&own| own == most)?;
    Intent::from_class(class)
}

/// Rest spans, all and kept. `rest` flags the samples at rest.
pub(super) fn rests(emitted: &[Option<Intent>], rest: &[bool]) -> Tally {
    let spans = runs(rest).into_iter();
    let long = spans.filter(|span| span.label && span.samples() >= 4 * TOLERANCE);
    let decided = long.map(|span| {
        let is_raised = activation::raises(emitted, span.start..span.end);
        Tally::one(active(emitted[span.end - 1]).is_none() && !is_raised)
    });
    decided.fold(Tally::default(), Tally::plus)
}
