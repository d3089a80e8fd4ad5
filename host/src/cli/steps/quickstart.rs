//! `myointent quickstart`: from recordings to an evaluated model file in one command.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;

use super::{DataArguments, log_labels, resume_run};
use evaluation::System;
use evaluation::report::run_report::{self, REPORT};
use evaluation::report::scores::{summary, tables};
use execution::interrupt::Interrupt;
use execution::progress;
use execution::run_folder::RunFolder;
use presets::Preset;
use presets::config::ResolvedConfig;
use training::backend::BackendArguments;
use training::run::context::RunContext;
use training::run::evaluate::{Results, evaluate};
use training::run::quantize::{MODEL, ModelFile, quantize};
use training::run::train::train;

/// Arguments of `quickstart`.
#[derive(Debug, Args)]
#[command(
    after_help = "The last lines of the output name the recordings and the held-out subjects.\n\n\
    Examples:\n  myointent quickstart --data recordings\n  \
    myointent quickstart --preset cpu --data recordings --run runs/cpu"
)]
pub struct Arguments {
    /// Run folder to write checkpoints, metrics, model file and report to.
    #[arg(long, value_name = "DIR", default_value = "runs/quickstart")]
    run: PathBuf,
    /// Built-in preset or a TOML file; quickstart if not given.
    #[arg(long)]
    preset: Option<String>,
    /// Seed of all random numbers, instead of the preset's, which is 42 in the built-in presets.
    #[arg(long)]
    seed: Option<u64>,
    /// Continue an interrupted quickstart of this run folder.
    ///
    /// Options that decide the outcome may be left out; if given, they must be those that the run began with.
    #[arg(long)]
    resume: bool,
    /// Begin anew in a run folder that holds a run, in its place.
    ///
    /// Without it, such a folder is refused.
    #[arg(long, conflicts_with = "resume")]
    overwrite: bool,
    /// Train the teacher even if the preset's student does not learn from it.
    #[arg(long)]
    teacher: bool,
    /// Print all tables, not only the scores of the model file.
    #[arg(long)]
    verbose: bool,
    #[command(flatten)]
    data: DataArguments,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Trains, distils, quantizes, evaluates and writes the report.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut preset = Preset::find(arguments.preset.as_deref().unwrap_or("quickstart"))?;
    preset.seed = arguments.seed.unwrap_or(preset.seed);
    let context = begin(arguments, preset)?;
    log_start(&context);

    train(&context, arguments.teacher)?;
    let model = context.folder.file(MODEL);
    quantize(&context, &model)?;
    let file = ModelFile::of_run(&context)?;
    let (results, evaluation) = evaluate(&context, file.as_ref())?;
    // Written again, now with the scores in the header.
    quantize(&context, &model)?;
    let page = context.folder.file(REPORT);
    run_report::write(
        &context.folder,
        &context.config,
        &results,
        &evaluation,
        &page,
    )?;

    let mut out = std::io::stdout().lock();
    if arguments.verbose {
        for table in tables(&results, true) {
            writeln!(out, "{}", table.plain())?;
        }
    }
    let recordings = recordings_used(&context);
    write!(out, "{}", last_screen(&results, &recordings, &model, &page))?;
    Ok(())
}

/// Describes where the recordings come from, and how many files were left out.
fn recordings_used(context: &RunContext) -> String {
    let recordings = match &context.config.data {
        Some(path) => path.display().to_string(),
        None => "synthetic".to_owned(),
    };
    match context.library.skipped.len() {
        0 => recordings,
        files => format!("{recordings}; damaged files left out: {files}"),
    }
}

/// Formats the end of the output, at most 20 lines: scores of the model file, and the paths of the results.
fn last_screen(results: &Results, recordings: &str, model: &Path, page: &Path) -> String {
    let (model, page) = (model.display(), page.display());
    format!(
        "{}, held-out subjects, lag-compensated labels: mean (95 % interval)\n\
        {}\n\
        recordings: {recordings}\n\
        held out:   {}\n\
        model file: {model}\n\
        report:     {page}\n\
        next:       myointent replay {model} RECORDING    # the UART lines of the device\n",
        System::Integer,
        summary(results).plain(),
        by_data_set(&results.held_out),
    )
}

/// Formats subjects by data set: `roshambo 03, 06; ss-stm sub3`.
fn by_data_set(subjects: &[String]) -> String {
    let mut sets: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for subject in subjects {
        let (set, name) = subject.split_once('/').unwrap_or(("", subject));
        sets.entry(set).or_default().push(name);
    }
    let sets: Vec<_> = sets
        .into_iter()
        .map(|(set, names)| format!("{set} {}", names.join(", ")))
        .collect();
    sets.join("; ")
}

