//! Pattern of paths, guessed from the paths.
//!
//! What is the same in all paths is text. What differs is a field: the outermost folder is the person; in the file's
//! name, the words around a part (`R_0`, `subject08`), known gestures, sessions and numbers tell. Where names have
//! different numbers of parts (`wave_in_3`, `open_3`), those that are alike are taken off both ends, and what is left is
//! one field.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::description::pattern::{Field, Part, Pattern};
use crate::labels::motion::Motion;
use crate::library::session::session;
use crate::readers::path::is_number;

/// Words in front of a number or a name that say what it is.
const HINTS: [(Field, &[&str]); 4] = [
    (
        Field::Person,
        &[
            "s",
            "p",
            "sub",
            "subj",
            "subject",
            "user",
            "person",
            "participant",
            "patient",
            "id",
        ],
    ),
    (
        Field::Gesture,
        &[
            "c", "class", "classe", "g", "gesture", "m", "motion", "movement", "label", "pose",
        ],
    ),
    (
        Field::Trial,
        &[
            "r",
            "rep",
            "repetition",
            "t",
            "trial",
            "take",
            "run",
            "n",
            "nr",
            "no",
        ],
    ),
    (
        Field::Session,
        &["session", "sess", "day", "round", "block", "set"],
    ),
];

/// Characters between the parts of a name.
const MARKS: [char; 5] = ['_', '-', ' ', '.', '+'];

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

/// The value that most have.
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

/// Part of all paths: a folder, or a part of the file's name.
struct Slot<'p> {
    /// The part of each path.
    texts: Vec<&'p str>,
    field: Option<Field>,
    is_folder: bool,
    /// Words before it that may say what it is.
    hint: String,
}

impl<'p> Slot<'p> {
    const fn folder(texts: Vec<&'p str>, field: Option<Field>) -> Self {
        Self {
            texts,
            field,
            is_folder: true,
            hint: String::new(),
        }
    }

    fn part(texts: Vec<&'p str>, before: Option<&Self>) -> Self {
        let mut slot = Self {
            texts,
            field: None,
            is_folder: false,
            hint: String::new(),
        };
        // `subject08`, or `R` in front of 0.
        let own = slot.prefix().filter(|prefix| !prefix.is_empty());
        let before = before
            .filter(|before| before.is_text())
            .map(|before| before.texts[0]);
        let hint = own.or(before).unwrap_or_default();
        slot.hint = hint.trim_matches(MARKS).to_lowercase();
        slot
    }

    fn distinct(&self) -> BTreeSet<&'p str> {
        self.texts.iter().copied().collect()
    }

    fn is_text(&self) -> bool {
        self.distinct().len() == 1
    }

    fn is_mark(&self) -> bool {
        self.texts
            .iter()
            .all(|text| text.chars().all(|c| MARKS.contains(&c)))
    }

    /// Letters in front of the digits of each text, if they are the same.
    fn prefix(&self) -> Option<&'p str> {
        fn letters(text: &str) -> &str {
            text.trim_end_matches(|c: char| c.is_ascii_digit())
        }
        let first = letters(self.texts.first()?);
        let is_alike = |text: &&str| letters(text) == first && text.len() > first.len();
        self.texts.iter().all(is_alike).then_some(first)
    }

    /// Share of the texts that are known gestures.
    fn gestures(&self) -> f64 {
        let known = self
            .texts
            .iter()
            .filter(|text| Motion::of_gesture(text).is_some());
        known.count() as f64 / self.texts.len() as f64
    }

    fn hinted(&self) -> Option<Field> {
        let hint = |(field, words): &(Field, &[&str])| {
            words.contains(&self.hint.as_str()).then_some(*field)
        };
        HINTS.iter().find_map(hint)
    }

    /// Parts of the pattern.
    fn parts(&self) -> Vec<Part> {
        let text = |text: &str| Part::Text(text.to_owned());
        match self.field {
            None => vec![text(self.texts[0])],
            // A trial is a number.
            Some(Field::Trial) => {
                let prefix = self.prefix().unwrap_or_default();
                let prefix = (!prefix.is_empty()).then(|| text(prefix));
                prefix
                    .into_iter()
                    .chain([Part::Field(Field::Trial)])
                    .collect()
            }
            Some(field) => vec![Part::Field(field)],
        }
    }
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
mod tests {
    use super::*;

