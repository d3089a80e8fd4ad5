//! The steps from recordings to a judged model file, each starting from what the one before left
//! in the run's folder.

use std::path::Path;

use anyhow::{Context as _, bail};
use burn::module::Module;
use burn::tensor::Device;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use shared::model::file::{Model, ProvenanceParts, SmootherDefaults};
use shared::stream::smoother::AggregationMode;
use shared::units::{CleanSample, HOLD, LOOK_AHEAD, PATCH, WINDOW_PATCHES};

use shared::model::LookBackLogits;
use crate::dataset::lead_in::padded;
use crate::inference::student_logits;
use crate::inference::teacher_logits;
use crate::evaluation::judge::{Candidate, LookAhead, Truth, Verdict, judge};
use crate::run::trial::{self, Trial};
use crate::execution::interrupt::Interrupt;
use crate::execution::parallel;
use myointent_research::baselines::training::Lesson;
use myointent_research::baselines::{self, Peer};
use crate::run::plan::Plan;
use crate::execution::progress;
use crate::dataset::Library;
use crate::execution::run_folder::{RunError, RunFolder, write_whole};
use crate::inference::device;
use crate::student::distillation::{self, Distillation};
use crate::student::model::Student;
use crate::student::quantization::quantize;
use crate::teacher;
use crate::teacher::model::Teacher;

/// A run: its folder, its plan, and what it computes on.
pub struct Stage<'a> {
    /// Where everything is written.
    pub run: &'a RunFolder,
    /// What will run.
    pub plan: &'a Plan,
    /// The recordings.
    pub library: &'a Library,
    /// Device with gradients.
    pub device: Device,
    /// Whether to go on where an interrupted run stopped.
    pub resume: bool,
    /// Ctrl-C.
    pub interrupt: &'a Interrupt,
}

/// Judgement of several models, as `results.json` keeps it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// Data sets and subjects that were judged; no model has seen them.
    pub held_out: Vec<String>,
    /// The reading that the model file asks for.
    pub aggregation: LookAhead,
    /// Recordings as published.
    pub published: Vec<Verdict>,
    /// The same people's recordings in random order and rhythm.
    pub spliced: Vec<Verdict>,
}

/// A figure kept with a model file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Figure {
    name: String,
    value: f32,
}

/// The teacher's name in tables.
pub const TEACHER: &str = "teacher";
/// The name of the student in floating point.
pub const STUDENT: &str = "float student";
/// The name of the student that devices run.
pub const INTEGER: &str = "integer student";
/// The name of a student that has learnt from the labels alone.
pub const ALONE: &str = "student without teacher";
/// The same in integers.
pub const INTEGER_ALONE: &str = "integer student without teacher";

/// Name of [`Results`] in a run folder.
pub const RESULTS: &str = "results.json";
const CHOOSING: &str = "choosing the reading";
const FIGURES: &str = "figures.json";
const READING: &str = "reading.json";
const TEACHER_ROWS: &str = "teacher-rows.bin";

