//! The model of a pipeline, and another one in its place while the stream continues.

use super::{Pipeline, Reports};
use crate::intent::MAX_LOGITS;
use crate::model::Encode;
use crate::stream::alignment::{Alignment, Template};
use crate::stream::preprocess::Preprocessing;
use crate::stream::safe_state::{Cause, SafetyEvent};
use crate::stream::smoother::{self, Gate};
use crate::uart_line::calibration::CalibrationState;
use crate::units::{LOOK_BACK, Millis};

/// Smoother with the pipeline's capacities.
pub type Smoother = smoother::Smoother<MAX_LOGITS, LOOK_BACK>;

/// A model, and the smoother with its settings.
struct InUse<E> {
    encoder: E,
    smoother: Smoother,
}

/// The model, with the memory of its encoder.
pub(super) struct Network<'s, E: Encode> {
    /// Model in use; `None` if it was refused, or while another model is being installed.
    model: Option<InUse<E>>,
    /// Borrowed: it is too large to be moved over a device's stack.
    pub(super) state: &'s mut E::State,
}

impl<'s, E: Encode> Network<'s, E> {
    pub(super) const fn new(state: &'s mut E::State) -> Self {
        Self { model: None, state }
    }

    /// Encoder, smoother and the encoder's memory; `None` without a model.
    pub(super) fn parts(&mut self) -> Option<(&E, &mut Smoother, &mut E::State)> {
        let InUse { encoder, smoother } = self.model.as_mut()?;
        Some((encoder, smoother, self.state))
    }

    /// Encoder and smoother; `None` without a model.
    pub(super) fn model(&self) -> Option<(&E, &Smoother)> {
        let model = self.model.as_ref();
        model.map(|model| (&model.encoder, &model.smoother))
    }

    /// Forgets all patches; the label is relax until there is another one.
    pub(super) fn restart(&mut self) {
        if let Some((encoder, smoother, state)) = self.parts() {
            encoder.reset(state);
            smoother.restart();
        }
    }
}

/// Input that a model requires.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ModelInput {
    /// Processing between the samples and the encoder.
    pub preprocessing: Preprocessing,
    /// Pattern of an open hand.
    pub template: Option<Template>,
    /// Alignment under which the head was learnt; [`Alignment::NONE`] for the model's own.
    pub alignment: Alignment,
}

impl<E: Encode> Pipeline<'_, E> {
    /// Gives up the model and enters the safe state: nothing that the encoder borrows is read any more. Samples are taken
    /// meanwhile; an alignment in progress is cancelled.
    pub fn suspend(&mut self, now: Millis) -> Reports {
        self.give_up(now, Cause::Installation)
    }

    /// Suspends permanently: there is no valid model.
    pub fn refuse_model(&mut self, now: Millis) -> Reports {
        self.give_up(now, Cause::ModelRefused)
    }

    fn give_up(&mut self, now: Millis, cause: Cause) -> Reports {
        let mut reports = self.tick(now);
        self.network.model = None;
        self.hold_lock(true);
        self.end_calibration(CalibrationState::Interrupted);
        self.cancel_alignment();
        self.handle(now, SafetyEvent::NoModel(cause), &mut reports);
        reports
    }

    /// Puts a model in use, with a smoother for its number of classes and the model's confidence gate. It takes all samples
    /// so far, a patch with each new one: labels go on after at most 0.35 s.
    ///
    /// The wearer's normalization is kept if both models require the same preprocessing; otherwise the samples so
    /// far cannot be used, and a new window begins. The alignment is kept if it was found by the template of this model, and
    /// otherwise dropped: alignments by different templates differ. A head that was learnt under another
    /// alignment than the one before brings its own.
    pub fn resume(&mut self, now: Millis, encoder: E, smoother: Smoother, input: ModelInput) {
        self.interrupt_decision();
        if self.window.preprocessing != input.preprocessing {
            self.reset_window();
            self.preprocess(input.preprocessing);
        }
        if self.placement.template != input.template {
            if self.alignment() != Alignment::NONE {
                self.set_alignment(Alignment::NONE);
            }
            self.placement.is_known = false;
            self.set_template(input.template);
        }
        let learnt = core::mem::replace(&mut self.placement.learnt, input.alignment);
        if learnt != input.alignment && self.alignment() != input.alignment {
            self.set_alignment(input.alignment);
        }
        self.set_model(encoder, smoother);
        self.encode_anew();
        // It gives no report: the state stays until there is a label.
        self.output.safe_state.handle(now, SafetyEvent::Installed);
    }

    /// Whether there is a model.
    #[must_use]
    pub const fn has_model(&self) -> bool {
        self.network.model.is_some()
    }

    pub(super) fn set_model(&mut self, encoder: E, smoother: Smoother) {
        encoder.reset(self.network.state);
        self.network.model = Some(InUse { encoder, smoother });
    }

    /// Encodes all samples again.
    pub(super) fn encode_anew(&mut self) {
        self.network.restart();
        self.window.rewind();
    }

    /// Margins in place of the model's confidence gate; empty without a model.
    #[must_use]
    pub fn gate(&self) -> Gate {
        let model = self.network.model();
        model.map_or(Gate::default(), |(_, smoother)| smoother.gate())
    }

    /// Puts margins in place of the model's, from the next label on; returns whether there is a model that has all of these
    /// margins.
    pub fn set_gate(&mut self, gate: Gate) -> bool {
        let fits = |smoother: &Smoother| gate.other.is_none() || smoother.knows_other();
        let model = self.network.model.as_mut();
        let Some(model) = model.filter(|model| fits(&model.smoother)) else {
            return false;
        };
        model.smoother.set_gate(gate);
        true
    }
}
