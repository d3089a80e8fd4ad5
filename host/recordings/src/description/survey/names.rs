//! Pattern of paths, guessed from the paths.
//!
//! Parts that are the same in all paths are text. Parts that differ are fields: the outermost folder is the person; in the file's
//! name, the words around a part (`R_0`, `subject08`), known gestures, sessions and numbers tell. Where names have
//! different numbers of parts (`wave_in_3`, `open_3`), those that are alike are taken off both ends, and what is left is
//! one field.

mod slot;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::description::pattern::{Field, Part, Pattern};
use crate::library::session::session;
use crate::readers::path::is_number;
use slot::{MARKS, Slot};

/// Share of the paths that decides about all: the others are named otherwise, and are reported.
const MOST: f64 = 0.9;

/// Pattern of most paths below a folder; `has_labels` where labels are not in the paths. None if the names of folders
/// have braces, or there is no path.
pub(super) fn pattern(paths: &[PathBuf], has_labels: bool) -> Option<Pattern> {
    let depth = most(paths, |path| path.iter().count())?;
    let of_depth = paths.iter().filter(|path| path.iter().count() == depth);
    let names = of_depth.filter_map(|path| path.iter().map(|name| name.to_str()).collect());
    let mut paths: Vec<Vec<&str>> = names.collect();
    let ending = format!(
        ".{}",
        Path::new(paths.first()?.last()?).extension()?.to_str()?
    );
    paths.retain_mut(|path| {
        let stem = path.pop().and_then(|name| name.strip_suffix(&ending));
        path.extend(stem);
        stem.is_some()
    });
    let count = |path: &Vec<&str>| path.last().map_or(0, |stem| pieces(stem).len());
    let usual = most(&paths, count)?;
    if paths.iter().filter(|path| count(path) == usual).count() as f64 >= MOST * paths.len() as f64
    {
        paths.retain(|path| count(path) == usual);
    }
    let stems: Vec<&str> = paths
        .iter()
        .filter_map(|path| path.last().copied())
        .collect();
    let of_file = |file: Vec<Slot<'_>>| {
        let mut slots: Vec<Slot<'_>> = Vec::new();
        for at in 0..depth - 1 {
            let names: Vec<&str> = paths.iter().map(|path| path[at]).collect();
            // `s6_r_5/s6_r_5-rock-2.csv`: the file's name says it in more detail.
            let repeats = |(stem, name): (&&str, &&str)| {
                stem.starts_with(name) && name.matches(MARKS).count() > 1
            };
            let is_repeated = stems.iter().zip(&names).all(repeats);
            slots.push(Slot::folder(names, is_repeated.then_some(Field::Any)));
        }
        slots.extend(file);
        assign(&mut slots, has_labels, paths.len());
        joined(slots, &ending)
    };
    // Names with other marks in each are one part.
    of_file(parts(&stems)).or_else(|| of_file(vec![Slot::part(stems.clone(), None)]))
}

/// Value that most have.
fn most<T>(all: &[T], value: impl Fn(&T) -> usize) -> Option<usize> {
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    for own in all {
        *counts.entry(value(own)).or_default() += 1;
    }
    let most = counts.into_iter().max_by_key(|(_, count)| *count);
    most.map(|(value, _)| value)
}

/// The parts as a pattern; none if they make none.
fn joined(slots: Vec<Slot<'_>>, ending: &str) -> Option<Pattern> {
    let mut names = vec![Vec::new()];
    for slot in slots {
        let last = names.last_mut()?;
        for part in slot.parts() {
            match (last.last_mut(), part) {
                (Some(Part::Text(before)), Part::Text(text)) => before.push_str(&text),
                (_, part) => last.push(part),
            }
        }
        if slot.is_folder {
            names.push(Vec::new());
        }
    }
    match names.last_mut()?.last_mut() {
        Some(Part::Text(text)) => text.push_str(ending),
        _ => names.last_mut()?.push(Part::Text(ending.to_owned())),
    }
    let pattern = Pattern::of(names);
    Pattern::try_from(pattern.to_string())
        .ok()
        .filter(|read| *read == pattern)
}

/// Pieces of a name: between marks, with each mark a piece of its own.
fn pieces(stem: &str) -> Vec<&str> {
    let marked = stem.split_inclusive(MARKS);
    let divided = marked.flat_map(|piece| {
        let text = piece.trim_end_matches(MARKS);
        [text, &piece[text.len()..]]
    });
    divided.filter(|piece| !piece.is_empty()).collect()
}

/// Pieces of letters and of digits: `M5T2` is four.
fn runs(text: &str) -> Vec<&str> {
    let mut runs = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let is_digit = first.is_ascii_digit();
        let end = rest
            .find(|c: char| c.is_ascii_digit() != is_digit)
            .unwrap_or(rest.len());
        runs.push(&rest[..end]);
        rest = &rest[end..];
    }
    runs
}

