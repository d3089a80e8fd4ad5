//! The device's pipeline on the PC, with the scores of every patch.

use std::cell::RefCell;

use serde::Serialize;
use shared::calibration::{Memory, Shown};
use shared::intent::Intent;
use shared::model::encoder::HostEncoder;
use shared::model::file::{Model, ModelError};
use shared::model::head::Head;
use shared::pipeline::{AlignmentPhase, ModelInput, Pipeline, Reports, Smoother};
use shared::stream::alignment::{Alignment, Arm};
use shared::stream::smoother::SettingsError;
use shared::uart_line::Report;
use shared::uart_line::alignment::AlignmentReport;
use shared::uart_line::calibration::{CalibrateCommand, CalibrationReport, CalibrationState};
use shared::units::{Millis, PATCH, Sample, SampleIndex};

use crate::calibration::Calibration;
use crate::event::Event;
use crate::flashed::flashed;
use crate::request::SourceRequest;
use crate::said::as_text;
use crate::scores::{EncoderOutputs, ObservedEncoder};

/// Person in the list of those whom a calibrated model has seen: nobody here asks for a name.
const WEARER: &str = "own/wearer";

/// Pipeline whose encoder is observed. What it borrows lasts as long as the program, which has one for each source.
pub struct ScoredPipeline {
    pipeline: Pipeline<'static, ObservedEncoder>,
    outputs: &'static RefCell<EncoderOutputs>,
    model: Model<'static>,
    file: &'static [u8],
    encoder: HostEncoder<'static>,
    smoother: Smoother,
    calibration: Calibration,
    /// Head that was learnt and is in use.
    head: Option<&'static Head>,
    /// Sample with which the newest output came.
    last: Option<SampleIndex>,
}

/// Reason why a model is not run.
#[derive(Debug, Serialize, thiserror::Error)]
#[serde(tag = "name", rename_all = "kebab-case")]
pub enum Refused {
    /// The file is refused.
    #[error("the model is refused: {reason}")]
    File {
        /// Error of the file.
        #[from]
        #[serde(serialize_with = "as_text")]
        reason: ModelError,
    },
    /// The smoother refuses the settings of the model.
    #[error("the model is refused: {reason}")]
    Settings {
        /// Error of the settings.
        #[from]
        #[serde(serialize_with = "as_text")]
        reason: SettingsError,
    },
}

/// Results of one sample.
pub struct SampleOutput {
    /// Labels and changes of state.
    pub reports: Reports,
    /// News of an alignment.
    pub alignment: Option<AlignmentReport>,
    /// News of a calibration.
    pub calibration: Option<Event>,
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
        for event in [self.calibration, self.scores].into_iter().flatten() {
            emit(event);
        }
    }
}

impl ScoredPipeline {
    /// Creates the pipeline of a model file.
    ///
    /// # Errors
    /// When the model is refused.
    pub fn open(file: &[u8]) -> Result<Self, Refused> {
        let words = flashed(file, file.len()).leak();
        let file = &bytemuck::cast_slice(words)[..file.len()];
        let model = Model::parse(file)?;
        let encoder = HostEncoder::new(&model)?;
        let outputs = Box::leak(Box::default());
        let state = Box::leak(Box::new(encoder.fresh()));
        let observed = ObservedEncoder::new(encoder, outputs);
        let mut pipeline = Pipeline::of_model(&model, observed, state)?;
        pipeline.lend(Box::leak(Box::new(Memory::EMPTY)));
        let classes = encoder.classes();
        let mut calibration = Calibration::default();
        calibration.know(classes);
        Ok(Self {
            pipeline,
            outputs,
            file,
            smoother: Smoother::new(model.header.smoother.in_patches(), classes)?,
            calibration,
            model,
            encoder,
            head: None,
            last: None,
        })
    }

