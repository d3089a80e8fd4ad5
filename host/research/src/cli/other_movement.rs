//! `myointent-research other-movement`: measures what it buys to show a model what is not meant.

use std::io::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use evaluation::Difference;
use evaluation::report::Table;
use execution::interrupt::Interrupt;
use execution::progress;
use recordings::split::predefined::is_test;
use recordings::statistics::MeanSd;
use recordings::{LoadOptions, load};
use shared::model::file::Model;
use training::backend::BackendArguments;
use training::run::personalize::TuningSettings;

use crate::other_movement::{Measurement, SHOWN, Values, Variant};

/// Arguments of `other-movement`.
#[derive(Debug, Args)]
#[command(
    after_help = "Of each gesture and each other movement, the first half of its holds is tuned on and the second half judged, with up\n\
    to a second of rest around each; without the rule of `myointent personalize`. People whom the model has seen, and test people,\n\
    are left out. Differences are to the same person's model tuned on gestures alone.\n\n\
    Example:\n  \
    myointent-research other-movement models/three-class.intent --data DIR"
)]
pub(super) struct Arguments {
    /// Model file to tune.
    #[arg(value_name = "FILE.intent")]
    model: PathBuf,
    /// Folder of recordings with gestures and other movement of the same people.
    #[arg(long, value_name = "DIR")]
    data: PathBuf,
    /// Seconds of other movement to tune on, separated by commas.
    #[arg(
        long,
        value_name = "SECONDS",
        value_delimiter = ',',
        default_value = "15,30,60"
    )]
    amounts: Vec<f64>,
    /// Margins over other movement to judge with, separated by commas; besides the tuned file's own.
    #[arg(
        long,
        value_name = "MARGINS",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    margins: Vec<f32>,
    /// Steps of the tuning; by default those of `myointent personalize`.
    #[arg(long)]
    steps: Option<usize>,
    /// Share of the model's own outputs in the targets of gestures and rest, 0 to 1.
    #[arg(long, default_value_t = TuningSettings::default().keep)]
    keep: f64,
    #[command(flatten)]
    backend: BackendArguments,
}

/// Measures all people and prints the table.
///
/// # Errors
/// When the model or the recordings are refused, nobody can be measured or the user interrupts.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let device = arguments.backend.device()?;
    let bytes =
        std::fs::read(&arguments.model).with_context(|| arguments.model.display().to_string())?;
    let model = Model::parse(&bytes).with_context(|| arguments.model.display().to_string())?;
    let library = load(&arguments.data, &LoadOptions::default())?;
    let interrupt = Interrupt::listen();
    let usual = TuningSettings::default();
    let settings = TuningSettings {
        steps: arguments.steps.unwrap_or(usual.steps),
        steps_with_other: arguments.steps.unwrap_or(usual.steps_with_other),
        keep: arguments.keep,
        ..usual
    };
    let others = arguments.margins.iter().copied().map(Some);
    let margins: Vec<Option<f32>> = [None].into_iter().chain(others).collect();
    let measurement = Measurement {
        library: &library,
        model: &bytes,
        amounts: &arguments.amounts,
        margins: &margins,
        settings: &settings,
        device,
        interrupt: &interrupt,
    };
    let seen: Vec<&str> = model.header.provenance.subjects_seen.iter().collect();
    let mut people: Vec<(String, Vec<(Variant, Values)>)> = Vec::new();
    for subject in library.subjects() {
        if is_test(&subject) || seen.contains(&&subject[..]) {
            continue;
        }
        match measurement.person(&subject) {
            Ok(variants) => {
                progress::log(&format!("{subject}: measured"));
                people.push((subject, variants));
            }
            Err(error) if error.is_interrupt() => return Err(error.into()),
            Err(error) => progress::log(&format!("{subject}: left out, {error}")),
        }
    }
    anyhow::ensure!(
        !people.is_empty(),
        "nobody could be measured: expected people whom the model has not seen, with gestures and other movement"
    );
    let mut out = std::io::stdout().lock();
    writeln!(out, "{}", table(&people).plain())?;
    Ok(())
}

/// Table with a row for each variant: means over people, and differences to gestures alone.
fn table(people: &[(String, Vec<(Variant, Values)>)]) -> Table {
    let caption = "Mean over n people; less gestures alone [95 % interval]";
    let names = SHOWN.iter().map(|measure| measure.name().to_owned());
    let mut table = Table::new(
        caption,
        ["tuned on", "n"]
            .map(str::to_owned)
            .into_iter()
            .chain(names),
    );
    let alone = Variant::Tuned(0.0, None);
    let longest = people.iter().max_by_key(|(_, variants)| variants.len());
    let variants = longest.into_iter().flat_map(|(_, variants)| variants);
    for &(variant, _) in variants {
        let side = |wanted: Variant, measure: usize| -> Vec<(&str, f64)> {
            people
                .iter()
                .filter_map(|(who, variants)| {
                    let (_, values) = variants.iter().find(|(own, _)| *own == wanted)?;
                    Some((&who[..], values[measure]?))
                })
                .collect()
        };
        let count = people
            .iter()
            .filter(|(_, own)| own.iter().any(|(own, _)| *own == variant))
            .count();
        let cells = (0..SHOWN.len()).map(|measure| {
            let own = side(variant, measure);
            let values: Vec<f64> = own.iter().map(|(_, value)| *value).collect();
            let mean = MeanSd::of(&values)
                .map_or_else(|| "-".to_owned(), |own| format!("{:.3}", own.mean));
            let less = Difference::paired(&own, &side(alone, measure));
            let interval = less
                .filter(|_| variant != alone)
                .and_then(|less| less.interval);
            interval.map_or(mean.clone(), |interval| {
                format!("{mean} [{:+.3}, {:+.3}]", interval.low, interval.high)
            })
        });
        let at = |margin: Option<f32>| {
            margin.map_or_else(String::new, |margin| format!(", margin {margin}"))
        };
        let name = match variant {
            Variant::AsItIs => "nothing".to_owned(),
            Variant::Tuned(0.0, margin) => format!("gestures{}", at(margin)),
            Variant::Tuned(seconds, margin) => format!("{seconds} s of others too{}", at(margin)),
            Variant::Unshown(margin) => format!("all kinds but the one judged{}", at(margin)),
        };
        table.push([name, count.to_string()].into_iter().chain(cells));
    }
    table
}