/// Parts of the files' names without their ending.
fn parts<'p>(stems: &[&'p str]) -> Vec<Slot<'p>> {
    let mut names: Vec<Vec<&'p str>> = stems.iter().map(|stem| pieces(stem)).collect();
    // `M5T2`: letters that are the same in all files divide numbers.
    let divided: Vec<Vec<&str>> = stems.iter().map(|stem| runs(stem)).collect();
    let letters = |runs: &[&'p str]| -> Vec<&'p str> {
        runs.iter().copied().filter(|run| !is_number(run)).collect()
    };
    let is_alike = |runs: &Vec<&'p str>| runs.len() > 3 && letters(runs) == letters(&divided[0]);
    if names.iter().all(|name| name.len() == 1) && divided.iter().all(is_alike) {
        names = divided;
    }
    let mut slots: Vec<Slot<'p>> = Vec::new();
    let column =
        |names: &[Vec<&'p str>], at: usize| names.iter().map(|name| name[at]).collect::<Vec<_>>();
    if names.iter().all(|name| name.len() == names[0].len()) {
        for at in 0..names[0].len() {
            let slot = Slot::part(column(&names, at), before(&slots));
            slots.push(slot);
        }
        return slots;
    }
    // Parts that are alike at both ends, and one field between them.
    let least = names.iter().map(Vec::len).min().unwrap_or(0);
    let is_alike =
        |slot: &Slot<'_>| slot.is_text() || slot.prefix().is_some() || slot.gestures() > 0.5;
    let mut start = 0;
    while start + 1 < least {
        let slot = Slot::part(column(&names, start), before(&slots));
        if !is_alike(&slot) || slot.gestures() > 0.5 {
            break;
        }
        slots.push(slot);
        start += 1;
    }
    // A part that a mark divides from the rest.
    if slots.last().is_some_and(|slot| !slot.is_mark()) {
        slots.pop();
        start -= 1;
    }
    let mut ends: Vec<Vec<&str>> = Vec::new();
    while start + ends.len() + 1 < least {
        let from_end = ends.len() + 1;
        let texts: Vec<&str> = names
            .iter()
            .map(|name| name[name.len() - from_end])
            .collect();
        if !is_alike(&Slot::part(texts.clone(), None)) {
            break;
        }
        ends.push(texts);
    }
    if ends
        .last()
        .is_some_and(|texts| !Slot::part(texts.clone(), None).is_mark())
    {
        ends.pop();
    }
    let middle = stems.iter().zip(&names).map(|(stem, name)| {
        let before: usize = name[..start].iter().map(|piece| piece.len()).sum();
        let after: usize = name[name.len() - ends.len()..]
            .iter()
            .map(|piece| piece.len())
            .sum();
        &stem[before..stem.len() - after]
    });
    slots.push(Slot::part(middle.collect(), before(&slots)));
    for texts in ends.into_iter().rev() {
        let slot = Slot::part(texts, before(&slots));
        slots.push(slot);
    }
    slots
}

/// The last part that is no mark: `R` in `R_0`.
fn before<'s, 'p>(slots: &'s [Slot<'p>]) -> Option<&'s Slot<'p>> {
    let mut slots = slots.iter().rev();
    slots.find(|slot| !slot.is_mark())
}

/// Decides which field each part is.
fn assign(slots: &mut [Slot<'_>], has_labels: bool, files: usize) {
    let mut taken: BTreeSet<&str> = BTreeSet::new();
    if has_labels {
        taken.insert(Field::Gesture.name());
    }
    let mut take = |slot: &mut Slot<'_>, field: Field| {
        // Trials may differ in several parts of a path; a pattern names one.
        let is_free = field == Field::Any || taken.insert(field.name());
        if is_free && slot.field.is_none() {
            slot.field = Some(field);
        }
        is_free
    };
    let open = |slot: &Slot<'_>| slot.field.is_none() && !slot.is_text();
    // Known gestures are told by themselves.
    let most = slots
        .iter_mut()
        .filter(|slot| open(slot) && slot.gestures() >= 0.5);
    if let Some(slot) = most.max_by(|a, b| a.gestures().total_cmp(&b.gestures())) {
        take(slot, Field::Gesture);
    }
    for slot in slots.iter_mut().filter(|slot| open(slot) && slot.is_folder) {
        let is_session = slot
            .texts
            .iter()
            .all(|name| matches!(session(name), Some(kind) if kind.is_part_of_a_person()));
        let first = if is_session {
            Field::Session
        } else {
            Field::Person
        };
        let _ = take(slot, first) || take(slot, Field::Session) || take(slot, Field::Any);
    }
    for slot in slots.iter_mut().filter(|slot| open(slot)) {
        if let Some(field) = slot.hinted() {
            let is_number = slot.prefix().is_some();
            let _ = (field != Field::Trial || is_number) && take(slot, field);
        }
    }
    for slot in slots.iter_mut().filter(|slot| open(slot)) {
        let is_number = slot.prefix() == Some("");
        let is_session = slot.texts.iter().all(|name| session(name).is_some());
        // What a gesture is called comes again, for other people or in other trials.
        let repeats = slot.distinct().len() * 2 <= files;
        let _ = is_number && take(slot, Field::Trial)
            || !is_number && is_session && take(slot, Field::Session)
            // `s1` below a person is no gesture.
            || slot.hinted().is_some() && slot.prefix().is_some() && take(slot, Field::Trial)
            || !is_number && repeats && take(slot, Field::Gesture)
            || !is_number && repeats && take(slot, Field::Person)
            || slot.prefix().is_some() && take(slot, Field::Trial)
            || take(slot, Field::Any);
    }
}

#[cfg(test)]
mod tests;
