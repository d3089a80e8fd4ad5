//! `myointent evaluate --run`: a run's models on its held-out subjects.

use std::io::Write as _;

use anyhow::bail;
use evaluation::report::labels;
use evaluation::report::run_report;
use evaluation::report::scores::tables;
use recordings::split::predefined::is_test;
use training::run::evaluate::evaluate;
use training::run::quantize::ModelFile;

use super::open_run;
use crate::cli::arguments::warn_of_test_people;
use crate::cli::evaluate::Arguments;

/// Evaluates the run's models and writes results.json and report.html.
pub(in crate::cli) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let model = match &arguments.model[..] {
        [] => None,
        [path] => Some(path),
        _ => bail!("several models need --data DIR: a run folder is evaluated with one"),
    };
    let context = open_run(&arguments.run, arguments.backend)?;
    // A run may have a teacher alone.
    let model = match model {
        Some(path) => Some(ModelFile::read(&context, path)?),
        None => ModelFile::of_run(&context)?,
    };
    let held_out = context.config.split.held_out.iter();
    warn_of_test_people(held_out.filter(|subject| is_test(subject)).count());
    let (results, evaluation) = evaluate(&context, model.as_ref())?;
    let (folder, config) = (&context.folder, &context.config);
    let page = if evaluation.is_kept {
        Some(run_report::write(folder, config, &results, &evaluation)?)
    } else {
        None
    };
    let mut out = std::io::stdout().lock();
    if arguments.json {
        writeln!(out, "{}", serde_json::to_string_pretty(&results)?)?;
    } else {
        let width = &arguments.width;
        width.print(&tables(&results, width.wide), &mut out)?;
        for (what, how) in labels(&config.lags, &results.gestures) {
            writeln!(out, "{what}: {how}")?;
        }
        writeln!(out, "held out: {}", results.held_out.join(", "))?;
        match page {
            Some(page) => writeln!(out, "report:   {}", page.display())?,
            None => writeln!(out, "not kept: the model file is not that of this run")?,
        }
    }
    Ok(())
}
