//! The device's pipeline on the PC, with the scores of every patch.

use std::cell::RefCell;

use shared::model::Encode;
use shared::model::file::Model;
use shared::pipeline::{AlignmentPhase, Pipeline, Reports};
use shared::stream::alignment::{Alignment, Arm};
use shared::stream::smoother::{Settings, SettingsError};
use shared::uart_line::Report;
use shared::uart_line::alignment::AlignmentReport;
use shared::units::{Millis, PATCH, Sample, SampleIndex};

use crate::event::Event;
use crate::request::SourceRequest;
use crate::scores::{EncoderOutputs, ObservedEncoder};

/// Pipeline whose encoder is observed.
pub struct ScoredPipeline<'r, E: Encode> {
    pipeline: Pipeline<'r, ObservedEncoder<'r, E>>,
    outputs: &'r RefCell<EncoderOutputs>,
    settings: Settings,
    columns: usize,
    /// Sample with which the newest output came.
    last: Option<SampleIndex>,
}

/// Results of one sample.
pub struct SampleOutput {
    /// Labels and changes of state.
    pub reports: Reports,
    /// News of an alignment.
    pub alignment: Option<AlignmentReport>,
    /// Scores of an instant.
    pub scores: Option<Event>,
}

impl SampleOutput {
    /// Emits the results; `at` is the time of the sample.
    pub fn events(self, at: f64, emit: &mut dyn FnMut(Event)) {
        for report in self.reports {
            emit(Event::of_report(at, &report));
        }
        if let Some(report) = self.alignment {
            emit(Event::of_alignment(at, &report));
        }
        if let Some(scores) = self.scores {
            emit(scores);
        }
    }
}

impl<'r, E: Encode> ScoredPipeline<'r, E> {
    /// Creates the pipeline of a model; `encoder` must be made from the same model.
    ///
    /// # Errors
    /// When the smoother refuses the settings of the model.
    pub fn new(
        model: &Model<'_>,
        encoder: E,
        state: &'r mut E::State,
        outputs: &'r RefCell<EncoderOutputs>,
    ) -> Result<Self, SettingsError> {
        let dimensions = model.header.dimensions;
        Ok(Self {
            pipeline: Pipeline::of_model(model, ObservedEncoder::new(encoder, outputs), state)?,
            outputs,
            settings: model.header.smoother.in_patches(),
            columns: dimensions.vocabulary.classes() + usize::from(dimensions.other),
            last: None,
        })
    }

    /// Report of the present state.
    pub fn state_report(&mut self) -> Report {
        self.pipeline.state_report()
    }

    /// Takes a sample with its index.
    pub fn sample(&mut self, now: Millis, index: SampleIndex, sample: Sample) -> SampleOutput {
        let reports = self.pipeline.sample(now, sample);
        SampleOutput {
            reports,
            alignment: self.pipeline.take_alignment_report(),
            scores: self.scores(index),
        }
    }

    /// Scores of the instant whose label is due with a sample.
    fn scores(&mut self, index: SampleIndex) -> Option<Event> {
        let scores = self
            .outputs
            .borrow_mut()
            .take(&self.settings, self.columns)?;
        let last = self.last.replace(index);
        // After a change of the alignment the encoder takes the window again, a patch with each sample. Only the pipeline knows
        // their instants, and their scores were shown before.
        if last.is_some_and(|last| index.since(last) < PATCH as u32) {
            return None;
        }
        let behind = (self.settings.look_ahead * PATCH) as u32 + 1;
        let instant = index.0.checked_sub(behind)?;
        Some(Event::Scores { instant, scores })
    }

    /// Reports that samples are missing before the next one.
    pub fn gap(&mut self, now: Millis, missing: u32) -> Reports {
        self.pipeline.gap(now, missing)
    }

    /// Lets time pass, as a board does itself.
    pub fn tick(&mut self, now: Millis) -> Reports {
        self.pipeline.tick(now)
    }

    /// Reports that the stream has ended.
    pub fn disconnected(&mut self, now: Millis) -> Reports {
        self.last = None;
        self.pipeline.disconnected(now)
    }

    /// Whether an alignment is in progress.
    pub const fn is_aligning(&self) -> bool {
        matches!(self.pipeline.alignment_phase(), AlignmentPhase::Waiting)
    }

    /// Begins an alignment, anew if one is in progress.
    pub fn begin_alignment(&mut self) {
        self.pipeline.begin_alignment(Arm::Unknown);
    }

    /// Begins, cancels or sets an alignment.
    pub fn request(&mut self, at: f64, request: &SourceRequest, emit: &mut dyn FnMut(Event)) {
        match request {
            SourceRequest::Align => self.begin_alignment(),
            SourceRequest::CancelAlignment => self.pipeline.cancel_alignment(),
            SourceRequest::SetAlignment(alignment) => self.set_alignment(*alignment),
            // There is no board.
            SourceRequest::Bind | SourceRequest::Install(_) => {}
        }
        if let Some(report) = self.pipeline.take_alignment_report() {
            emit(Event::of_alignment(at, &report));
        }
    }

    /// Puts an alignment in force that was found elsewhere.
    pub fn set_alignment(&mut self, alignment: Alignment) {
        if self.pipeline.alignment() != alignment {
            self.pipeline.set_alignment(alignment);
            self.last = None;
        }
    }
}
