//! The operating point of a running pipeline.

use super::Pipeline;
use super::in_use::Smoother;
use crate::model::Encode;
use crate::stream::smoother::Gate;

impl<E: Encode> Pipeline<'_, E> {
    /// What stands in place of the model's confidence gate; nothing without a model.
    #[must_use]
    pub fn gate(&self) -> Gate {
        let model = self.model.as_ref();
        model.map_or(Gate::default(), |model| model.smoother.gate())
    }

    /// Puts margins in place of the model's, from the next label on; gives whether there is a model that has all of these
    /// margins.
    pub fn set_gate(&mut self, gate: Gate) -> bool {
        let fits = |smoother: &Smoother| gate.other.is_none() || smoother.knows_other();
        let model = self.model.as_mut();
        let Some(model) = model.filter(|model| fits(&model.smoother)) else {
            return false;
        };
        model.smoother.set_gate(gate);
        true
    }
}