fn begin(arguments: &Arguments, preset: Preset) -> anyhow::Result<RunContext> {
    let run = &arguments.run;
    if arguments.resume && !repeated(arguments) {
        return resume_run(run, arguments.backend, &arguments.data, None);
    }
    if !arguments.resume && !arguments.overwrite {
        RunFolder::refuse_run(run)?;
    }
    let device = arguments.backend.device()?;
    let library = arguments.data.load(&preset)?;
    let (data, strict) = (arguments.data.folder(), arguments.data.strict);
    let config = ResolvedConfig::new(preset, &library, data.as_deref(), strict, None)?;
    if arguments.resume {
        let repeated = Some((config, library));
        return resume_run(run, arguments.backend, &arguments.data, repeated);
    }
    let folder = RunFolder::open(run)?;
    Ok(RunContext {
        interrupt: Interrupt::listen(),
        ..RunContext::begin(folder, config, library, device)?
    })
}

/// Whether the command repeats options that decide the outcome.
fn repeated(arguments: &Arguments) -> bool {
    arguments.preset.is_some() || arguments.seed.is_some() || arguments.data.strict
}

fn log_start(context: &RunContext) {
    let config = &context.config;
    progress::log(&format!(
        "training on {} subjects: {}",
        config.split.training.len(),
        config.split.training.join(", ")
    ));
    progress::log(&format!("held out: {}", config.split.held_out.join(", ")));
    log_labels(config);
}

#[cfg(test)]
mod tests {
    use super::*;
    use evaluation::metric::event::summary::SubjectEvents;
    use evaluation::metric::event::{EventRule, RecordingEvents};
    use evaluation::metric::offset;
    use evaluation::metric::summary::SubjectScore;
    use evaluation::{ALL, LookAhead, Score};
    use shared::intent::Intent;

    fn score(model: System, look_ahead: LookAhead, data_set: &str) -> Score {
        let subject = |subject: &str, balanced| SubjectScore {
            subject: subject.to_owned(),
            recordings: 3,
            classes: 3,
            balanced_accuracy: Some(balanced),
            raw_accuracy: Some(0.865),
            correct: 1,
            events: 2,
            transition_accuracy: Some(0.525),
            offsets: vec![32],
            offset: offset::summary(&[32]),
        };
        let subjects = vec![subject("1", 0.6), subject("2", 1.0)];
        let (truth, emitted) = ([Some(Intent::Relax); 400], [Some(Intent::Relax); 400]);
        let events = RecordingEvents::new(&truth, &emitted, &[], &EventRule::default()).unwrap();
        let events = ["1", "2"].map(|subject| SubjectEvents::new(subject, [&events]));
        Score {
            model,
            data_set: data_set.to_owned(),
            look_ahead,
            ..Score::of_people(subjects, events.to_vec())
        }
    }

    #[test]
    fn the_last_screen_has_at_most_20_lines_and_its_table_100_columns() {
        let sets = [
            "cote-allard",
            "emg-epn-612",
            "myo-readings",
            "one-subject-myo",
            "own",
            "roshambo",
            "ss-stm",
            "synthetic",
            ALL,
        ];
        let mut published = sets
            .map(|set| score(System::Integer, LookAhead::SameInstant, set))
            .to_vec();
        let floors = [System::Constant, System::Energy];
        published.extend(floors.map(|floor| score(floor, LookAhead::None, ALL)));
        let results = Results {
            held_out: vec![
                "ss-stm/sub3".into(),
                "roshambo/03".into(),
                "roshambo/06".into(),
            ],
            aggregation: LookAhead::SameInstant,
            gestures: BTreeMap::new(),
            published,
        };
        let (model, page) = (Path::new("m.intent"), Path::new("report.html"));
        let screen = last_screen(&results, "recordings", model, page);
        let lines: Vec<&str> = screen.lines().collect();
        assert!(lines.len() <= 20, "{screen}");
        assert!(
            lines[..lines.len() - 5]
                .iter()
                .all(|line| line.len() <= 100),
            "{screen}"
        );
        assert!(
            screen.contains("held out:   roshambo 03, 06; ss-stm sub3\n"),
            "{screen}"
        );
        let row = "roshambo         all 3        0.80        0.53       -        -        0.0  2";
        assert!(lines.contains(&row), "{screen}");
        for floor in ["all: relax ", "all: energy "] {
            assert!(lines.iter().any(|line| line.starts_with(floor)), "{screen}");
        }
    }
}
