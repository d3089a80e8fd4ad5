//! Training of a job, and its logits over the trials.

use evaluation::model_evaluation::{NamedModel, beside};
use evaluation::{Candidate, Trial, constant};
use shared::intent::MAX_CLASSES;
use training::run::candidates::teacher_candidate;
use training::run::context::RunContext;
use training::run::evaluate::energy_detector;
use training::run::quantize::{MODEL, quantize};
use training::run::train::{Extra, train, train_teacher};

use super::contender::Kind;
use super::job::{CrossValidation, Job};
use crate::baselines::inference::candidate;
use crate::baselines::training::train_all;
use crate::job::JobError;

impl CrossValidation<'_> {
    /// Trains the job's models, or those still missing. Returns the logits over the trials, which are made after the
    /// training.
    pub(super) fn trained(
        &self,
        job: &Job,
        context: &RunContext,
        trials: &dyn Fn() -> Vec<Trial>,
    ) -> Result<(Candidate, Vec<Trial>), JobError> {
        match job.contender.kind {
            Kind::Student => {
                train(context, Extra::default())?;
                let model = NamedModel {
                    name: job.contender.name().to_owned(),
                    bytes: quantize(context, &context.folder.file(MODEL))?,
                };
                let trials = trials();
                Ok((
                    beside(&model, &trials).map_err(training::run::StepError::from)?,
                    trials,
                ))
            }
            Kind::Teacher(teacher) => {
                train_teacher(context)?;
                let trials = trials();
                let mut candidate = teacher_candidate(context, teacher.name(), &trials)?;
                // As in the paper, the teacher has no gate and knows no movement outside the vocabulary.
                candidate.entry_margins = [0.0; MAX_CLASSES];
                candidate.other_margin = None;
                Ok((candidate, trials))
            }
            Kind::Baseline(baseline) => {
                train_all(context, &[baseline], self.baselines)?;
                let trials = trials();
                Ok((candidate(context, baseline, &trials)?, trials))
            }
            Kind::Constant => {
                let trials = trials();
                Ok((constant(&trials), trials))
            }
            Kind::EnergyDetector => {
                let detector = energy_detector(&context.config, &self.library);
                let trials = trials();
                // Without a gesture to fit the detector to, its label is always relax.
                let floor = detector
                    .map_or_else(|| constant(&trials), |detector| detector.candidate(&trials));
                Ok((floor, trials))
            }
        }
    }
}