impl Stage<'_> {
    /// Trains the teacher.
    ///
    /// # Errors
    /// When the folder cannot be written or the user interrupts.
    pub fn train(&self) -> anyhow::Result<()> {
        let preset = &self.plan.preset;
        let corpus = self.plan.training(self.library);
        let validation = self.plan.validation(self.library);
        if validation.streams.is_empty() {
            bail!(
                "no subject is left to choose the checkpoint with: name one under data.validation, or give more recordings"
            );
        }
        progress::say(&format!(
            "training on {} streams, {:.0} s; validating on {}, {:.0} s",
            corpus.streams.len(),
            corpus.seconds(),
            validation.streams.len(),
            validation.seconds(),
        ));
        self.device.seed(preset.seed);
        let mut model = preset.teacher.init(preset.classes, &self.device);
        if let Some(start) = &self.plan.start {
            model = self.started(start, model)?;
        }
        if preset.teacher_training.epochs == 0 {
            self.run.save_model(teacher::training::NAME, &model)?;
            return Ok(());
        }
        teacher::training::train(
            model,
            preset.teacher.grid(),
            &corpus,
            &validation,
            &preset.teacher_training,
            preset.seed,
            &self.device,
            self.run,
            self.resume,
            self.interrupt,
        )?;
        Ok(())
    }

    /// The weights that training starts from: another run's teacher, or a checkpoint in the reference's format.
    fn started(&self, start: &Path, model: Teacher) -> anyhow::Result<Teacher> {
        if start.is_dir() {
            let model = RunFolder::existing(start)?.load_model(teacher::training::NAME, model)?;
            return Ok(model);
        }
        Ok(teacher::checkpoint::load(start, model)?)
    }

    /// Trains the student, from the teacher if there is one and the preset listens to it.
    ///
    /// # Errors
    /// When the teacher is missing, the folder cannot be written or the user interrupts.
    pub fn distill(&self) -> anyhow::Result<()> {
        if !self.resume {
            self.run.forget(&[READING, FIGURES])?;
        }
        self.train_student(distillation::NAME, &self.plan.preset.distillation)
    }

    /// Trains a second student on the labels alone: the difference is what distillation buys.
    ///
    /// # Errors
    /// When the folder cannot be written or the user interrupts.
    pub fn train_alone(&self) -> anyhow::Result<()> {
        let labels_alone = Distillation {
            teacher_share: 0.0,
            ..self.plan.preset.distillation.clone()
        };
        self.train_student(distillation::ALONE, &labels_alone)
    }

    /// Trains the paper's baselines.
    ///
    /// # Errors
    /// When there is nothing to learn from, the folder cannot be written or the user interrupts.
    pub fn train_peers(&self, peers: &[Peer]) -> anyhow::Result<()> {
        let lesson = Lesson {
            training: &self.plan.training(self.library),
            validation: &self.plan.validation(self.library),
            settings: &self.plan.preset.peers,
            seed: self.plan.preset.seed,
            device: &self.device,
            run: self.run,
            resume: self.resume,
            interrupt: self.interrupt,
        };
        peers
            .iter()
            .try_for_each(|&peer| peers::training::train(peer, &lesson))
    }

    fn train_student(&self, name: &'static str, config: &Distillation) -> anyhow::Result<()> {
        let preset = &self.plan.preset;
        let corpus = self.plan.training(self.library);
        let validation = self.plan.validation(self.library);
        let teacher = if config.teacher_share > 0.0 {
            let streams: Vec<&[CleanSample]> = corpus
                .streams
                .iter()
                .map(|stream| stream.emg.as_slice())
                .collect();
            Some(self.teacher_rows(&streams)?)
        } else {
            None
        };
        self.device.seed(preset.seed);
        let model = preset.student.init(preset.classes, &self.device);
        distillation::train(
            name,
            model,
            preset.student.span,
            &corpus,
            teacher,
            &validation,
            config,
            preset.seed,
            &self.device,
            self.run,
            self.resume,
            self.interrupt,
        )?;
        Ok(())
    }

    /// Writes the model file and returns its bytes.
    ///
    /// The reading of the look-ahead is the one that follows more transitions of the validation
    /// subjects.
    ///
    /// # Errors
    /// When the student is missing or no device can run it.
    pub fn quantize(&self, out: &Path) -> anyhow::Result<Vec<u8>> {
        let bytes = self.model_file(&self.student(distillation::NAME)?, self.aggregation()?)?;
        write_whole(out, &bytes)?;
        Ok(bytes)
    }

    fn model_file(&self, student: &Student, aggregation: LookAhead) -> anyhow::Result<Vec<u8>> {
        let preset = &self.plan.preset;
        let split = &self.plan.split;
        let sets = |subjects: &[String]| {
            let mut sets: Vec<String> = subjects
                .iter()
                .filter_map(|s| s.split('/').next())
                .map(str::to_owned)
                .collect();
            sets.dedup();
            sets
        };
        let figures: Vec<Figure> = if self.run.file(FIGURES).exists() {
            self.run.load_json(FIGURES)?
        } else {
            Vec::new()
        };
        let provenance = ProvenanceParts {
            data_sets: sets(&split.training),
            subjects_left_out: split.held_out.clone(),
            git_revision: self.plan.git_revision.clone().unwrap_or_default(),
            seed: preset.seed,
            metrics: figures
                .into_iter()
                .map(|figure| (figure.name, figure.value))
                .collect(),
        };
        let smoother = SmootherDefaults {
            aggregation: match reading {
                LookAhead::SameInstant => AggregationMode::SameInstant,
                LookAhead::None | LookAhead::AllRows => AggregationMode::AllRowsFrom,
            },
            look_ahead: LOOK_AHEAD,
            hold: HOLD,
        };
        quantize(student, preset, smoother, provenance)
            .context("this student cannot become a model file")
    }

    /// Judges whatever the run has trained on the subjects left out: teacher, float student and, of a
    /// model file, integer student; and every peer.
    ///
    /// # Errors
    /// When there is no model, or one of them is damaged.
    pub fn evaluate(&self, model_file: Option<&[u8]>) -> anyhow::Result<(Results, Judged)> {
        let trials = trial::published(self.plan, self.library);
        let spliced = trial::spliced(self.plan, self.library);
        if trials.is_empty() {
            bail!(
                "no labelled recording of a left-out subject is at hand: name subjects under data.held_out"
            );
        }
        let reading = self.aggregation()?;
        let published = self.candidates(&trials, model_file)?;
        if published.is_empty() {
            bail!("no model in this run's folder: train one first");
        }
        let in_random_order = self.candidates(&spliced, model_file)?;
        let results = Results {
            held_out: self.plan.split.held_out.clone(),
            aggregation,
            published: self.judge_all(&published, &trials, &[Truth::Published, Truth::Moved])?,
            spliced: self.judge_all(&in_random_order, &spliced, &[Truth::Moved])?,
        };
        self.run.save_json(RESULTS, &results)?;
        self.run.save_json(FIGURES, &figures(&results))?;
        Ok((
            results,
            Judged {
                trials,
                candidates: published,
                aggregation,
            },
        ))
    }

    fn judge_all(
        &self,
        candidates: &[Candidate],
        trials: &[Trial],
        truths: &[Truth],
    ) -> anyhow::Result<Vec<Verdict>> {
        let mut verdicts = Vec::new();
        if trials.is_empty() {
            return Ok(verdicts);
        }
        for &truth in truths {
            for candidate in candidates {
                for look_ahead in candidate.conditions() {
                    verdicts.extend(judge(
                        candidate,
                        trials,
                        self.plan.preset.vocabulary(),
                        look_ahead,
                        truth,
                    )?);
                }
            }
        }
        Ok(verdicts)
    }

    fn candidates(
        &self,
        trials: &[Trial],
        model_file: Option<&[u8]>,
    ) -> anyhow::Result<Vec<Candidate>> {
        let mut candidates = Vec::new();
        if self.has(teacher::training::NAME) {
            candidates.push(self.teacher_candidate(TEACHER, trials)?);
        }
        candidates.extend(peers::evaluation::candidates(
            self.run,
            trials,
            self.plan.preset.classes,
            &self.device.clone().inner(),
            self.interrupt,
        )?);
        if self.has(distillation::NAME) {
            let student = self.student(distillation::NAME)?;
            candidates.push(self.student_candidate(STUDENT, &student, trials)?);
        }
        if let Some(bytes) = model_file {
            candidates.push(integer_candidate(INTEGER, bytes, trials)?);
        }
        if self.has(distillation::ALONE) {
            let student = self.student(distillation::ALONE)?;
            candidates.push(self.student_candidate(ALONE, &student, trials)?);
            let bytes = self.model_file(&student, LookAhead::AllRows)?;
            candidates.push(integer_candidate(INTEGER_ALONE, &bytes, trials)?);
        }
        Ok(candidates)
    }

    /// Whether the run's folder holds a model of this name.
    fn has(&self, name: &str) -> bool {
        self.run.model(name).exists()
    }

    fn teacher_candidate(&self, name: &str, trials: &[Trial]) -> anyhow::Result<Candidate> {
        let (model, grid) = (self.teacher()?, self.plan.preset.teacher.grid());
        let plain = self.device.clone().inner();
        let rows = |emg: &[CleanSample]| teacher_logits(&model, grid, emg, &plain);
        Ok(self.candidate(name, trials, rows)?)
    }

    fn student_candidate(
        &self,
        name: &str,
        student: &Student,
        trials: &[Trial],
    ) -> Result<Candidate, RunError> {
        let plain = self.device.clone().inner();
        self.candidate(name, trials, |emg| student_logits(student, emg, &plain))
    }

    fn candidate(
        &self,
        name: &str,
        trials: &[Trial],
        rows: impl Fn(&[CleanSample]) -> Vec<LookBackLogits> + Sync,
    ) -> Result<Candidate, RunError> {
        let streams: Vec<&[CleanSample]> =
            trials.iter().map(|trial| trial.emg.as_slice()).collect();
        let rows = self.ask(name, &streams, rows)?;
        Ok(Candidate {
            name: name.to_owned(),
            looks_back: true,
            rows,
        })
    }

    /// A model's rows over many streams, as many streams at once as there are cores.
    fn ask(
        &self,
        name: &str,
        streams: &[&[CleanSample]],
        rows: impl Fn(&[CleanSample]) -> Vec<LookBackLogits> + Sync,
    ) -> Result<Vec<Vec<LookBackLogits>>, RunError> {
        parallel::map(name, streams, self.run, self.interrupt, |emg| rows(emg))
    }

    /// The reading with which the student, or a teacher without one, follows more transitions of the
    /// validation subjects; all rows on a tie.
    fn reading(&self) -> anyhow::Result<LookAhead> {
        if self.run.file(READING).exists() {
            return Ok(if self.run.load_json::<bool>(READING)? {
                LookAhead::SameInstant
            } else {
                LookAhead::AllRows
            });
        }
        let trials = trial::validation(self.plan, self.library);
        let candidate = if self.has(distillation::NAME) {
            let student = self.student(distillation::NAME)?;
            self.student_candidate(CHOOSING, &student, &trials)?
        } else if self.has(teacher::training::NAME) {
            self.teacher_candidate(CHOOSING, &trials)?
        } else {
            return Ok(LookAhead::AllRows);
        };
        let correct = |look_ahead| -> anyhow::Result<usize> {
            let verdicts = judge(
                &candidate,
                &trials,
                self.plan.preset.vocabulary(),
                look_ahead,
                Truth::Moved,
            )?;
            Ok(verdicts
                .last()
                .map_or(0, |verdict| verdict.widest().correct))
        };
        let same_instant = correct(LookAhead::SameInstant)? > correct(LookAhead::AllRows)?;
        self.run.save_json(READING, &same_instant)?;
        Ok(if same_instant {
            LookAhead::SameInstant
        } else {
            LookAhead::AllRows
        })
    }

    /// The trained teacher, without gradients.
    ///
    /// # Errors
    /// When it is missing or of another shape.
    pub fn teacher(&self) -> Result<Teacher, RunError> {
        let plain = self.device.clone().inner();
        let preset = &self.plan.preset;
        self.run
            .load_model(
                teacher::training::NAME,
                preset.teacher.init(preset.classes, &plain),
            )
            .map(|model| model.valid())
    }

    /// A trained student by the name of its files, without gradients.
    ///
    /// # Errors
    /// When it is missing or of another shape.
    pub fn student(&self, name: &str) -> Result<Student, RunError> {
        let plain = self.device.clone().inner();
        let preset = &self.plan.preset;
        self.run
            .load_model(name, preset.student.init(preset.classes, &plain))
            .map(|model| model.valid())
    }

    /// The teacher's word on every patch of the training streams; computed once and kept.
    fn teacher_rows(&self, streams: &[&[CleanSample]]) -> anyhow::Result<Vec<Vec<LookBackLogits>>> {
        let checkpoint = self.run.model(teacher::training::NAME);
        let weights = std::fs::read(&checkpoint).with_context(|| {
            format!(
                "{}: no teacher to learn from; run `myointent train` first",
                checkpoint.display()
            )
        })?;
        let key = crc32(&weights);
        let path = self.run.file(TEACHER_ROWS);
        if let Some(rows) = std::fs::read(&path)
            .ok()
            .and_then(|bytes| unpack(&bytes, key, streams))
        {
            return Ok(rows);
        }
        let model = self.teacher()?;
        let plain = self.device.clone().inner();
        let grid = self.plan.preset.teacher.grid();
        let all = self.ask("asking the teacher", streams, |emg| {
            teacher_logits(&model, grid, emg, &plain)
        })?;
        write_whole(&path, &pack(&all, key))?;
        Ok(all)
    }
}

