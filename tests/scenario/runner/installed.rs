//! Labels after an installation, held against a pipeline on the PC that changes its model at the same sample.

use anyhow::{Context as _, ensure};
use myointent_tests::oracle::{Input, expected_lines};
use myointent_tests::output::{BoardOutput, numbered};
use shared::stream::safe_state::Cause;
use shared::uart_line::{Report, ReportKind};
use shared::units::{PATCH, Sample, WINDOW};

use super::expectation::Models;

/// Smallest number of labels after the installation.
const LABELS: usize = 50;

/// Checks the labels after the last installation, if that is asked for.
pub fn check(
    wanted: bool,
    models: Models<'_>,
    samples: &[Sample],
    output: &BoardOutput,
) -> anyhow::Result<()> {
    if !wanted {
        return Ok(());
    }
    let reports = output.reports()?;
    let begun = position(&reports).context("no installation")?;
    let suspended = reports[begun].emitted.0 as usize + 1;
    let found = labels(&reports[begun..]);
    ensure!(found.len() >= LABELS, "{} labels", found.len());
    let (first, last) = (
        found[0].emitted.0 as usize,
        found[found.len() - 1].emitted.0 as usize,
    );
    // The encoder takes a patch of the window with each sample, and labels go on when it has nearly caught up. No line
    // says at which sample it began: one candidate has to fit.
    let earliest = first.saturating_sub(WINDOW / PATCH + PATCH) / 2 * 2;
    for resumed in (earliest..first).step_by(2) {
        let until = |end: usize| -> anyhow::Result<Vec<Report>> {
            let inputs = [
                Input::Samples(&samples[..suspended]),
                Input::Suspend,
                Input::Samples(&samples[suspended..resumed]),
                Input::Resume(models.other),
                Input::Samples(&samples[resumed..=end]),
            ];
            let lines = expected_lines(models.first, &inputs)?;
            let reports = lines.iter().map(|line| Ok(numbered(line)?.1));
            let reports = reports.filter_map(anyhow::Result::transpose);
            let reports = reports.collect::<anyhow::Result<Vec<_>>>()?;
            let begun = position(&reports).context("no installation")?;
            Ok(labels(&reports[begun..]))
        };
        if !same(&until(first)?, &found[..1]) {
            continue;
        }
        let expected = until(last)?;
        if same(&expected, &found) {
            return Ok(());
        }
    }
    anyhow::bail!("{} labels that are not those of the new model", found.len())
}

/// Returns the index of the report at which the last installation begins.
fn position(reports: &[Report]) -> Option<usize> {
    let begins = |report: &Report| report.status.cause() == Some(Cause::Installation);
    let last = reports.iter().rposition(begins)?;
    // The report is written repeatedly.
    let before = reports[..last].iter().rposition(|report| !begins(report));
    Some(before.map_or(0, |before| before + 1))
}

/// Returns the labels until the state is safe again.
fn labels(reports: &[Report]) -> Vec<Report> {
    let valid = reports
        .iter()
        .skip_while(|report| !report.status.valid())
        .take_while(|report| report.status.valid());
    valid
        .filter(|report| report.kind == ReportKind::Label)
        .copied()
        .collect()
}

/// Returns true if labels, their samples and losses agree; the numbers of lines differ.
fn same(one: &[Report], other: &[Report]) -> bool {
    let plain = |report: &Report| {
        (
            report.instant,
            report.emitted,
            report.status,
            report.counters,
        )
    };
    one.iter().map(plain).eq(other.iter().map(plain))
}