    #[test]
    fn paths_show_their_pattern() {
        for (paths, has_labels, expected) in [
            (
                &[
                    "p01/testing_doubletap_05.npy",
                    "p01/training_open_01.npy",
                    "p02/testing_open_05.npy",
                    "p02/training_close_02.npy",
                ][..],
                false,
                "{person}/{session}_{gesture}_{trial}.npy",
            ),
            (
                &[
                    "m1/train_R0_relax.npy",
                    "m1/test_trial_0_R1_close.npy",
                    "m2/train_R0_close.npy",
                    "m2/test_trial_1_R0_open.npy",
                ],
                false,
                "{person}/{session}_R{trial}_{gesture}.npy",
            ),
            (
                &[
                    "data/sub1/M5T2.csv",
                    "data/sub2/M1T1.csv",
                    "data/sub2/M5T1.csv",
                    "data/sub1/M1T2.csv",
                ],
                false,
                "data/{person}/M{gesture}T{trial}.csv",
            ),
            (
                &[
                    "d/subject01_session01_emg.npy",
                    "d/subject02_session01_emg.npy",
                    "d/subject02_session02_emg.npy",
                ],
                true,
                "d/{person}_{session}_emg.npy",
            ),
            (
                &[
                    "EMG_S1/1_fist.npy",
                    "EMG_S1/10_thumb_up.npy",
                    "EMG_S2/1_fist.npy",
                    "EMG_S2/10_thumb_up.npy",
                ],
                false,
                "{person}/{trial}_{gesture}.npy",
            ),
            (
                &[
                    "trial_1/R_0_C_2.csv",
                    "trial_1/R_1_C_0.csv",
                    "trial_2/R_0_C_2.csv",
                    "trial_2/R_0_C_0.csv",
                ],
                false,
                "{session}/R_{trial}_C_{gesture}.csv",
            ),
            (
                &["C_0_R_0_emg.csv", "C_1_R_0_emg.csv", "C_0_R_1_emg.csv"],
                false,
                "C_{gesture}_R_{trial}_emg.csv",
            ),
            (
                &[
                    "d/s6_r_5/s6_r_5-paper-2-emg.csv",
                    "d/s1_l_1/s1_l_1-rock-2-emg.csv",
                    "d/s1_l_1/s1_l_1-paper-1-emg.csv",
                    "d/s6_r_5/s6_r_5-paper-3-emg.csv",
                ],
                false,
                "d/{any}/{person}_{any}_{trial}-{gesture}-{any}-emg.csv",
            ),
            (
                &[
                    "a/wave_in_3.csv",
                    "a/open_3.csv",
                    "b/wave_in_4.csv",
                    "b/open_3.csv",
                ],
                false,
                "{person}/{gesture}_{trial}.csv",
            ),
            (&["anna.csv", "bob.csv"], true, "{any}.csv"),
            (&["raw.csv"], false, "raw.csv"),
            (
                &["emg-1444331136.csv", "channels_time.csv"],
                false,
                "{any}.csv",
            ),
            (
                &[
                    "p1/s1_emg.npy",
                    "p2/s1_emg.npy",
                    "p2/s2_emg.npy",
                    "p3/s1_emg.npy",
                ],
                false,
                "{person}/s{trial}_emg.npy",
            ),
            (
                &["s_1/s_1_a.csv", "s_2/s_2_a.csv"],
                true,
                "{person}/s_{trial}_a.csv",
            ),
            (
                &[
                    "p1/w08_01.npy",
                    "p1/w08_02.npy",
                    "p2/w09_01.npy",
                    "p2/w09_02.npy",
                ],
                false,
                "{person}/{gesture}_{trial}.npy",
            ),
        ] {
            let paths: Vec<PathBuf> = paths.iter().map(PathBuf::from).collect();
            let found = pattern(&paths, has_labels).unwrap();
            assert_eq!(found.to_string(), expected);
            for path in &paths {
                assert!(
                    found.fields_of(path, |_| true).is_some(),
                    "{expected}: {}",
                    path.display()
                );
            }
        }
        assert_eq!(pattern(&[], false), None);
    }

    proptest::proptest! {
        /// Whatever the paths are, the guess is a pattern that is written as it is read, or none.
        #[test]
        fn any_paths_give_a_pattern_or_none(paths in proptest::collection::vec("[a-c1-2_./{-]{1,12}", 0..6)) {
            let paths: Vec<PathBuf> = paths.iter().map(|path| PathBuf::from(format!("x/{path}.csv"))).collect();
            if let Some(found) = pattern(&paths, false) {
                let read = Pattern::try_from(found.to_string());
                proptest::prop_assert_eq!(read, Ok(found));
            }
        }
    }
}
