//! The model of a pipeline, and another one in its place while the stream goes on.

use super::{Pipeline, Reports};
use crate::intent::MAX_LOGITS;
use crate::model::Encode;
use crate::stream::alignment::{Alignment, Template};
use crate::stream::preprocess::Preprocessing;
use crate::stream::safe_state::Event;
use crate::stream::smoother;
use crate::units::{LOOK_BACK, Millis};

/// That of a pipeline.
pub type Smoother = smoother::Smoother<MAX_LOGITS, LOOK_BACK>;

/// A model, and the smoother with its settings.
#[derive(Debug)]
pub(super) struct InUse<E> {
    pub(super) encoder: E,
    pub(super) smoother: Smoother,
}

/// What a model asks of the samples before it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Input {
    /// What comes between them and the encoder.
    pub preprocessing: Preprocessing,
    /// What an open hand looks like.
    pub template: Option<Template>,
}

impl<E: Encode> Pipeline<'_, E> {
    /// Gives up the model and enters the safe state: nothing that the encoder borrows is read any more. Samples are taken
    /// meanwhile; an alignment in progress is cancelled.
    pub fn suspend(&mut self, now: Millis) -> Reports {
        self.give_up(now, Event::Installation)
    }

    /// The same for good: there is no model to be read.
    pub fn refuse_model(&mut self, now: Millis) -> Reports {
        self.give_up(now, Event::ModelRefused)
    }

    fn give_up(&mut self, now: Millis, event: Event) -> Reports {
        let mut reports = self.tick(now);
        self.model = None;
        self.cancel_alignment();
        self.handle(now, event, &mut reports);
        reports
    }

    /// Puts a model in use, with a smoother for its number of classes and the model's confidence gate. It takes all samples
    /// so far, a patch with each new one: labels go on after at most 0.35 s.
    ///
    /// What is known about the wearer is kept if both models ask for the same preprocessing; otherwise the samples so
    /// far cannot be used, and a new window begins. The alignment is kept if it was found by the template of this model, and
    /// otherwise dropped: what is in its place depends on how each template was measured.
    pub fn resume(&mut self, now: Millis, encoder: E, smoother: Smoother, input: Input) {
        self.interrupt_decision();
        if self.preprocessing != input.preprocessing {
            self.reset_window();
            self.preprocess(input.preprocessing);
        }
        if self.placement.template() != input.template {
            if self.alignment() != Alignment::NONE {
                self.set_alignment(Alignment::NONE);
            }
            self.placement.forget();
            self.set_template(input.template);
        }
        self.set_model(encoder, smoother);
        self.encode_anew();
        // It gives no report: the state stays until there is a label.
        let _ = self.safe_state.handle(now, Event::Installed);
    }

    /// Whether there is a model.
    #[must_use]
    pub const fn has_model(&self) -> bool {
        self.model.is_some()
    }

    pub(super) fn set_model(&mut self, encoder: E, smoother: Smoother) {
        encoder.reset(self.state);
        self.model = Some(InUse { encoder, smoother });
    }

    /// Forgets all patches; the label is relax until there is another one.
    pub(super) fn restart_model(&mut self) {
        if let Some(model) = &mut self.model {
            model.encoder.reset(self.state);
            model.smoother.restart();
        }
    }

    /// Has the encoder take all samples again.
    pub(super) fn encode_anew(&mut self) {
        self.restart_model();
        self.behind = self.ring.complete();
    }
}
