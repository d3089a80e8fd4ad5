//! `myointent export`: weights for other programs, the teacher's or the float student's.

use std::io::Write as _;
use std::path::PathBuf;

use ::presets::distillation;
use anyhow::Context as _;
use clap::Args;
use execution::run_folder::write_whole;
use shared::model::file::Model;

use super::find_run;
use crate::cli::output::refuse_existing;
use crate::cli::read_model;
use training::backend::BackendArguments;
use training::run::context::{load_student, load_teacher};
use training::student::onnx;
use training::teacher::checkpoint;

#[derive(Debug, Args)]
#[command(
    after_help = "The reference's code reads the teacher if the run's preset is `paper`. `myointent train --from FILE` reads it\n\
    and the reference's own checkpoints. docs/python.md describes the ONNX file.\n\n\
    Examples:\n  myointent export --run runs/mine\n  myointent export --run runs/mine --onnx\n  \
    myointent export --onnx --model models/three-class.intent --out three-class.onnx"
)]
pub struct Arguments {
    /// Run folder of `myointent train`.
    #[arg(long, value_name = "DIR", default_value = "runs/latest")]
    run: PathBuf,
    /// Write the float student as ONNX instead of the teacher: one step of a stream.
    #[arg(long)]
    onnx: bool,
    /// Model file whose student is written, with the weights that its integers mean, instead of the run's.
    #[arg(long, value_name = "FILE.intent", requires_all = ["onnx", "out"], conflicts_with = "run")]
    model: Option<PathBuf>,
    /// File to write; it must not exist.
    ///
    /// `teacher.safetensors` in the run folder if not given, or `student.onnx`.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Writes the teacher as safetensors, or the student as ONNX.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.out.as_deref().map_or(Ok(()), refuse_existing)?;
    let out = match (&arguments.model, &arguments.out) {
        (Some(path), Some(out)) => {
            let bytes = read_model(path)?;
            let model = Model::parse(&bytes);
            let model = model.with_context(|| format!("{} is refused", path.display()))?;
            write_whole(out, &onnx::of_file(&model))?;
            out.clone()
        }
        _ => of_run(arguments)?,
    };
    writeln!(std::io::stdout(), "{}", out.display())?;
    Ok(())
}

/// Writes a model of the run folder; returns the file.
fn of_run(arguments: &Arguments) -> anyhow::Result<PathBuf> {
    let (mut folder, config) = find_run(&arguments.run)?;
    if arguments.out.is_none() {
        folder = folder.locked()?;
    }
    let out = |name| arguments.out.clone().unwrap_or_else(|| folder.file(name));
    let device = arguments.backend.device()?.inner();
    if arguments.onnx {
        let out = out("student.onnx");
        let student = load_student(&folder, &config, distillation::NAME, &device)?;
        let preset = &config.preset;
        let file = onnx::onnx(&student, preset.vocabulary(), preset.preprocessing());
        write_whole(&out, &file)?;
        return Ok(out);
    }
    let out = out("teacher.safetensors");
    let teacher = load_teacher(&folder, &config, &device)?;
    checkpoint::save(&out, &teacher, &config.subjects_seen())?;
    Ok(out)
}
