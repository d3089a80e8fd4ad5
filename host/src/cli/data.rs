//! `myointent data`: contents of a folder of recordings, and synthetic recordings.

use std::io::Write;
use std::path::PathBuf;

use anyhow::Context;
use clap::{Args, Subcommand};
use shared::intent::{Intent, Vocabulary};
use shared::units::SAMPLE_PERIOD_MS;

use super::arguments::refused;
use crate::dataset::library::inspection::{Inspection, SetInspection};
use crate::dataset::synthetic::{self, SynthOptions};
use crate::dataset::{LoadOptions, load};
use crate::report::Table;

/// How many files with the same anomaly are listed; `--json` has all.
const SHOWN: usize = 4;

/// What `myointent data` does.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Show subjects, seconds per intent, transitions, saturation and anomalies
    Inspect(InspectArguments),
    /// Write synthetic recordings, to try things without a data set
    Synth(SynthArguments),
}

/// Arguments of `myointent data inspect`.
#[derive(Args, Debug)]
#[command(
    // Not in `long_about`, which the one line of the subcommand hides.
    after_help = "Reads every recording at or below PATH and shows what is in it: a folder of \
        many data sets, one set, or one file.\n\n\
        Formats are recognised by the content of the files:\n  \
        roshambo         *_emg.npy (n, 8) of integers with *_ann.npy, a gesture's name per sample\n  \
        ss-stm           MxTy.csv, eight decimals a row (count / 128)\n  \
        cote-allard      classe_N.dat, int16, eight values a sample\n  \
        myo-readings     G.txt, eight integers and the label a row\n  \
        one-subject-myo  csv, eight integers a row, classes in metadata.json\n  \
        emg-epn-612      JSON per user with trainingSamples, testingSamples\n  \
        react-emg        csv with gt and emg_0..emg_7, or npy with the label first\n\n\
        Names of folders identify the person: keep the published layout below PATH.\n\nExamples:\n  \
        myointent data inspect recordings\n  \
        myointent data inspect recordings/s1/s1_grasp.csv --json"
)]
pub struct InspectArguments {
    /// File or folder
    path: PathBuf,
    /// Refuse damaged files instead of leaving them out and listing them
    #[arg(long)]
    strict: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Arguments of `myointent data synth`.
#[derive(Args, Debug)]
#[command(
    // Not in `long_about`, which the one line of the subcommand hides.
    after_help = "Writes synthetic recordings in ReactEMG's csv layout (OUT/s1/s1_synthetic_1.csv): \
        noise whose amplitude follows a pattern per intent, with ramps, crosstalk, gain and \
        rotation per person, and labels that the muscle follows late. They show that the code \
        works, nothing about accuracy on people.\n\nExample:\n  myointent data synth --out synthetic --subjects 12 --seed 7"
)]
pub struct SynthArguments {
    /// Folder to write to
    #[arg(long)]
    out: PathBuf,
    /// Number of people
    #[arg(long, default_value_t = SynthOptions::default().subjects)]
    subjects: usize,
    /// Number of recordings of each person
    #[arg(long, default_value_t = SynthOptions::default().recordings)]
    recordings: usize,
    /// Seconds of each recording
    #[arg(long, default_value_t = SynthOptions::default().seconds)]
    seconds: usize,
    /// Classes: 3 (relax, open, close) or 6
    #[arg(long, default_value = "3", value_parser = vocabulary)]
    classes: Vocabulary,
    /// Label lag: how late the muscle follows a label, in ms
    #[arg(
        long,
        default_value_t = SynthOptions::default().label_lag_ms,
        value_parser = clap::value_parser!(u32).range(100..=500)
    )]
    label_lag: u32,
    /// Seed of every draw
    #[arg(long, default_value_t = SynthOptions::default().seed)]
    seed: u64,
}

fn vocabulary(text: &str) -> Result<Vocabulary, String> {
    let classes = text.parse().ok().and_then(Vocabulary::with_classes);
    classes.ok_or_else(|| "expected 3 or 6".to_owned())
}

/// Runs `myointent data`.
///
/// # Errors
/// If recordings cannot be read or written.
pub(super) fn run(command: Command) -> anyhow::Result<()> {
    match command {
        Command::Inspect(args) => inspect(&args),
        Command::Synth(args) => write_synthetic(&args),
    }
}

fn inspect(args: &InspectArguments) -> anyhow::Result<()> {
    let options = LoadOptions {
        strict: args.strict,
        ..LoadOptions::default()
    };
    let library = load(&args.path, &options).map_err(refused)?;
    let inspection = Inspection::new(&library);
    let report = if args.json {
        serde_json::to_string_pretty(&inspection)? + "\n"
    } else {
        tables(&inspection)
    };
    std::io::stdout().write_all(report.as_bytes())?;
    Ok(())
}

fn tables(inspection: &Inspection) -> String {
    let mut text = sets(&inspection.sets).plain();
    for suspicion in &inspection.suspicions {
        text += &format!("\n{} ({})\n", suspicion.what, suspicion.which.len());
        for which in suspicion.which.iter().take(SHOWN) {
            text += &format!("    {which}\n");
        }
        if suspicion.which.len() > SHOWN {
            text += "    ...\n";
        }
    }
    if inspection.ignored > 0 {
        text += &format!("\n{} other files, not read\n", inspection.ignored);
    }
    text
}

fn sets(sets: &[SetInspection]) -> Table {
    let columns = [
        &["data set", "subjects", "recordings", "seconds"][..],
        &Intent::ALL.map(Intent::name),
        &["unlabelled", "transitions", "saturated %", "lag ms"],
    ];
    let caption = "Seconds by label; the largest share of a channel that saturates in a \
        recording; label lag (median).";
    let mut table = Table::new(caption, columns.concat());
    for set in sets {
        let mut row = vec![
            set.data_set.name().to_owned(),
            set.subjects.to_string(),
            set.recordings.to_string(),
            format!("{:.0}", set.seconds),
        ];
        row.extend(Intent::ALL.map(|intent| {
            let seconds = set.seconds_by_intent.get(intent.name());
            seconds.map_or_else(String::new, |seconds| format!("{seconds:.0}"))
        }));
        let lag = set
            .label_lag
            .map(|lag| lag.lag_samples * SAMPLE_PERIOD_MS as usize);
        row.extend([
            format!("{:.0}", set.seconds_unlabelled),
            set.transitions.to_string(),
            format!("{:.1}", 100.0 * set.worst_saturation),
            lag.map_or_else(String::new, |lag| lag.to_string()),
        ]);
        table.push(row);
    }
    table
}

fn write_synthetic(args: &SynthArguments) -> anyhow::Result<()> {
    let options = SynthOptions {
        subjects: args.subjects,
        recordings: args.recordings,
        seconds: args.seconds,
        vocabulary: args.classes,
        label_lag_ms: args.label_lag,
        seed: args.seed,
    };
    let paths = synthetic::write(&options, &args.out).context("cannot write the recordings")?;
    writeln!(
        std::io::stdout(),
        "{} recordings of {} s in {}",
        paths.len(),
        args.seconds,
        args.out.display()
    )?;
    Ok(())
}
