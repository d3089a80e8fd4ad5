//! The operating point of a running pipeline.

use super::Pipeline;
use crate::model::Encode;
use crate::stream::smoother::Gate;

impl<E: Encode> Pipeline<'_, E> {
    /// What stands in place of the model's confidence gate.
    #[must_use]
    pub const fn gate(&self) -> Gate {
        self.smoother.gate()
    }

    /// Puts margins in place of the model's, from the next label on; gives whether the model has all of these margins.
    pub fn set_gate(&mut self, gate: Gate) -> bool {
        let fits = gate.other.is_none() || self.smoother.knows_other();
        if fits {
            self.smoother.set_gate(gate);
        }
        fits
    }
}
