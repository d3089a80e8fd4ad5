//! Job of a cross-validation: a contender with one seed, trained without the people of one fold and evaluated on them. On
//! request it is also evaluated on the test people, who are in no fold.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use burn::tensor::Device;
use serde::{Deserialize, Serialize};
use shared::model::LookBackLogits;

use evaluation::model_evaluation::recordings_of;
use evaluation::{ALL, Candidate, EvaluatedRecording, LookAhead, Score, score};
use execution::fingerprint::Fingerprint;
use execution::interrupt::Interrupt;
use execution::progress;
use execution::run_folder::RunFolder;
use presets::OperatingPoint;
use presets::config::ResolvedConfig;
use presets::resolve::{FoldChoice, fold_people, test_people};
use recordings::Library;
use recordings::folds::Protocol;
use recordings::split::Role;
use recordings::split::predefined::is_test;
use training::run::StepError;
use training::run::context::RunContext;

use super::contender::{Contender, ContenderKind};
use crate::baselines::BaselineSettings;
use crate::job::{JobError, begun};

/// Name of the file with a job's scores in its run folder.
const SCORES: &str = "cross-validation.json";

pub(crate) struct CrossValidation<'a> {
    /// Folder of all jobs; run folders are `NAME/seed-S/fold-K` in it.
    pub(crate) folder: &'a Path,
    pub(crate) protocol: Protocol,
    /// Whether the test people are evaluated too.
    pub(crate) test_people: bool,
    /// Operating points to evaluate with; none for the contender's own.
    pub(crate) gates: Vec<Option<OperatingPoint>>,
    pub(crate) library: Arc<Library>,
    /// Folder of the recordings; none for synthetic ones.
    pub(crate) data: Option<&'a Path>,
    /// Whether damaged files were refused rather than left out.
    pub(crate) strict: bool,
    /// Device with gradients.
    pub(crate) device: Device,
    pub(crate) interrupt: &'a Interrupt,
}

/// Contender with its seed, and the number of a fold, from 1.
#[derive(Clone, Debug)]
pub(crate) struct Job {
    pub(crate) contender: Contender,
    pub(crate) fold: usize,
}

