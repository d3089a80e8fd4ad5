//! Pattern of the paths of a folder, by one rule: what is the same in all paths is text. Of what differs, the outermost
//! folder is the person, a part of a name that is mostly known gestures is the gesture, the first part of digits the trial.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::description::pattern::{Field, Pattern};
use crate::labels::motion::Motion;
use crate::readers::path::is_number;

/// Marks that divide a name.
const MARKS: [char; 4] = ['_', '-', ' ', '.'];

/// Pattern of most of the paths; `has_label` if labels are not in the paths. `None` if names have braces.
pub(super) fn of(paths: &[PathBuf], has_label: bool) -> Option<Pattern> {
    let names = |path: &PathBuf| -> Option<Vec<String>> {
        path.iter()
            .map(|name| Some(name.to_str()?.to_owned()))
            .collect()
    };
    let paths: Vec<Vec<String>> = paths.iter().filter_map(names).collect();
    // A pattern has one depth.
    let depth = usual(paths.iter().map(Vec::len))?;
    let paths: Vec<Vec<String>> = paths
        .into_iter()
        .filter(|path| path.len() == depth)
        .collect();
    let mut free = vec![Field::Person, Field::Session, Field::Trial];
    free.extend((!has_label).then_some(Field::Gesture));
    let mut text = String::new();
    for at in 0..depth - 1 {
        let names: Vec<&str> = paths.iter().map(|path| path[at].as_str()).collect();
        let field = [Field::Person, Field::Session]
            .into_iter()
            .find(|field| free.contains(field));
        text += &part(&names, field.unwrap_or(Field::Any), &mut free);
        text.push('/');
    }
    let files: Vec<&Path> = paths
        .iter()
        .map(|path| Path::new(&path[depth - 1]))
        .collect();
    let stems: Vec<&str> = files
        .iter()
        .filter_map(|file| file.file_stem()?.to_str())
        .collect();
    let pieces: Vec<Vec<&str>> = stems
        .iter()
        .map(|stem| stem.split_inclusive(MARKS).collect())
        .collect();
    let is_alike = pieces.iter().all(|name| {
        name.len() == pieces[0].len()
            && name.iter().zip(&pieces[0]).all(|(a, b)| mark(a) == mark(b))
    });
    if is_alike {
        for (at, piece) in pieces[0].iter().enumerate() {
            let texts: Vec<&str> = pieces
                .iter()
                .map(|name| name[at].trim_end_matches(MARKS))
                .collect();
            let is_trial = texts.iter().all(|text| is_number(text));
            let gestures = texts
                .iter()
                .filter(|text| Motion::of_gesture(text).is_some())
                .count();
            let field = match (is_trial, 2 * gestures >= texts.len()) {
                (true, _) => Field::Trial,
                (false, true) => Field::Gesture,
                (false, false) => Field::Any,
            };
            text += &part(&texts, field, &mut free);
            text += mark(piece);
        }
    } else {
        text += &part(&stems, Field::Any, &mut free);
    }
    let ending = files.first()?.extension()?.to_str()?;
    Pattern::try_from(format!("{text}.{ending}")).ok()
}

/// Mark at the end of a piece.
fn mark(piece: &str) -> &str {
    &piece[piece.trim_end_matches(MARKS).len()..]
}

/// Most frequent number.
fn usual(numbers: impl Iterator<Item = usize>) -> Option<usize> {
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    for number in numbers {
        *counts.entry(number).or_default() += 1;
    }
    counts
        .into_iter()
        .max_by_key(|(_, count)| *count)
        .map(|(number, _)| number)
}

/// Part of a pattern for these texts: their text if they are all the same, else a field. A pattern has a field once: `free`
/// are those that it lacks.
fn part(texts: &[&str], field: Field, free: &mut Vec<Field>) -> String {
    if texts.iter().all(|text| *text == texts[0]) {
        return texts[0].to_owned();
    }
    let is_free = free.contains(&field);
    free.retain(|own| *own != field);
    let field = if is_free { field } else { Field::Any };
    format!("{{{}}}", field.name())
}
