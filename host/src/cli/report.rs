//! `myointent report`: one page on one or several runs or model files.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;

#[cfg(feature = "train")]
use super::arguments::warn_of_test_people;
use super::evaluate_models::{PeopleArguments, warn};
use super::output::{PAGE, Width, refuse_unlike};
#[cfg(feature = "train")]
use super::steps::{find_run, recordings};
use evaluation::model_evaluation::{NamedModel, Selection, evaluate_models, is_taken};
use evaluation::report::MOST_ENTRIES;
use evaluation::report::several::{Evaluated, Reported, tables, write};
use evaluation::results::MODEL;
use execution::progress;
use execution::run_folder::RunFolder;
use recordings::Library;
#[cfg(feature = "train")]
use {
    recordings::split::predefined::is_test,
    training::{
        backend::BackendArguments,
        run::{context::RunContext, evaluate::kept},
    },
};

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  myointent report runs/mine\n  myointent report models/three-class.intent --data DIR",
    after_long_help = "Without --data, of run folders that were evaluated: their results, on the people whom each holds out. With --data, of model\n\
    files and of the model files of run folders, on any recordings; each is evaluated on the people whom it has not seen, or if\n\
    it has seen everybody (a model tuned on its owner), on all of them, and marked. People with all classes of the model and\n\
    people with fewer stand in rows of their own; n is a column's number of people where its row has more.\n\
    The page needs no network and no JavaScript, and prints on A4.\n\n\
    Examples:\n  myointent report runs/mine\n  \
    myointent report runs/loso/fold-1 runs/loso/fold-2 --out folds.html\n  \
    myointent report models/three-class.intent runs/mine --data DIR"
)]
pub struct Arguments {
    /// Run folders; with --data also model files.
    ///
    /// At most five.
    #[arg(value_name = "RUN|MODEL", required = true)]
    reported: Vec<PathBuf>,
    /// Evaluate on the recordings below DIR.
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Page to write.
    ///
    /// An earlier page is replaced, no other file.
    #[arg(long, value_name = "FILE", default_value = "report.html")]
    out: PathBuf,
    #[command(flatten)]
    width: Width,
    #[command(flatten)]
    people: PeopleArguments,
    #[cfg(feature = "train")]
    #[command(flatten)]
    backend: BackendArguments,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if arguments.reported.len() > MOST_ENTRIES {
        bail!(
            "{} on one page: expected at most {MOST_ENTRIES}, for their colours to differ",
            arguments.reported.len()
        );
    }
    refuse_unlike(&arguments.out, PAGE)?;
    let reported = match &arguments.data {
        Some(data) => models(arguments, data)?,
        None => runs(arguments)?,
    };
    let data = arguments.data.as_ref();
    let data = data.map_or_else(String::new, |data| data.display().to_string());
    write(&reported, &data, &arguments.out)?;
    let mut out = std::io::stdout().lock();
    let tables = tables(&reported, arguments.width.wide)?;
    arguments.width.print(&tables, &mut out)?;
    writeln!(out, "report: {}", arguments.out.display())?;
    Ok(())
}

#[cfg(feature = "train")]
/// Evaluated run folders, each on its held-out people.
fn runs(arguments: &Arguments) -> anyhow::Result<Vec<Reported>> {
    let mut reported: Vec<Reported> = Vec::new();
    for path in &arguments.reported {
        if path.is_file() {
            bail!(
                "{}: a model file needs recordings: give --data DIR",
                path.display()
            );
        }
        let (folder, config) = find_run(path)?;
        let library = recordings(config.data.as_deref(), config.strict, &config.preset)?;
        let test = config.split.held_out.iter();
        warn_of_test_people(test.filter(|subject| is_test(subject)).count());
        let device = arguments.backend.device()?;
        let context = RunContext::continue_run(folder, config, library, device)?;
        let evaluated = kept(&context).with_context(|| {
            let run = path.display();
            format!("{run} has no results to report: `myointent evaluate --run {run}` makes them")
        });
        let (results, evaluation) = evaluated?;
        reported.push(Reported {
            name: unique(name(path), &reported),
            folder: Some(context.folder),
            evaluated: Evaluated::Run(Box::new((context.config, results, evaluation))),
        });
    }
    same_classes(&reported)?;
    Ok(reported)
}

#[cfg(not(feature = "train"))]
fn runs(_: &Arguments) -> anyhow::Result<Vec<Reported>> {
    bail!("give --data DIR; {}", super::WITHOUT_TRAINING)
}

/// Model files, and the model files of run folders, on the recordings below `data`.
fn models(arguments: &Arguments, data: &Path) -> anyhow::Result<Vec<Reported>> {
    let library = arguments.people.recordings(&[data])?;
    let mut reported: Vec<Reported> = Vec::new();
    for path in &arguments.reported {
        let own = model(arguments, path, &library, &reported)?;
        reported.push(own);
    }
    same_classes(&reported)?;
    Ok(reported)
}

fn model(
    arguments: &Arguments,
    path: &Path,
    library: &Library,
    before: &[Reported],
) -> anyhow::Result<Reported> {
    let folder = path
        .is_dir()
        .then(|| RunFolder::existing(path))
        .transpose()?;
    let file = match &folder {
        Some(folder) => folder.file(MODEL),
        None => path.to_owned(),
    };
    let mut model = NamedModel::read(&file).with_context(|| file.display().to_string())?;
    model.name = unique(name(path), before);
    progress::log(&format!("{}:", model.name));
    let evaluate =
        |selection: &Selection| evaluate_models(std::slice::from_ref(&model), library, selection);
    let selection = arguments.people.selection();
    let evaluation = match evaluate(&selection) {
        // A tuned model on its owner's recordings: the page marks it.
        Err(evaluation::EvaluationError::NobodyToEvaluate { seen, .. }) if seen > 0 => {
            evaluate(&Selection {
                seen: true,
                ..selection
            })
        }
        evaluation => evaluation,
    }?;
    warn(&evaluation.results);
    Ok(Reported {
        name: model.name,
        folder,
        evaluated: Evaluated::Model(Box::new(evaluation)),
    })
}

/// Name of a run folder or a model file on the page.
fn name(path: &Path) -> String {
    let own = if path.is_dir() {
        // `.` and `..` have no name of their own.
        let whole = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        whole.file_name().map(ToOwned::to_owned)
    } else {
        path.file_stem().map(ToOwned::to_owned)
    };
    own.map_or_else(
        || path.display().to_string(),
        |own| own.to_string_lossy().into_owned(),
    )
}

/// Makes a name unique: `fold-1`, `fold-1 (2)`.
fn unique(name: String, before: &[Reported]) -> String {
    let taken = |name: &str| is_taken(name) || before.iter().any(|own| own.name == name);
    if !taken(&name) {
        return name;
    }
    let numbered = (2..).map(|number| format!("{name} ({number})"));
    numbered
        .into_iter()
        .find(|numbered| !taken(numbered))
        .unwrap_or(name)
}

/// Refuses models with different classes: their scores cannot be compared.
fn same_classes(reported: &[Reported]) -> anyhow::Result<()> {
    let is_other = |own: &&Reported| own.vocabulary() != reported[0].vocabulary();
    if let Some(other) = reported.iter().find(is_other) {
        let (first, other) = (&reported[0].name, &other.name);
        bail!("{first} and {other} have different classes: give one page each");
    }
    Ok(())
}
