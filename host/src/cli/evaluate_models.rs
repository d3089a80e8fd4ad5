//! `myointent evaluate --data DIR`: model files on any recordings, without a run folder.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::Args;
use serde::Serialize;

use crate::cli::arguments::{AS_RECORDED, recordings_of, warn_of_test_people};
use crate::cli::output::{PAGE, Width, first_line, refuse_unlike};
use evaluation::model_evaluation::{
    EvaluatedSubject, Lesson, ModelResults, NamedModel, SET_ASIDE, Selection, Turn, Worn,
    evaluate_models,
};
use evaluation::report::labels;
use evaluation::report::model_report::{self, people_rows, tables};
use execution::progress;
use execution::run_folder::write_whole;
use recordings::labels::lag::LabelLag;
use recordings::synthetic::losses::MOST_PERCENT;
use recordings::{Group, Library, grouped};

/// Recordings below `--data` that a model file is evaluated on.
#[derive(Debug, Args)]
pub(in crate::cli) struct PeopleArguments {
    /// Subjects (data-set/subject) and whole data sets, separated by commas; all if not given.
    ///
    /// Whoever is named here is evaluated even if the model has seen them; test people by their own names alone, of a whole
    /// set with --test-people.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', requires = "data")]
    subjects: Vec<String>,
    /// Also evaluate people whom a model was trained on or validated with; they are marked.
    #[arg(hide_short_help = true, long, requires = "data")]
    seen: bool,
    /// Also evaluate test people (host/recordings/people.toml), who are for releases.
    #[arg(hide_short_help = true, long, requires = "data")]
    test_people: bool,
    /// Refuse damaged files instead of leaving them out.
    #[arg(hide_short_help = true, long, requires = "data")]
    strict: bool,
    #[arg(hide_short_help = true, long, requires = "data", help = AS_RECORDED)]
    as_recorded: bool,
}

impl PeopleArguments {
    pub(in crate::cli) fn recordings(&self, paths: &[impl AsRef<Path>]) -> anyhow::Result<Library> {
        recordings_of(paths, self.strict, self.as_recorded)
    }

    /// Selection of these people, with the armband as it was worn.
    pub(in crate::cli) fn selection(&self) -> Selection {
        Selection {
            subjects: self.subjects.clone(),
            seen: self.seen,
            test: self.test_people,
            ..Selection::default()
        }
    }
}

/// Options of `evaluate` for model files on any recordings.
#[derive(Debug, Args)]
#[command(next_help_heading = "Model files on any recordings (--data)")]
pub(in crate::cli) struct Options {
    /// Evaluate model files on these recordings, or those in these folders; no run folder is read or written.
    #[arg(long, value_name = "PATH", num_args = 1.., requires = "model")]
    #[cfg_attr(feature = "train", arg(conflicts_with = "run"))]
    pub(in crate::cli) data: Vec<PathBuf>,
    #[command(flatten)]
    people: PeopleArguments,
    /// Turn the armband by this many places, 0 to 7, or by another number for each person: any.
    #[arg(hide_short_help = true, long, value_name = "K", requires = "data", default_value = "0", value_parser = turn)]
    rotate: Turn,
    /// Wear the armband on the other arm.
    #[arg(hide_short_help = true, long, requires = "data")]
    mirror: bool,
    /// Evaluate each model also after alignment by each person's first openings of the hand, as the device does it.
    ///
    /// People without two are left out, and those openings are not scored.
    #[arg(hide_short_help = true, long, requires = "data")]
    align: bool,
    /// Tell each alignment on which arm the armband is.
    #[arg(hide_short_help = true, long, requires = "align")]
    arm_told: bool,
    /// Evaluate each model also after calibration by each person's first rounds, 0 to 4: a hold of each gesture and two of rest.
    ///
    /// Four rounds are set aside and not scored, whatever the number; people without them are left out. Half of the rounds judge
    /// whether the new head is used (docs/calibration.md). With --align the opening of the first round aligns the armband, as on
    /// a board.
    #[arg(hide_short_help = true, long, value_name = "ROUNDS", requires = "data", value_parser = clap::value_parser!(u8).range(0..=SET_ASIDE as i64))]
    calibrate: Option<u8>,
    /// Show six seconds of other movement to each calibration too.
    #[arg(hide_short_help = true, long, requires = "calibrate")]
    show_others: bool,
    /// Lose this share of the notifications, 0 to 66 percent, and bridge them as the device does.
    #[arg(hide_short_help = true, long, value_name = "PERCENT", requires = "data", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=MOST_PERCENT.into()))]
    lose: u8,
    /// How labels, which are cues, are moved to where the muscle acts: by each cue's own lag, where rest around it shows
    /// it; by one constant a data set, estimated on training people; or none.
    ///
    /// The output says what was done.
    #[arg(
        hide_short_help = true,
        long,
        value_name = "HOW",
        requires = "data",
        default_value = "each-cue"
    )]
    label_lag: LabelLag,
    /// Page to write, the worst person first.
    ///
    /// An earlier page is replaced, no other file.
    #[arg(
        long,
        value_name = "FILE",
        requires = "data",
        default_value = "evaluation.html"
    )]
    report: PathBuf,
    /// CSV file to write: a row for each person and model.
    ///
    /// An earlier one is replaced, no other file.
    #[arg(long, value_name = "FILE", requires = "data")]
    csv: Option<PathBuf>,
}

