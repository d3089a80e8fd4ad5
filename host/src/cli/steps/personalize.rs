//! `myointent personalize`: a model file tuned on one person's recordings.

use std::io::Write as _;

use clap::Args;

use crate::cli::Kept;
use crate::cli::arguments::OwnModel;
use evaluation::report::scores::tuned;
use execution::interrupt::Interrupt;
use execution::progress;
use execution::run_folder::write_whole;
use training::backend::BackendArguments;
use training::run::personalize::{TuningSettings, personalize};

#[derive(Debug, Args)]
#[command(
    after_help = "A few minutes of rest and of each gesture in turn, with labels, are enough; docs/personalization.md says what they gain.\n\
    Other movement among the labels (-2 or other) teaches what is not meant. The last third of the recordings is held back, or, if that\n\
    is too short, each quarter in turn: both models are judged on it as `evaluate --model` does. The new file is written\n\
    only if its balanced accuracy there is 0.2 above that of always saying relax; if neither balanced accuracy nor transition\n\
    accuracy nor the share of gestures recognised is lower than before; and if rest and other movement do not raise more labels\n\
    (2 a minute of rest, a tenth of the other movements or of their activations). Otherwise nothing is written and the exit code is 3: go on with the\n\
    old file. So it is if two classes seem exchanged in the labels.\n\n\
    Example:\n  myointent personalize --model models/three-class.intent --data MINE --out mine.intent"
)]
pub struct Arguments {
    #[command(flatten)]
    own: OwnModel,
    /// Labels that other movement may raise a minute: the margin over it is raised until half of that held back has no more.
    ///
    /// The other half judges. It is every second movement of a kind, or the later half of one that is alone.
    #[arg(long, value_name = "LABELS", value_parser = per_minute)]
    other_per_minute: Option<f64>,
    /// Seed of all draws: the same one gives the same file.
    #[arg(long, default_value_t = TuningSettings::default().seed)]
    seed: u64,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Parses a rate: not negative.
fn per_minute(text: &str) -> Result<f64, String> {
    let rate = text
        .parse()
        .ok()
        .filter(|rate| (0.0..=1000.0).contains(rate));
    rate.ok_or_else(|| "expected a number from 0 to 1000".to_owned())
}

/// Tunes the model, judges it, and writes it unless it is worse.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let OwnModel {
        model,
        out,
        subject,
        ..
    } = &arguments.own;
    let (bytes, library) = arguments.own.read()?;
    let device = arguments.backend.device()?;
    let settings = TuningSettings {
        seed: arguments.seed,
        other_per_minute: arguments.other_per_minute,
        ..TuningSettings::default()
    };
    let done = personalize(
        &bytes,
        &library,
        subject.as_deref(),
        &settings,
        &device,
        &Interrupt::listen(),
        // The progress bar in the terminal shows the steps.
        |_, _| (),
    )?;
    if done.seen_before {
        progress::log(&format!(
            "warning: the model was trained on {} already: it scores too well before, so that tuning seems to gain less",
            done.subject
        ));
    }
    let caption = format!(
        "{} on the {:.0} s held back, tuned on {:.0} s",
        done.subject, done.judged_seconds, done.tuned_seconds
    );
    let mut stdout = std::io::stdout().lock();
    writeln!(stdout, "{}", tuned(&caption, &done.scores).plain())?;
    if let Some(why) = done.worse() {
        let kept = Kept(format!(
            "on the part held back {why}: nothing was written, go on with {}; more recordings may help",
            model.display()
        ));
        return Err(kept.into());
    }
    write_whole(out, &done.bytes)?;
    writeln!(stdout, "{} ({} bytes)", out.display(), done.bytes.len())?;
    Ok(())
}