/// What the report draws from: the trials and every model's rows on them.
pub struct Judged {
    /// The recordings.
    pub trials: Vec<Trial>,
    /// Every model of the run.
    pub candidates: Vec<Candidate>,
    /// The reading that the model file asks for.
    pub aggregation: LookAhead,
}

fn integer_candidate(name: &str, bytes: &[u8], trials: &[Trial]) -> anyhow::Result<Candidate> {
    let model = Model::parse(bytes).context("the model file just written")?;
    let rows = trials
        .par_iter()
        .map(|trial| integer_rows(&model, &trial.emg))
        .collect::<anyhow::Result<_>>()?;
    Ok(Candidate {
        name: name.to_owned(),
        looks_back: true,
        rows,
    })
}

/// An integer student's rows at every whole patch of a stream, as the device computes them.
///
/// # Errors
/// When the encoder refuses the model.
pub fn integer_rows(model: &Model<'_>, emg: &[CleanSample]) -> anyhow::Result<Vec<LookBackLogits>> {
    let stream = padded(emg);
    let (patches, _) = stream.as_chunks::<PATCH>();
    Ok(any_encoder::outputs(model, patches)?
        .into_iter()
        .skip(WINDOW_PATCHES)
        .collect())
}

/// What a model file says about the integer student's accuracy.
fn figures(results: &Results) -> Vec<Figure> {
    let mut figures = Vec::new();
    let chosen = results.published.iter().filter(|verdict| {
        verdict.model == INTEGER
            && verdict.look_ahead == results.aggregation
            && verdict.truth == Truth::Moved
    });
    for verdict in chosen {
        let widest = verdict.widest();
        let mut keep = |what: &str, mean: Option<f64>| {
            if let Some(value) = mean {
                #[expect(clippy::cast_possible_truncation, reason = "an accuracy")]
                figures.push(Figure {
                    name: format!("{} {what}", verdict.data_set),
                    value: value as f32,
                });
            }
        };
        keep("raw accuracy", widest.raw_accuracy.map(|raw| raw.mean));
        keep(
            "transition accuracy",
            widest.transition_accuracy.map(|transition| transition.mean),
        );
    }
    figures
}

fn crc32(bytes: &[u8]) -> u32 {
    crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(bytes)
}

fn pack(all: &[Vec<LookBackLogits>], key: u32) -> Vec<u8> {
    let mut bytes = key.to_le_bytes().to_vec();
    for value in all.iter().flatten().flatten().flatten() {
        bytes.extend(value.to_le_bytes());
    }
    bytes
}

fn unpack(bytes: &[u8], key: u32, streams: &[&[CleanSample]]) -> Option<Vec<Vec<LookBackLogits>>> {
    let (found, bytes) = bytes.split_first_chunk::<4>()?;
    let patches: usize = streams.iter().map(|emg| emg.len() / PATCH).sum();
    if u32::from_le_bytes(*found) != key || bytes.len() != patches * size_of::<LookBackLogits>() {
        return None;
    }
    let (values, _) = bytes.as_chunks::<4>();
    let mut values = values.iter().map(|&value| f32::from_le_bytes(value));
    let mut next =
        || std::array::from_fn(|_| std::array::from_fn(|_| values.next().unwrap_or(0.0)));
    Some(
        streams
            .iter()
            .map(|emg| (0..emg.len() / PATCH).map(|_| next()).collect())
            .collect(),
    )
}