/// Parses the number of places that armbands are turned by.
fn turn(text: &str) -> Result<Turn, String> {
    if text == "any" {
        return Ok(Turn::Any);
    }
    let places = text.parse().ok().filter(|places| *places < 8);
    places
        .map(Turn::By)
        .ok_or_else(|| "expected 0 to 7, or any".to_owned())
}

/// Evaluates model files on the recordings of the options. Without a `width` prints JSON instead of tables.
pub(in crate::cli) fn run(
    models: &[PathBuf],
    options: &Options,
    width: Option<&Width>,
) -> anyhow::Result<()> {
    let models = models
        .iter()
        .map(|path| NamedModel::read(path).with_context(|| path.display().to_string()))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let library = options.people.recordings(&options.data)?;
    let selection = Selection {
        worn: Worn {
            turn: options.rotate,
            mirrored: options.mirror,
        },
        align: options.align && options.calibrate.is_none(),
        arm_told: options.arm_told,
        calibrate: options.calibrate.map(|rounds| Lesson {
            rounds: rounds.into(),
            others: options.show_others,
            align: options.align,
        }),
        lost_percent: options.lose,
        label_lag: options.label_lag,
        ..options.people.selection()
    };
    refuse_unlike(&options.report, PAGE)?;
    let evaluation = evaluate_models(&models, &library, &selection)?;
    let results = &evaluation.results;
    warn(results);
    let data = options.data.iter().map(|path| path.display().to_string());
    model_report::write(
        &evaluation,
        &data.collect::<Vec<_>>().join(", "),
        &options.report,
    )?;
    if let Some(path) = &options.csv {
        let table = people_rows(results).csv()?;
        refuse_unlike(path, first_line(&table))?;
        write_whole(path, &table)?;
    }
    let mut out = std::io::stdout().lock();
    let Some(width) = width else {
        let found = Evaluated {
            results,
            findings: grouped(library.findings()),
        };
        writeln!(out, "{}", serde_json::to_string_pretty(&found)?)?;
        return Ok(());
    };
    width.print(&tables(results, width.wide), &mut out)?;
    for (what, how) in labels(&results.lags, &results.gestures) {
        writeln!(out, "{what}: {how}")?;
    }
    writeln!(out, "report: {}", options.report.display())?;
    Ok(())
}

/// Results together with the findings about the recordings.
#[derive(Serialize)]
struct Evaluated<'r> {
    #[serde(flatten)]
    results: &'r ModelResults,
    findings: Vec<Group>,
}

/// Warns which people were left out, and which are for releases.
pub(in crate::cli) fn warn(results: &ModelResults) {
    let evaluated = |wanted: fn(&&EvaluatedSubject) -> bool| {
        let subjects = results.subjects.iter();
        subjects.filter(wanted).count()
    };
    for (people, what) in [
        (
            results.left_out_seen.len(),
            "left out, because a model has seen them in training (--seen)",
        ),
        (
            results.left_out_test.len(),
            "left out, because they are test people (--test-people)",
        ),
        (
            results.left_out_openings.len(),
            "left out, because they do not open the hand twice (--align)",
        ),
        (
            results.left_out_holds.len(),
            "left out, because they hold a gesture fewer than four times (--calibrate)",
        ),
        (
            evaluated(|subject| !subject.seen_by.is_empty()),
            "warning: evaluated, although a model has seen them in training",
        ),
    ] {
        if people > 0 {
            let noun = if people == 1 { "person" } else { "people" };
            progress::log(&format!("{what}: {people} {noun}"));
        }
    }
    warn_of_test_people(evaluated(|subject| subject.test));
}