impl CrossValidation<'_> {
    /// Loads the scores of a job with every wanted operating point; none if it was not run, or with other settings or
    /// recordings.
    pub(crate) fn done(&self, job: &Job) -> Result<Option<JobScores>, JobError> {
        let Ok(folder) = RunFolder::existing(self.path(job)) else {
            return Ok(None);
        };
        Ok(self.kept(job, &folder, &self.config(job)?))
    }

    /// Loads the scores in a run folder; none unless they are of this configuration, with every wanted operating point and
    /// all wanted people.
    fn kept(&self, job: &Job, folder: &RunFolder, config: &ResolvedConfig) -> Option<JobScores> {
        let kept = folder.load_stamped::<JobScores>(SCORES, self.made_from(job, config));
        kept.ok()?.complete(self.gates(job), self.test_people)
    }

    /// Operating points that a job is evaluated with.
    fn gates(&self, job: &Job) -> &[Option<OperatingPoint>] {
        if job.contender.is_trained() {
            &self.gates
        } else {
            &[None]
        }
    }

    /// Fingerprint of all that the scores of a job depend on.
    fn made_from(&self, job: &Job, config: &ResolvedConfig) -> Fingerprint {
        match job.contender.kind {
            ContenderKind::Student => config.fingerprint(),
            ContenderKind::Baseline(baseline) => {
                Fingerprint::of(&(config.fingerprint(), baseline, BaselineSettings::default()))
            }
            ContenderKind::Constant | ContenderKind::EnergyDetector => {
                Fingerprint::of(&(config.fingerprint(), job.contender.name()))
            }
        }
    }

    /// Trains the job's models, or those still missing, and evaluates them.
    pub(crate) fn run(&self, job: &Job) -> Result<(), JobError> {
        let path = self.path(job);
        // Computed once: it fingerprints all recordings.
        let config = self.config(job)?;
        let existing = RunFolder::existing(&path).ok();
        if existing.is_some_and(|folder| self.kept(job, &folder, &config).is_some()) {
            progress::log(&format!("{}: already evaluated", path.display()));
            return Ok(());
        }
        let folder = RunFolder::open(&path)?.locked()?;
        let config = begun(&folder, config)?;
        progress::log(&format!(
            "{}: {} people to train on",
            path.display(),
            config.split.training.len()
        ));
        let context = RunContext {
            folder,
            config,
            library: self.library.clone(),
            device: self.device.clone(),
            resume: true,
            interrupt: self.interrupt.clone(),
        };
        let scores = self.evaluate(job, &context)?;
        let made_from = self.made_from(job, &context.config);
        context.folder.save_stamped(SCORES, made_from, &scores)?;
        Ok(())
    }

    pub(crate) fn path(&self, job: &Job) -> PathBuf {
        self.folder
            .join(job.contender.folder())
            .join(format!("seed-{}", job.contender.preset.seed))
            .join(format!("fold-{}", job.fold))
    }

    fn config(&self, job: &Job) -> Result<ResolvedConfig, JobError> {
        let choice = FoldChoice {
            protocol: self.protocol,
            number: job.fold,
        };
        let preset = job.contender.preset.clone();
        Ok(ResolvedConfig::new(
            preset,
            &self.library,
            self.data,
            self.strict,
            Some(choice),
        )?)
    }

    /// Evaluates the fold's people of all data sets, and on request the test people.
    fn evaluate(&self, job: &Job, context: &RunContext) -> Result<JobScores, JobError> {
        let preset = &job.contender.preset;
        let people = fold_people(preset, &self.library, self.protocol);
        let fold = people.into_iter().nth(job.fold - 1).unwrap_or_default();
        let split = &context.config.split;
        // For sets that are not trained on: all people outside the fold.
        let is_training = |subject: &str| match split.role(subject) {
            Some(role) => role == Role::Training,
            None => !fold.iter().any(|own| own == subject) && !is_test(subject),
        };
        let mut people = fold.clone();
        if self.test_people {
            people.extend(test_people(preset, &self.library));
        }
        let recordings =
            || recordings_of(&self.library, preset.vocabulary(), &people, &is_training);
        let (mut candidate, recordings) = self.trained(job, context, &recordings)?;
        let logits = std::mem::take(&mut candidate.logits);
        let (test, development): (Vec<_>, Vec<_>) = recordings
            .into_iter()
            .zip(logits)
            .partition(|(recording, _)| is_test(&recording.subject));
        let scores = |part: Vec<(EvaluatedRecording, Vec<LookBackLogits>)>| {
            let (recordings, logits): (Vec<_>, Vec<_>) = part.into_iter().unzip();
            let candidate = Candidate {
                logits,
                ..candidate.clone()
            };
            self.scores(job, candidate, &recordings)
        };
        Ok(JobScores {
            development: scores(development)?,
            test: self.test_people.then(|| scores(test)).transpose()?,
        })
    }

    /// Scores a job's model on some people, with every wanted operating point.
    fn scores(
        &self,
        job: &Job,
        mut candidate: Candidate,
        recordings: &[EvaluatedRecording],
    ) -> Result<Vec<FoldScore>, JobError> {
        let vocabulary = job.contender.preset.vocabulary();
        let own = candidate.margins;
        let mut scores = Vec::new();
        for &gate in self.gates(job) {
            candidate.margins = gate.map_or(own, |gate| gate.margins(own.other.is_some()));
            let look_aheads: &[LookAhead] = if candidate.looks_back {
                &LookAhead::ALL
            } else {
                &[LookAhead::None]
            };
            for &look_ahead in look_aheads {
                let rows = score(&candidate, recordings, vocabulary, look_ahead);
                let rows = rows.map_err(StepError::from)?.into_iter();
                scores.extend(rows.map(|score| FoldScore { gate, score }));
            }
        }
        let single = scores.iter().all(|own| own.score.data_set != ALL);
        scores.retain(|own| single || own.score.data_set == ALL);
        Ok(scores)
    }
}

/// Scores of one job, as kept in its run folder.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct JobScores {
    /// Scores on the fold's people.
    pub(crate) development: Vec<FoldScore>,
    /// Scores on the test people; none if these were not evaluated.
    pub(crate) test: Option<Vec<FoldScore>>,
}

/// Score over a group of people (with all classes or fewer), of a fold or of all test people.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct FoldScore {
    /// Operating point; none for the contender's own.
    pub(crate) gate: Option<OperatingPoint>,
    pub(crate) score: Score,
}

impl JobScores {
    /// Selects the scores with these gates, on the test people if wanted; none if any are missing.
    pub(crate) fn complete(
        self,
        gates: &[Option<OperatingPoint>],
        test_people: bool,
    ) -> Option<Self> {
        let complete = |mut scores: Vec<FoldScore>| {
            let has = |gate: &Option<OperatingPoint>| {
                let mut scores = scores.iter();
                scores.any(|own| own.gate == *gate)
            };
            let all = gates.iter().all(has);
            scores.retain(|own| gates.contains(&own.gate));
            all.then_some(scores)
        };
        let test = if test_people {
            Some(complete(self.test?)?)
        } else {
            None
        };
        Some(Self {
            development: complete(self.development)?,
            test,
        })
    }
}
