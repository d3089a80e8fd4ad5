//! The interface between a pipeline and a model.

use crate::calibration::{Refusal, Sums};
use crate::intent::MAX_LOGITS;
use crate::model::head::Head;
use crate::units::{LOOK_BACK, Patch};

/// Logits of the six newest patches, newest first, not normalised.
///
/// Shape `[6][7]`: row `j` refers to the patch `j` before the newest. The first columns are the classes; the next one is
/// movement outside the vocabulary, for a model that knows it ([`Dimensions::other`](super::dimensions::Dimensions::other)).
/// The others are 0.
pub type LookBackLogits = [[f32; MAX_LOGITS]; LOOK_BACK];

/// A streaming model: one patch in, one set of logits out. The weights never change; what changes
/// from patch to patch is the state, which is kept apart.
pub trait Encode {
    /// Memory of the patches so far.
    type State;

    /// Number of classes, 1 to 6.
    fn classes(&self) -> usize;

    /// The state before the first patch.
    fn fresh(&self) -> Self::State;

    /// Makes a state fresh in place: a device's stack has no room for a second one.
    fn reset(&self, state: &mut Self::State);

    /// Takes the next patch.
    fn step(&self, state: &mut Self::State, patch: &Patch) -> LookBackLogits;

    /// Hidden vector at the patch of the last step, from which a calibration learns; empty for a model that cannot be
    /// calibrated.
    fn hidden<'s>(&self, _state: &'s Self::State) -> &'s [f32] {
        &[]
    }

    /// Logits that another head gives at the patch of the last step.
    fn logits_by(&self, _head: &Head, _state: &mut Self::State) -> LookBackLogits {
        LookBackLogits::default()
    }

    /// Writes the head of a wearer; the state is scratch memory, and fresh after it.
    fn solve(
        &self,
        _sums: &Sums,
        _state: &mut Self::State,
        _head: &mut Head,
    ) -> Result<(), Refusal> {
        Err(Refusal::WrongModel)
    }

    /// Takes consecutive patches. Equal to as many calls of [`Encode::step`], bit for bit; an
    /// implementation may compute several at once.
    fn steps(
        &self,
        state: &mut Self::State,
        patches: &[Patch],
        mut output: impl FnMut(LookBackLogits),
    ) {
        for patch in patches {
            output(self.step(state, patch));
        }
    }
}
