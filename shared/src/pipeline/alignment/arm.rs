//! The decision between the arms as a part of the pipeline: the encoder takes the window in both placements.

use super::Stage;
use crate::model::Encode;
use crate::pipeline::Pipeline;
#[cfg(test)]
use crate::stream::alignment::ArmDecision;
use crate::stream::alignment::{AlignmentOutcome, Fit, Poor};

impl<E: Encode> Pipeline<'_, E> {
    /// A decision between the arms lacks the samples or the model to go on: neither was shown to be the better one.
    pub(in crate::pipeline) fn interrupt_decision(&mut self) {
        let Stage::Arm(decision) = &self.placement.stage else {
            return;
        };
        let fits = decision.fits();
        let undecided = Fit {
            margin: fits.lead(),
            ..fits.nearest
        };
        self.end_alignment();
        self.finish(AlignmentOutcome::Poor(undecided, Poor::Margin));
    }

    /// A decision between the arms in progress.
    #[cfg(test)]
    pub(in crate::pipeline) const fn arm_decision(&self) -> Option<&ArmDecision> {
        match &self.placement.stage {
            Stage::Arm(decision) => Some(decision),
            Stage::Idle | Stage::Gestures(_) => None,
        }
    }

    /// Lets the encoder take the next patch for a decision between the arms; returns whether there is one.
    pub(in crate::pipeline) fn decide_arm(&mut self) -> bool {
        let Stage::Arm(decision) = &mut self.placement.stage else {
            return false;
        };
        let Some((encoder, smoother, state)) = self.network.parts() else {
            return false;
        };
        let next = decision.next();
        if next.is_first {
            encoder.reset(state);
        }
        let mut patch = *self.window.ring.before_newest(next.back);
        next.alignment.apply_to_all(&mut patch);
        let rows = encoder.step(state, &patch);
        let outputs = encoder.classes() + usize::from(smoother.knows_other());
        if let Some(outcome) = decision.score(&rows, outputs) {
            self.end_alignment();
            self.finish(outcome);
        }
        true
    }

    /// The window has completed a patch.
    pub(in crate::pipeline) const fn patch_completed(&mut self) {
        if let Stage::Arm(decision) = &mut self.placement.stage {
            decision.patch_completed();
        }
    }
}