    /// The model.
    pub const fn model(&self) -> &Model<'static> {
        &self.model
    }

    /// Report of the present state.
    pub fn state_report(&mut self) -> Report {
        self.pipeline.state_report()
    }

    /// Takes a sample with its index; `at` is the time in the events.
    pub fn sample(
        &mut self,
        now: Millis,
        at: f64,
        index: SampleIndex,
        sample: Sample,
    ) -> SampleOutput {
        let reports = self.pipeline.sample(now, sample);
        SampleOutput {
            reports,
            alignment: self.pipeline.take_alignment_report(),
            calibration: self.calibrated(now, at),
            scores: self.scores(index),
        }
    }

    /// Scores of the instant whose label is due with a sample.
    fn scores(&mut self, index: SampleIndex) -> Option<Event> {
        let dimensions = self.model.header.dimensions;
        let settings = self.model.header.smoother.in_patches();
        let columns = dimensions.vocabulary.classes() + usize::from(dimensions.other);
        let scores = self.outputs.borrow_mut().take(&settings, columns)?;
        let last = self.last.replace(index);
        // After a change of the alignment the encoder takes the window again, a patch with each sample. Only the pipeline knows
        // their instants, and their scores were shown before.
        if last.is_some_and(|last| index.since(last) < PATCH as u32) {
            return None;
        }
        let behind = (settings.look_ahead * PATCH) as u32 + 1;
        let instant = index.0.checked_sub(behind)?;
        Some(Event::Scores { instant, scores })
    }

    /// Takes the news of a calibration, and puts a head in use that was learnt.
    fn calibrated(&mut self, now: Millis, at: f64) -> Option<Event> {
        let mut report = self.pipeline.take_calibration_report()?;
        if let Some(memory) = self.pipeline.take_learnt() {
            let head: &Head = Box::leak(Box::new(memory.head().clone()));
            let alignment = memory.alignment();
            self.pipeline.lend(memory);
            self.put(now, Some(head), alignment);
            report.state = CalibrationState::Done;
        }
        self.calibration.event(at, report, self.head.is_some())
    }

    /// Puts a head in use, with the alignment under which it was learnt; none for the model's own.
    fn put(&mut self, now: Millis, head: Option<&'static Head>, alignment: Alignment) {
        let encoder = head.map_or(self.encoder, |head| self.encoder.with_head(head));
        let header = &self.model.header;
        let input = ModelInput {
            preprocessing: header.preprocessing,
            template: header.template,
            alignment,
        };
        let observed = ObservedEncoder::new(encoder, self.outputs);
        let _ = self.pipeline.suspend(now);
        self.pipeline
            .resume(now, observed, self.smoother.clone(), input);
        self.head = head;
        self.last = None;
    }

    /// Runs another model from the next sample on, as after an installation on a board: samples, alignment and wearer stay
    /// where both models allow it. Emits the model and the pipeline's state.
    pub fn replace(&mut self, now: Millis, at: f64, other: Self, emit: &mut dyn FnMut(Event)) {
        self.file = other.file;
        self.model = other.model;
        self.encoder = other.encoder;
        self.smoother = other.smoother;
        self.calibration.know(self.encoder.classes());
        self.put(now, None, Alignment::NONE);
        let _ = self.pipeline.take_calibration_report();
        emit(Event::of_model(&self.model));
        emit(Event::of_report(at, &self.state_report()));
        let idle = CalibrationReport::of(CalibrationState::Idle, None);
        self.calibration.event(at, idle, false).map(emit);
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

    /// Class that a calibration in progress asks for.
    pub fn cue(&self) -> Option<Intent> {
        match self.calibration.cue()? {
            Shown::Intent(intent) => Some(intent),
            Shown::Other => None,
        }
    }

    /// Begins an alignment, anew if one is in progress.
    pub fn begin_alignment(&mut self) {
        self.pipeline.begin_alignment(Arm::Unknown);
    }

    /// Does what is asked for: an alignment, a calibration, or the file of a calibrated model.
    pub fn request(
        &mut self,
        now: Millis,
        at: f64,
        request: SourceRequest,
        emit: &mut dyn FnMut(Event),
    ) {
        match request {
            SourceRequest::Align => self.begin_alignment(),
            SourceRequest::Cancel => self.pipeline.cancel_alignment(),
            SourceRequest::Place { turn, mirrored } => {
                self.set_alignment(Alignment::new(turn, mirrored));
            }
            SourceRequest::Calibrate { wish } => match wish.command() {
                Some(command) => self.calibrate(now, at, command, emit),
                None => self.save(emit),
            },
            // There is no board, and no simulated armband.
            SourceRequest::Bind | SourceRequest::Turn => {}
        }
        if let Some(report) = self.pipeline.take_alignment_report() {
            emit(Event::of_alignment(at, &report));
        }
        if let Some(event) = self.calibrated(now, at) {
            emit(event);
        }
    }

    fn calibrate(
        &mut self,
        now: Millis,
        at: f64,
        command: CalibrateCommand,
        emit: &mut dyn FnMut(Event),
    ) {
        let done = self.pipeline.calibrate(now, command, true, Arm::Unknown);
        for report in done.into_iter().flatten() {
            emit(Event::of_report(at, &report));
        }
        if command == CalibrateCommand::Forget && self.head.is_some() {
            self.pipeline.cancel_calibration();
            self.put(now, None, Alignment::NONE);
            let _ = self.pipeline.take_calibration_report();
            let idle = CalibrationReport::of(CalibrationState::Idle, None);
            self.calibration.event(at, idle, false).map(emit);
        }
    }

    /// Emits the file of the calibrated model, if a head is in use that was learnt.
    fn save(&self, emit: &mut dyn FnMut(Event)) {
        if let Some(bytes) = self.calibrated_file() {
            let name = "calibrated.intent".to_owned();
            let content = bytes.into_iter().map(char::from).collect();
            emit(Event::File { name, content });
        }
    }

    /// Model file with the head in use, as `myointent calibrate` writes it; none for the model's own head.
    fn calibrated_file(&self) -> Option<Vec<u8>> {
        let file = Model::with_head(self.file, self.head?).ok()?;
        let mut parts = Model::parse(&file).ok()?.to_parts();
        let seen = &mut parts.provenance.subjects_seen;
        if !seen.iter().any(|own| own == WEARER) {
            seen.push(WEARER.to_owned());
        }
        parts.to_bytes().ok()
    }

    /// Puts an alignment in force that was found elsewhere.
    pub fn set_alignment(&mut self, alignment: Alignment) {
        if self.pipeline.alignment() != alignment {
            self.pipeline.set_alignment(alignment);
            self.last = None;
        }
    }
}
