//! `myointent score`: any predicted label sequence against the true one, or those of many recordings.

mod folder;

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use shared::intent::Intent;

use crate::cli::arguments::AS_RECORDED;
use evaluation::label_score::{Emission, LabelScore};
use evaluation::metric::transition::Rule;
use recordings::labels::lag::LabelLag;
use recordings::labels::motion::{GroundTruth, Motion};
pub use recordings::readers::label_file::{self, Purpose};

#[derive(clap::Args, Debug)]
#[command(
    // Not in `long_about`, which the one line of the subcommand hides.
    after_help = "A folder of label files, as `predict` writes them for a folder of recordings, is scored as `evaluate` scores a model: \
        a table over people with the floors. --truth is then the recordings, and the labels of each are in \
        data-set/person/name.csv (or .npy, .txt), by the names that `data inspect --json` prints.\n\n\
        Otherwise: scores one recording's predicted labels against the true ones: balanced and raw accuracy, \
        transition accuracy with the reason of every failure, signed offsets, and events: gestures recognised with \
        their latency and release latency, one decision a gesture, rest kept, false activations, flicker. docs/metrics.md has the definitions.\n\n\
        Files: npy (one axis of class numbers or names, or ReactEMG's n x 9), or text with one \
        label per line, or csv with a header. Of a csv, --truth reads the column gt, truth or label, and --prediction \
        reads prediction, predicted or label, the first of them that there is. Labels \
        are class numbers (0 relax, 1 open, 2 close, 3 wave-in, 4 wave-out, 5 pinch) or names; \
        -1, unknown or none: no label; -2, other or its name (point): other movement, as a prediction no label. Both files have one label per sample at 200 Hz.\n\n\
        A transition of the truth is followed if the prediction changes the same way within the \
        buffer around it, without a third label there, and then holds the new label until the \
        next buffer. Where transitions are near each other, buffers do not overlap: a buffer starts where the one before it \
        ends at the earliest, and ends one sample before the last sample of its label, if the next transition comes so early. Then \
        there is nothing to hold. A true label of a single sample has no buffer and is refused. Unlabelled samples \
        divide the truth into parts that are scored separately; samples after the last prediction are not scored.\n\n\
        Events, and the scores at emission, take labels at the times when they are emitted: the column emitted of a csv of \
        `predict`, or the prediction moved by --delay.\n\nExamples:\n  \
        myointent score --truth s1_grasp.csv --prediction labels.csv\n  \
        myointent score --truth s1_grasp.csv --prediction other.csv --delay 51\n  \
        myointent score --truth truth.npy --prediction labels.npy --buffer 120 --json\n  \
        myointent score --truth RECORDINGS --prediction LABELS"
)]
pub struct Arguments {
    /// True labels; recordings or folders of them, if --prediction is a folder
    #[arg(long, value_name = "PATH", num_args = 1.., required = true)]
    truth: Vec<PathBuf>,
    /// Predicted labels, a file or a folder of files
    #[arg(long)]
    prediction: PathBuf,
    /// Width of the buffer around a transition, both sides together, in samples (paper: 200)
    #[arg(long, default_value_t = Rule::default().buffer)]
    buffer: usize,
    /// After the new label, allow no other
    #[arg(long)]
    strict: bool,
    /// Allow relax in the buffer and while the new label is held
    #[arg(long)]
    allow_relax: bool,
    /// Samples from the place of a predicted label to its emission, if the file does not say [default: 0]
    #[arg(long, value_name = "SAMPLES")]
    delay: Option<usize>,
    /// For a folder: how true labels, which are cues, are moved to where the muscle acts, as in `evaluate`
    #[arg(
        hide_short_help = true,
        long,
        value_name = "HOW",
        default_value = "each-cue"
    )]
    label_lag: LabelLag,
    #[arg(hide_short_help = true, long, help = AS_RECORDED)]
    as_recorded: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: Arguments) -> anyhow::Result<()> {
    let report = report(&args)?;
    std::io::stdout().write_all(report.as_bytes())?;
    Ok(())
}

fn report(args: &Arguments) -> anyhow::Result<String> {
    if args.prediction.is_dir() {
        return folder::report(args);
    }
    let score = score(args)?;
    Ok(if args.json {
        serde_json::to_string_pretty(&score.json())? + "\n"
    } else {
        score.tables()
    })
}

fn score(args: &Arguments) -> anyhow::Result<LabelScore> {
    let [path] = &args.truth[..] else {
        bail!(
            "--prediction is a file: expected one file with the true labels, or a folder of predictions"
        );
    };
    let truth: GroundTruth = label_file::read(path, Purpose::Truth)?
        .into_iter()
        .collect();
    let prediction = labels(label_file::read(&args.prediction, Purpose::Prediction)?);
    let emission = emission(&args.prediction, args.delay)?;
    let rule = args.rule();
    LabelScore::new(&truth, &prediction, emission, rule).with_context(|| {
        let prediction = args.prediction.display();
        format!("cannot score {prediction} against {}", path.display())
    })
}

impl Arguments {
    const fn rule(&self) -> Rule {
        Rule {
            buffer: self.buffer,
            strict: self.strict,
            allow_relax: self.allow_relax,
        }
    }
}

/// Labels of predicted motions. Predicted other movement is not a label.
fn labels(motions: Vec<Motion>) -> Vec<Option<Intent>> {
    motions.into_iter().map(Motion::label).collect()
}

/// Emission of the labels of a file: its own column, unless a delay is given.
fn emission(path: &Path, delay: Option<usize>) -> anyhow::Result<Emission> {
    let emitted = match delay {
        Some(_) => None,
        None => label_file::read_if_named(path, Purpose::Emission)?,
    };
    let after = Emission::After(delay.unwrap_or(0));
    Ok(emitted.map_or(after, |emitted| Emission::Labels(labels(emitted))))
}

#[cfg(test)]
mod tests;
