//! `myointent info`: the header of a model file.

use std::io::Write as _;
use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use shared::model::file::Model;

/// Arguments of `info`.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Model file.
    #[arg(value_name = "FILE.intent")]
    model: PathBuf,
    /// Print JSON.
    #[arg(long)]
    json: bool,
}

/// Prints a model file's header.
///
/// # Errors
/// When the file is missing or refused, for the reason that the device reports too.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let path = &arguments.model;
    let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
    let model = Model::parse(&bytes).with_context(|| format!("{} is refused", path.display()))?;
    let header = &model.header;
    let (dimensions, smoother, provenance) =
        (&header.dimensions, &header.smoother, &header.provenance);
    let intents: Vec<&str> = dimensions
        .vocabulary
        .intents()
        .iter()
        .map(|intent| intent.name())
        .collect();
    let sets: Vec<&str> = provenance.data_sets.iter().collect();
    let held_out: Vec<&str> = provenance.subjects_left_out.iter().collect();
    let metrics: Vec<(&str, f32)> = provenance.metrics.iter().collect();
    let mut out = std::io::stdout().lock();
    if arguments.json {
        let value = serde_json::json!({
            "bytes": model.length,
            "intents": intents,
            "width": dimensions.width,
            "layers": dimensions.layers,
            "span": dimensions.span,
            "companding": format!("{:?}", header.companding),
            "aggregation": format!("{:?}", smoother.aggregation),
            "look_ahead": smoother.look_ahead,
            "hold": smoother.hold,
            "data_sets": sets,
            "subjects_left_out": held_out,
            "git_revision": provenance.git_revision,
            "seed": provenance.seed,
            "metrics": metrics.iter().copied().collect::<std::collections::BTreeMap<_, _>>(),
        });
        writeln!(out, "{}", serde_json::to_string_pretty(&value)?)?;
        return Ok(());
    }
    writeln!(
        out,
        "{}: {} bytes, checksum correct",
        path.display(),
        model.length
    )?;
    writeln!(out, "intents       {}", intents.join(", "))?;
    writeln!(
        out,
        "encoder       width {}, {} layers, span {} patches, input {:?}",
        dimensions.width, dimensions.layers, dimensions.span, header.companding
    )?;
    writeln!(
        out,
        "smoother      {:?}, look-ahead {} samples, hold {} samples",
        smoother.aggregation, smoother.look_ahead, smoother.hold
    )?;
    writeln!(
        out,
        "trained on    {} (seed {}, revision {})",
        sets.join(", "),
        provenance.seed,
        provenance.git_revision
    )?;
    writeln!(out, "held out      {}", held_out.join(", "))?;
    for (name, value) in metrics {
        writeln!(out, "measured      {name} {value:.3}")?;
    }
    Ok(())
}
