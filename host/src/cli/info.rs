//! `myointent info`: the header of a model file.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use shared::model::file::{List, Model};
use shared::stream::smoother::{AggregationMode, Margins, Reaction};

use crate::cli::read_model;
pub use recordings::printable;

#[derive(Debug, Args)]
pub struct Arguments {
    /// Model file.
    #[arg(value_name = "FILE.intent")]
    model: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let path = &arguments.model;
    let bytes = read_model(path)?;
    let model = Model::parse(&bytes).with_context(|| format!("{} is refused", path.display()))?;
    let text = if arguments.json {
        serde_json::to_string_pretty(&json(&model))? + "\n"
    } else {
        format!(
            "{}: {} bytes, checksum correct\n{}",
            path.display(),
            model.length,
            lines(&model)
        )
    };
    std::io::stdout().write_all(text.as_bytes())?;
    Ok(())
}

fn intents(model: &Model<'_>) -> Vec<&'static str> {
    let vocabulary = model.header.dimensions.vocabulary;
    vocabulary.intents().iter().map(|i| i.name()).collect()
}

fn json(model: &Model<'_>) -> serde_json::Value {
    let header = &model.header;
    let (dimensions, smoother, provenance) =
        (&header.dimensions, &header.smoother, &header.provenance);
    let margins = smoother.margins;
    serde_json::json!({
        "bytes": model.length,
        "intents": intents(model),
        "width": dimensions.width,
        "layers": dimensions.layers,
        "span": dimensions.span,
        "companding": format!("{:?}", header.companding),
        "aggregation": format!("{:?}", smoother.aggregation),
        "look_ahead": smoother.look_ahead,
        "hold": smoother.hold,
        "entry_margin": margins.entry,
        "other_margin": margins.other,
        "reaction": reaction(margins),
        "early": margins.early.map(|early| serde_json::json!({
            "entry": early.entry,
            "other": early.other,
            "caution": early.caution,
        })),
        "data_sets": provenance.data_sets.iter().collect::<Vec<_>>(),
        "subjects_seen": provenance.subjects_seen.iter().collect::<Vec<_>>(),
        "subjects_left_out": provenance.subjects_left_out.iter().collect::<Vec<_>>(),
        "git_revision": provenance.git_revision,
        "seed": provenance.seed,
        "metrics": provenance.metrics.iter().collect::<BTreeMap<_, _>>(),
    })
}

/// The name of the operating point: `waits` if every label waits for the look-ahead, `own` with margins of no name.
fn reaction(margins: Margins) -> &'static str {
    if margins.early.is_none() {
        return "waits";
    }
    let has_margins = |reaction: &Reaction| {
        let named = reaction.margins();
        (named.entry, named.early) == (margins.entry, margins.early)
    };
    let named = Reaction::ALL.into_iter().find(has_margins);
    named.map_or("own", Reaction::name)
}

/// Formats the header, a line for each part. Texts from the file may be hostile: only printable characters are kept.
fn lines(model: &Model<'_>) -> String {
    let header = &model.header;
    let (dimensions, smoother, provenance) =
        (&header.dimensions, &header.smoother, &header.provenance);
    let list = |texts: List<'_, &str>| texts.iter().map(printable).collect::<Vec<_>>().join(", ");
    let other = match smoother.margins.other {
        Some(margin) => format!("known, margin {margin}"),
        None => "not known: it may be taken for an intent".to_owned(),
    };
    let mut lines = format!(
        "intents       {}\n\
         encoder       width {}, {} layers, span {} patches, input {:?}\n\
         smoother      {}, look-ahead {} samples, hold {} samples, reaction {}, entry margin {}\n\
         other moves   {other}\n\
         trained on    {} (seed {}, revision {})\n\
         seen          {} people in training or validation (--json names them)\n\
         held out      {}\n",
        intents(model).join(", "),
        dimensions.width,
        dimensions.layers,
        dimensions.span,
        header.companding,
        match smoother.aggregation {
            AggregationMode::AllRowsFrom => "sums the logits of all patches from an instant on",
            AggregationMode::SameInstant => "sums the logits of an instant's own patch",
        },
        smoother.look_ahead,
        smoother.hold,
        reaction(smoother.margins),
        smoother.margins.entry,
        list(provenance.data_sets),
        provenance.seed,
        printable(provenance.git_revision),
        provenance.subjects_seen.iter().count(),
        list(provenance.subjects_left_out),
    );
    for (name, value) in provenance.metrics.iter() {
        lines += &format!("measured      {} {value:.3}\n", printable(name));
    }
    lines
}

#[cfg(test)]
mod tests {
    use shared::model::file::random::{SMALL, random_model};

    use super::*;

    /// Model file whose texts clear the screen and set its colour.
    fn hostile() -> Vec<u8> {
        let mut parts = random_model(SMALL, 1);
        let texts = &mut parts.provenance;
        texts.data_sets = vec!["\u{1b}[2Jroshambo".into()];
        texts.subjects_left_out = vec!["a\u{9b}31m\u{202e}".into()];
        texts.git_revision = "\r\n\u{7}".into();
        texts.metrics = vec![("\u{1b}]0;x\u{7}".into(), 0.5)];
        parts.to_bytes().unwrap()
    }

    #[test]
    fn texts_of_a_model_reach_no_terminal_raw_and_the_smoother_is_told_in_words() {
        let bytes = hostile();
        let lines = lines(&Model::parse(&bytes).unwrap());
        let raw = |c: char| (c.is_control() && c != '\n') || c == '\u{202e}';
        assert!(!lines.contains(raw), "{lines:?}");
        assert_eq!(lines.lines().count(), 8, "{lines}");
        assert!(lines.contains(r"\u{1b}[2Jroshambo"), "{lines}");
        let smoother = "smoother      sums the logits of ";
        assert!(lines.contains(smoother), "{lines}");
    }
}
