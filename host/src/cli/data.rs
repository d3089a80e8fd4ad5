//! `myointent data`: contents of a folder of recordings, a first description of one, and synthetic recordings. Published ones are fetched by `fetch`.

use std::io::Write;
use std::path::PathBuf;

use anyhow::Context;
use clap::{Args, Subcommand};
use shared::intent::Vocabulary;

use super::arguments::refused;
use super::contents::{Recordings, tables};
#[cfg(feature = "fetch")]
use super::fetch;
use execution::printable::printable_lines;
use recordings::description::draft::describe;
use recordings::synthetic::{self, SynthOptions};
use recordings::{DataSet, LoadOptions, load};

/// Subcommands of `myointent data`.
#[derive(Subcommand, Debug)]
pub enum DataCommand {
    /// Show subjects, seconds per intent, transitions, and what is wrong with recordings
    Inspect(InspectArguments),
    /// Write a draft of a recordings.toml, which says how to read a folder of your own files
    Describe(DescribeArguments),
    /// Write synthetic recordings, to try things without a data set
    Synth(SynthArguments),
    /// Download a published data set, or put a downloaded archive in place
    #[cfg(feature = "fetch")]
    Fetch(fetch::Arguments),
}

#[derive(Args, Debug)]
#[command(
    // Not in `long_about`, which the one line of the subcommand hides.
    after_help = inspect_help(),
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

fn inspect_help() -> String {
    let readers: String = DataSet::all()
        .map(|set| format!("  {:16} {}\n", set.name(), set.recognised_by()))
        .collect();
    format!(
        "Reads every recording at or below PATH and shows what is in it: a folder of many data sets, one set, or one \
         file.\n\nFormats are recognised by content and name of the files:\n{readers}\n\
         Names of folders identify the person: keep the published layout below PATH. In your own recordings the folder \
         is the person, whatever the files are called. A file of eight columns without a header is read, without labels, \
         if PATH is that file. A recordings.toml (`myointent data describe`) says how to read files of any other layout; \
         PATH may be such a file. Nothing is read but regular files \
         of at most 128 MiB.\n\nExamples:\n  \
         myointent data inspect recordings\n  \
         myointent data inspect recordings/s1/s1_grasp.csv --json"
    )
}

/// Fields of a description, and how one is made.
const DESCRIBE_HELP: &str = "\
Writes DIR/recordings.toml, a draft by csv, txt, tsv and npy files: separator, columns, scale, words of labels, with comments
for the rest. Correct it, and every command reads the folder by it. An existing file is never replaced.

Fields (files and rate are required):
  files        paths below the folder; {person}, {session}, {gesture}, {trial} (a number) and {any} stand for text.
               Without {person} the folder is the person. Files that are named otherwise are not read
  folder       the folder, if the description is not in it
  separator    \",\", \";\", \"\\t\" or \" \"
  header       whether the first row is names
  channels     the eight columns in the armband's order, by name or by number (1 first); without it they are found by
               their names, in an array of eight columns by their order
  time         column of times or sample numbers: shows rate and gaps
  label        column of labels; or
  label_files  paths of files with one label a sample, with fields of `files`; or {gesture} in `files`
  labels       { relax = [...], open = [...], close, wave-in (flexion), wave-out (extension), pinch, other (movement that
               is none of these) or a kind of it (point, pronation, thumb-up, ...), unknown }: words and numbers of each;
               \"*\" stands for all that are in no list, which are errors without it
  rate         200; others are refused
  scale        counts for a value of 1: 128 where a file has counts / 128
  rectified    false; true is refused
  arm          \"left\" mirrors the channels
  rotation     0 to 7: channel c of the common frame is channel c + rotation here, on the left arm 6 + rotation - c
  timing       \"cues\": the muscle follows the labels late, or a file is one hold; \"muscle\": labels lie on its activity;
               \"from-activity\": one gesture a file, found in its activity
  cue_lag_ms   lag of the muscle after the cues; estimated without it

Examples:
  myointent data describe mine
  myointent data inspect mine
  myointent data describe /read-only/set --out set.toml     every command takes set.toml in place of the folder";

#[derive(Args, Debug)]
#[command(
    // Not in `long_about`, which the one line of the subcommand hides.
    after_help = DESCRIBE_HELP,
)]
pub struct DescribeArguments {
    /// Folder of recordings
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// File to write in place of DIR/recordings.toml
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

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
    classes.ok_or_else(|| "expected 3, 5 or 6".to_owned())
}

pub(super) fn run(command: DataCommand) -> anyhow::Result<()> {
    match command {
        DataCommand::Inspect(args) => inspect(&args),
        DataCommand::Describe(args) => write_description(&args),
        DataCommand::Synth(args) => write_synthetic(&args),
        #[cfg(feature = "fetch")]
        DataCommand::Fetch(args) => fetch::run(&args),
    }
}

fn inspect(args: &InspectArguments) -> anyhow::Result<()> {
    let options = LoadOptions {
        strict: args.strict,
        ..LoadOptions::default()
    };
    let library = load(&args.path, &options).map_err(refused)?;
    let recordings = Recordings::new(&library);
    let report = if args.json {
        serde_json::to_string_pretty(&recordings)? + "\n"
    } else {
        tables(&recordings)
    };
    std::io::stdout().write_all(report.as_bytes())?;
    Ok(library.not_empty(&args.path)?)
}

fn write_description(args: &DescribeArguments) -> anyhow::Result<()> {
    let (path, text) = describe(&args.folder, args.out.as_deref())?;
    let read = args.out.as_ref().unwrap_or(&args.folder);
    writeln!(
        std::io::stdout(),
        "{}\n\nwritten: {}\nnext:    correct it, then myointent data inspect {}",
        printable_lines(&text),
        path.display(),
        read.display()
    )?;
    Ok(())
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
