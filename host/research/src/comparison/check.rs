//! What must hold before folds may be put together.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::Value;

use super::{Run, StudyError};
use myointent::dataset::split::Role;
use myointent::run::config::ResolvedConfig;

/// Who is left out is what folds are there to differ in.
const MAY_DIFFER: [&str; 2] = ["data.held_out", "data.validation"];

/// Refuses folds that were run differently, count somebody twice or have seen whom they judge.
pub(super) fn check(runs: &[Run]) -> Result<(), StudyError> {
    let mut folds: BTreeMap<usize, &Run> = BTreeMap::new();
    let mut left_out: BTreeMap<&str, &Run> = BTreeMap::new();
    for run in runs {
        alone(run)?;
        alike(&runs[0], run)?;
        let number = run.fold().number;
        if let Some(first) = folds.insert(number, run) {
            return Err(StudyError::FoldTwice {
                number,
                first: first.path.clone(),
                second: run.path.clone(),
            });
        }
        for subject in &run.config.split.held_out {
            if let Some(first) = left_out.insert(subject, run) {
                return Err(StudyError::LeftOutTwice {
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
fn alone(run: &Run) -> Result<(), StudyError> {
    let fold = run.fold();
    if !(1..=fold.of).contains(&fold.number) {
        return Err(StudyError::NoSuchFold {
            run: run.path.clone(),
            number: fold.number,
            of: fold.of,
        });
    }
    let split = &run.config.split;
    let planned: BTreeSet<&str> = split.held_out.iter().map(String::as_str).collect();
    let seen = |subject: &str| {
        let others = [&split.training, &split.validation];
        others
            .iter()
            .any(|subjects| subjects.iter().any(|s| s == subject))
    };
    if let Some(subject) = planned.iter().find(|subject| seen(subject)) {
        return Err(StudyError::TwoRoles {
            run: run.path.clone(),
            subject: (*subject).to_owned(),
        });
    }
    let results = &run.results;
    let told: BTreeSet<&str> = results.held_out.iter().map(String::as_str).collect();
    let judged = results
        .published
        .iter()
        .chain(&results.spliced)
        .flat_map(|score| score.reference.iter().chain([&score.emitted]))
        .flat_map(|summary| &summary.subjects)
        .map(|score| score.subject.as_str())
        .filter(|&subject| split.role(subject) != Some(Role::HeldOut));
    if let Some(subject) = planned
        .symmetric_difference(&told)
        .copied()
        .chain(judged)
        .next()
    {
        return Err(StudyError::Stale {
            run: run.path.clone(),
            subject: subject.to_owned(),
        });
    }
    Ok(())
}

/// Refuses two folds whose settings differ, and says in what.
fn alike(first: &Run, second: &Run) -> Result<(), StudyError> {
    let (one, other) = (settings(&first.config), settings(&second.config));
    let names: BTreeSet<&String> = one.keys().chain(other.keys()).collect();
    let said = |value: Option<&Value>| value.map_or_else(|| "none".to_owned(), Value::to_string);
    let keys: Vec<String> = names
        .into_iter()
        .filter(|name| one.get(*name) != other.get(*name))
        .map(|name| {
            format!(
                "{name}: {} / {}",
                said(one.get(name)),
                said(other.get(name))
            )
        })
        .collect();
    if keys.is_empty() {
        return Ok(());
    }
    Err(StudyError::RunsDiffer {
        first: first.path.clone(),
        second: second.path.clone(),
        keys,
    })
}

/// Everything that folds must share, by dotted key.
///
/// Paths are not in it: folds may run on several machines. Lags are not either: each fold estimates
/// them on its own training subjects.
fn settings(config: &ResolvedConfig) -> BTreeMap<String, Value> {
    let mut settings = BTreeMap::new();
    // A preset is plain numbers and names, which JSON can always hold.
    let preset = serde_json::to_value(&config.preset).unwrap_or_default();
    flatten("", preset, &mut settings);
    settings.retain(|key, _| !MAY_DIFFER.contains(&key.as_str()));
    let folds = config.fold.map_or(1, |fold| fold.of);
    settings.insert("folds".to_owned(), folds.into());
    settings.insert("variant".to_owned(), config.variant.clone().into());
    settings.insert("strict".to_owned(), config.strict.into());
    // Where it lies may differ as well, not what it is.
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
