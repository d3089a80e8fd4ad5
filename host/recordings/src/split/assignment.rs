//! Assignment of people to roles: by lists, else by `host/recordings/people.toml`, else by a draw.

use std::collections::{BTreeMap, BTreeSet};

use rand::seq::SliceRandom;

use super::predefined::{PredefinedSplit, is_listed, is_test};
use super::{Split, folds};
use crate::catalogue::DataSet;
use crate::recording::Recording;
use crate::seed;

/// Settings of an assignment of roles.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Assignment<'a> {
    /// Seed of every draw. A data set's draw does not depend on the others.
    pub seed: u64,
    /// Subjects and whole data sets to hold out.
    pub held_out: &'a [String],
    /// Share of a set's subjects to hold out where neither list nor `host/recordings/people.toml` names any.
    pub held_out_share: f64,
    /// Subjects and whole data sets to validate with.
    pub validation: &'a [String],
    /// Share of a set's subjects to validate with where neither list nor `host/recordings/people.toml` names any.
    pub validation_share: f64,
    /// Whether `host/recordings/people.toml` assigns development people too: not in a cross-validation, whose folds are
    /// listed.
    pub predefined: bool,
}

/// Assigns the subjects of the recordings to their roles.
///
/// Each data set holds out and validates with its listed subjects. A set without a listed subject takes those of
/// `host/recordings/people.toml` ([`PredefinedSplit`]). A set that this does not name draws its share, at least one
/// subject, from three subjects on. Test people have no other role, unless they are listed as held out.
pub fn assign<'r>(
    recordings: impl IntoIterator<Item = &'r Recording>,
    assignment: &Assignment<'_>,
) -> Result<Split, SplitError> {
    let subjects = folds::subjects(recordings);
    let developer = |subject: &str| !is_test(subject);
    let listed_out = expand("data.held_out", assignment.held_out, &subjects, developer)?;
    let listed_in = expand(
        "data.validation",
        assignment.validation,
        &subjects,
        developer,
    )?;
    if let Some(&both) = listed_out.intersection(&listed_in).next() {
        return Err(SplitError::TwoRoles(both.to_owned()));
    }
    if let Some(&test) = listed_in.iter().find(|subject| is_test(subject)) {
        return Err(SplitError::TestPerson(test.to_owned()));
    }
    let mut split = Split::default();
    for (&data_set, known) in &subjects {
        let predefined = PredefinedSplit::of(data_set).filter(|_| assignment.predefined);
        let mut rest: Vec<&str> = known.clone();
        let test = take(&mut rest, |subject| {
            is_test(subject) && !listed_out.contains(subject)
        });
        let draw = |share, rest: &[&str]| {
            let count = drawn(share, known.len(), rest.len());
            let mut order: Vec<String> = rest.iter().map(|&subject| subject.to_owned()).collect();
            order.shuffle(&mut seed::generator(assignment.seed, data_set.name()));
            order.truncate(count);
            order
        };
        // People listed for validation are not drawn to be held out.
        let reserved = take(&mut rest, |subject| listed_in.contains(subject));
        let held_out = choose(
            &mut rest,
            &listed_out,
            predefined.map(|predefined| &predefined.settings[..]),
            |rest| draw(assignment.held_out_share, rest),
        );
        rest.extend(reserved);
        let validation = choose(
            &mut rest,
            &listed_in,
            predefined.map(|predefined| &predefined.checkpoint[..]),
            |rest| draw(assignment.validation_share, rest),
        );
        for (role, people) in [
            (&mut split.test, test),
            (&mut split.held_out, held_out),
            (&mut split.validation, validation),
            (&mut split.training, rest),
        ] {
            role.extend(people.into_iter().map(str::to_owned));
        }
    }
    if split.training.is_empty() {
        return Err(SplitError::NothingToTrainOn);
    }
    for role in [
        &mut split.test,
        &mut split.held_out,
        &mut split.validation,
        &mut split.training,
    ] {
        role.sort_unstable();
    }
    Ok(split)
}

/// Takes the subjects of one role out of `rest`: those listed, else those of `host/recordings/people.toml`, else those
/// drawn.
fn choose<'s>(
    rest: &mut Vec<&'s str>,
    listed: &BTreeSet<&str>,
    predefined: Option<&[String]>,
    draw: impl FnOnce(&[&str]) -> Vec<String>,
) -> Vec<&'s str> {
    let named = take(rest, |subject| listed.contains(subject));
    match predefined {
        _ if !named.is_empty() => named,
        Some(list) => take(rest, |subject| is_listed(list, subject)),
        None => {
            let drawn = draw(rest);
            take(rest, |subject| drawn.iter().any(|name| name == subject))
        }
    }
}

/// Number of subjects to draw: the share of all known, at least one, at most all but one of the rest.
fn drawn(share: f64, known: usize, rest: usize) -> usize {
    if share <= 0.0 || known <= 2 {
        return 0;
    }
    let wanted = ((share * known as f64).round() as usize).max(1);
    wanted.min(rest.saturating_sub(1))
}

/// Takes the subjects out of `rest` that `wanted` accepts.
fn take<'s>(rest: &mut Vec<&'s str>, wanted: impl Fn(&str) -> bool) -> Vec<&'s str> {
    rest.extract_if(.., |subject| wanted(subject)).collect()
}

/// The subjects that a list names: by themselves, or those of a data set that `of_set` accepts. `list` is its name in
/// errors.
pub fn expand<'s>(
    list: &'static str,
    names: &[String],
    subjects: &BTreeMap<DataSet, Vec<&'s str>>,
    of_set: impl Fn(&str) -> bool,
) -> Result<BTreeSet<&'s str>, SplitError> {
    let mut found = BTreeSet::new();
    for name in names {
        let whole_set = subjects.iter().find(|(set, _)| set.name() == name);
        if let Some((_, people)) = whole_set {
            found.extend(people.iter().filter(|subject| of_set(subject)));
            continue;
        }
        let subject = subjects.values().flatten().find(|subject| *subject == name);
        found.insert(*subject.ok_or_else(|| unknown(list, name, subjects))?);
    }
    Ok(found)
}

fn unknown(list: &'static str, name: &str, subjects: &BTreeMap<DataSet, Vec<&str>>) -> SplitError {
    const SHOWN: usize = 3;
    let sets = subjects.keys().map(|set| set.name());
    let mut known: Vec<&str> = subjects.values().flatten().copied().chain(sets).collect();
    known.sort_by_cached_key(|known| strsim::damerau_levenshtein(known, name));
    known.truncate(SHOWN);
    SplitError::Unknown {
        list,
        name: name.to_owned(),
        nearest: known.join(", "),
    }
}

/// Error of an assignment of people to roles.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum SplitError {
    #[error(
        "{list} names {name:?}, which is no subject and no data set of these recordings; nearest: {nearest}"
    )]
    Unknown {
        list: &'static str,
        name: String,
        nearest: String,
    },
    #[error("{0} is listed in data.held_out and in data.validation: take it from one list")]
    TwoRoles(String),
    #[error(
        "{0} is a test person (host/recordings/people.toml) and cannot validate: name another in data.validation"
    )]
    TestPerson(String),
    #[error("no training subject is left: hold out or validate on fewer, or add recordings")]
    NothingToTrainOn,
}

#[cfg(test)]
mod tests;
