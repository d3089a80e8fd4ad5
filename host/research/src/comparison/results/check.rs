//! What must hold before folds may be merged.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::Value;

use super::error::ResultsError;
use super::evaluated_run::EvaluatedRun;
use myointent::dataset::split::Role;
use myointent::evaluation::Score;
use myointent::run::config::ResolvedConfig;

/// Keys that differ between folds by design: who is held out.
const MAY_DIFFER: [&str; 2] = ["data.held_out", "data.validation"];

/// Checks the folds of a variant.
///
/// # Errors
/// When settings differ, a subject counts twice, or a model has seen a subject that it is evaluated on.
pub(super) fn check(runs: &[EvaluatedRun]) -> Result<(), ResultsError> {
    let mut folds: BTreeMap<usize, &EvaluatedRun> = BTreeMap::new();
    let mut held_out: BTreeMap<&str, &EvaluatedRun> = BTreeMap::new();
    for run in runs {
        check_run(run)?;
        check_settings(&runs[0], run)?;
        let number = run.fold().number;
        if let Some(first) = folds.insert(number, run) {
            return Err(ResultsError::DuplicateFold {
                number,
                first: first.path.clone(),
                second: run.path.clone(),
            });
        }
        for subject in &run.config.split.held_out {
            if let Some(first) = held_out.insert(subject, run) {
                return Err(ResultsError::HeldOutTwice {
                    subject: subject.clone(),
                    first: first.path.clone(),
                    second: run.path.clone(),
                });
            }
        }
    }
    Ok(())
}

/// What must hold within one fold.
fn check_run(run: &EvaluatedRun) -> Result<(), ResultsError> {
    let fold = run.fold();
    if !(1..=fold.of).contains(&fold.number) {
        return Err(ResultsError::NoSuchFold {
            run: run.path.clone(),
            number: fold.number,
            of: fold.of,
        });
    }
    let split = &run.config.split;
    let configured: BTreeSet<&str> = split.held_out.iter().map(String::as_str).collect();
    let seen = |subject: &str| {
        let others = [&split.training, &split.validation];
        others
            .iter()
            .any(|subjects| subjects.iter().any(|s| s == subject))
    };
    if let Some(subject) = configured.iter().find(|subject| seen(subject)) {
        return Err(ResultsError::TwoRoles {
            run: run.path.clone(),
            subject: (*subject).to_owned(),
        });
    }
    let results = &run.results;
    let listed: BTreeSet<&str> = results.held_out.iter().map(String::as_str).collect();
    let scored = results
        .published
        .iter()
        .chain(&results.spliced)
        .flat_map(subjects)
        .filter(|&subject| split.role(subject) != Some(Role::HeldOut));
    if let Some(subject) = configured
        .symmetric_difference(&listed)
        .copied()
        .chain(scored)
        .next()
    {
        return Err(ResultsError::Stale {
            run: run.path.clone(),
            subject: subject.to_owned(),
        });
    }
    Ok(())
}

/// Everybody with a number in a score.
fn subjects(score: &Score) -> impl Iterator<Item = &str> {
    let scored = score.reference.iter().flat_map(|summary| &summary.subjects);
    let events = score.events.subjects.iter();
    scored
        .map(|own| own.subject.as_str())
        .chain(events.map(|own| own.subject.as_str()))
}

/// Refuses two folds whose settings differ.
fn check_settings(first: &EvaluatedRun, second: &EvaluatedRun) -> Result<(), ResultsError> {
    let (one, other) = (settings(&first.config), settings(&second.config));
    let names: BTreeSet<&String> = one.keys().chain(other.keys()).collect();
    let shown = |value: Option<&Value>| value.map_or_else(|| "none".to_owned(), Value::to_string);
    let keys: Vec<String> = names
        .into_iter()
        .filter(|name| one.get(*name) != other.get(*name))
        .map(|name| {
            format!(
                "{name}: {} / {}",
                shown(one.get(name)),
                shown(other.get(name))
            )
        })
        .collect();
    if keys.is_empty() {
        return Ok(());
    }
    Err(ResultsError::RunsDiffer {
        first: first.path.clone(),
        second: second.path.clone(),
        keys,
    })
}

/// The settings that folds must share, by dotted key.
///
/// Without paths, since folds may run on several machines, and without label lags, which each fold
/// estimates on its own training subjects.
fn settings(config: &ResolvedConfig) -> BTreeMap<String, Value> {
    let mut settings = BTreeMap::new();
    // Cannot fail: a preset holds numbers and names only.
    let preset = serde_json::to_value(&config.preset).unwrap_or_default();
    flatten("", preset, &mut settings);
    settings.retain(|key, _| !MAY_DIFFER.contains(&key.as_str()));
    let folds = config.fold.map_or(1, |fold| fold.of);
    settings.insert("folds".to_owned(), folds.into());
    settings.insert("variant".to_owned(), config.variant.clone().into());
    settings.insert("strict".to_owned(), config.strict.into());
    // The folder may differ, its name may not.
    let start = config.start.as_deref().and_then(Path::file_name);
    let start = start.map(|name| name.to_string_lossy().into_owned());
    settings.insert("start".to_owned(), start.into());
    settings.insert("synthetic".to_owned(), config.data.is_none().into());
    settings
}

fn flatten(prefix: &str, value: Value, into: &mut BTreeMap<String, Value>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                let dot = if prefix.is_empty() { "" } else { "." };
                flatten(&format!("{prefix}{dot}{key}"), value, into);
            }
        }
        leaf => {
            into.insert(prefix.to_owned(), leaf);
        }
    }
}

#[cfg(test)]
mod tests;
