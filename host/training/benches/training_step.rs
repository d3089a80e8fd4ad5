//! Seconds of a training step of teacher and student and of a window's inference, for comparison with
//! PyTorch by `host/training/benches/torch/compare.py`.
//!
//! The arguments are a preset and the teacher's batch size. For each line of input it prints a line of
//! JSON: for `step` the seconds of the teacher's training step (batch, forward, backward, AdamW) on two
//! threads, for `student` those of the student's, for `window` those of one window's inference on one
//! thread. For `student-case` it prints a student's parameters, in the order of the module, an input and the logits.

use std::io::BufRead as _;
use std::time::Instant;
use training::teacher::model::Teacher;

use anyhow::{Context as _, anyhow, bail};
use burn::module::{Module, ModuleVisitor, Param};
use burn::tensor::{Device, Tensor};
use presets::Preset;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use recordings::corpus::{Corpus, Stream};
use recordings::synthetic::{self, SynthOptions};
use shared::intent::Vocabulary;
use shared::units::{CHANNELS, PATCH};
use training::optimization::learner::Learner as _;
use training::optimization::optimizer::{gradients, optimizer};
use training::optimization::read_back;
use training::student::learner::{StudentLearner, Teaching};
use training::student::model::Student;
use training::teacher::learner::TeacherLearner;
use training::teacher::model::TeacherInput;

// The same allocator as in the program (host/src/main.rs).
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> anyhow::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, batch] = arguments.as_slice() else {
        println!("usage: training_step PRESET BATCH; see host/training/benches/torch/compare.py");
        return Ok(());
    };
    let mut preset = Preset::find(name).map_err(|e| anyhow!("{e}"))?;
    preset.teacher_training.batch = batch.parse().context("a batch is a number")?;
    let pool = |threads| {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .context("threads for the bench")
    };
    let (one, two) = (pool(1)?, pool(2)?);

    let recording = synthetic::generate(&SynthOptions {
        subjects: 1,
        recordings: 1,
        seconds: 120,
        ..SynthOptions::default()
    })
    .remove(0);
    let labels = recording.labels_in(Vocabulary::Three);
    let corpus = Corpus {
        vocabulary: Vocabulary::Three,
        other: false,
        streams: vec![Stream::new(recording.samples, labels)],
    };
    let device = Device::default().autodiff();
    let settings = &preset.teacher_training;
    let shape = preset.teacher.window_shape();
    let learner = TeacherLearner::new(shape, &corpus, &corpus, settings, 42, &device);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let item = learner.epoch(&mut rng).remove(0);
    if item.len() != settings.batch {
        bail!("a batch of {} from the recording, not {batch}", item.len());
    }
    let mut model = Some(Teacher::new(&preset.teacher, 3, &device));
    let mut adam = optimizer(settings.weight_decay);
    let distillation = &preset.distillation;
    let span = preset.student.span;
    let student_learner = StudentLearner::new(
        "student",
        span,
        &corpus,
        Teaching::Labels,
        &corpus,
        distillation,
        &device,
    );
    let excerpts = student_learner.epoch(&mut rng).remove(0);
    let mut student = Student::new(&preset.student, 3, false, &device);
    let mut student_adam = optimizer(distillation.weight_decay);
    let emg = vec![0.5; shape.window * CHANNELS];

    for line in std::io::stdin().lock().lines() {
        let line = line?;
        if line.trim() == "student-case" {
            println!("{}", student_case(&student, &device)?);
            continue;
        }
        let before = model.take().context("put back below")?;
        let (start, busy) = (Instant::now(), processor_seconds());
        model = Some(match line.trim() {
            "step" => two.install(|| {
                let shards = learner.shards(&item, &mut rng);
                let (gradients, _) = gradients(&learner, &before, shards);
                adam.step(1e-4, before, gradients)
            }),
            "window" => one.install(|| {
                let plain = device.clone().inner();
                let input = TeacherInput::for_inference(emg.clone(), shape, 3, &plain);
                drop(read_back(before.valid().forward(input).intent));
                before
            }),
            "student" => two.install(|| {
                let shards = student_learner.shards(&excerpts, &mut rng);
                let (gradients, _) = gradients(&student_learner, &student, shards);
                student = student_adam.step(1e-4, student.clone(), gradients);
                before
            }),
            other => bail!("step, student, window or student-case, not `{other}`"),
        });
        let seconds = start.elapsed().as_secs_f64();
        let busy = processor_seconds() - busy;
        println!(
            "{{\"seconds\": {seconds}, \"processor\": {busy}, \"peak_mib\": {}}}",
            peak_mib()
        );
    }
    Ok(())
}

/// A student's parameters, an input of 60 patches and the logits of all outputs, as JSON.
fn student_case(student: &Student, device: &Device) -> anyhow::Result<String> {
    let mut parameters = Parameters(Vec::new());
    student.visit(&mut parameters);
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let emg: Vec<f32> = (0..60 * PATCH * CHANNELS).map(|_| rng.random()).collect();
    let input = Tensor::<1>::from_floats(emg.as_slice(), device);
    let logits = student.forward(input.reshape([1, 60, PATCH * CHANNELS]));
    let case = serde_json::json!({
        "parameters": parameters.0,
        "emg": emg,
        "logits": read_back(logits),
    });
    Ok(serde_json::to_string(&case)?)
}

/// Collector of all parameters, in the order in which the module visits them.
struct Parameters(Vec<f32>);

impl ModuleVisitor for Parameters {
    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        self.0.extend(param.val().into_data().iter::<f32>());
    }
}

/// Largest resident size so far; 0 on systems other than Linux.
fn peak_mib() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kib = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    kib.unwrap_or(0.0) / 1024.0
}

/// Processor time of all threads so far, in seconds; 0 on systems other than Linux.
fn processor_seconds() -> f64 {
    let threads = std::fs::read_dir("/proc/self/task").into_iter().flatten();
    let nanoseconds = threads.flatten().filter_map(|thread| {
        let text = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse::<f64>().ok()
    });
    nanoseconds.sum::<f64>() * 1e-9
}
