use proptest::prelude::*;

use super::*;
use crate::fixture::cells;

fn pattern(text: &str) -> Pattern {
    text.to_owned().try_into().unwrap()
}

fn fields(text: &str, path: &str, known: &[&str]) -> Option<Vec<String>> {
    let found = pattern(text).fields_of(Path::new(path), |word| known.contains(&word));
    found.map(|found| found.0.into_iter().map(|(_, text)| text).collect())
}

/// Patterns, paths that they match, and the texts of their fields.
const DIVIDED: &str = "\
{person}/{gesture}_{trial}.csv | anna/open_3.csv | anna open 3
d/{person}/M{gesture}T{trial}.csv | d/sub12/M5T2.csv | sub12 5 2
{session}_R{trial}_{gesture}.npy | test_trial_0_R1_close.npy | test_trial_0 1 close
{person}/{trial}_{gesture}.npy | EMG_S3/5_thumb_up.npy | EMG_S3 5 thumb_up
{any}/{any}-{gesture}.csv | a/b-c-d.csv | a b c-d
{person}.csv | \u{63e1}.csv | \u{63e1}
raw.CSV | raw.csv | ";

#[test]
fn paths_are_divided_as_the_pattern_says() {
    for [text, path, expected] in cells(DIVIDED) {
        let found = fields(text, path, &[]).map(|found| found.join(" "));
        assert_eq!(found.as_deref(), Some(expected), "{text} {path}");
    }
    for (text, path) in [
        ("{person}/{gesture}_{trial}.csv", "anna/open_x.csv"),
        ("{person}/{gesture}.csv", "anna/monday/open.csv"),
        ("{person}/{gesture}.csv", "open.csv"),
        ("{person}/{gesture}.csv", "anna/open.npy"),
        ("{person}_x.csv", "_x.csv"),
        ("{any}.csv", "anna/1.csv"),
        ("a.B/raw", "a.b/raw"),
    ] {
        assert_eq!(fields(text, path, &[]), None, "{text} {path}");
    }
}

#[test]
fn known_words_decide_where_a_gesture_ends() {
    for (known, expected) in [
        (&["wave_in"][..], "wave_in"),
        (&["wave_in_left"], "wave_in_left"),
        // As short as possible.
        (&[], "wave"),
    ] {
        let found = fields("{gesture}_{any}.csv", "wave_in_left_3.csv", known);
        assert_eq!(found.unwrap()[0], expected);
    }
}

#[test]
fn fields_name_the_file_of_the_labels() {
    let samples = pattern("{any}/{person}_{any}_emg.npy");
    let labels = pattern("{any}/labels/{person}_{any}_ann.npy");
    assert_eq!(labels.beyond(&samples), None);
    let fields = samples.fields_of(Path::new("d/anna_2_emg.npy"), |_| true);
    let path = labels.path_of(&fields.unwrap());
    assert_eq!(path, Path::new("d/labels/anna_2_ann.npy"));
    let beyond = |text, other| pattern(text).beyond(&pattern(other));
    assert_eq!(beyond("{session}.npy", "{any}"), Some(Field::Session));
    assert_eq!(beyond("{any}-{any}", "{any}"), Some(Field::Any));
}

/// Whether a path matches, by a search without memory that tries every division.
fn naive(parts: &[PatternPart], text: &str) -> bool {
    match parts.split_first() {
        None => text.is_empty(),
        Some((PatternPart::Text(own), after)) => text
            .strip_prefix(own.as_str())
            .is_some_and(|rest| naive(after, rest)),
        Some((PatternPart::Field(field), after)) => (1..=text.len())
            .filter(|&end| text.is_char_boundary(end))
            .any(|end| {
                (*field != Field::Trial || is_number(&text[..end])) && naive(after, &text[end..])
            }),
    }
}

proptest! {

    /// The search agrees with one that tries everything.
    #[test]
    fn the_search_equals_a_naive_one(
        parts in prop::collection::vec(prop::sample::select(vec!["a", "ab", "_", "{any}", "{trial}"]), 1..7),
        text in "[ab_1]{0,12}",
    ) {
        let spelled = parts.join("");
        let fields = spelled.matches("{trial}").count();
        prop_assume!(fields < 2 && !spelled.contains("}{"));
        let pattern = pattern(&spelled);
        let found = pattern.fields_of(Path::new(&text), |_| true);
        prop_assert_eq!(found.is_some(), !text.is_empty() && naive(&pattern.parts, &text));
    }

    /// No text makes the parser fail otherwise than by an error, and a pattern is written as it was read.
    #[test]
    fn any_text_is_a_pattern_or_an_error(text in "[a-z{}/._]{0,20}|\\PC{0,12}", path in "\\PC{0,12}") {
        if let Ok(pattern) = Pattern::try_from(text.clone()) {
            prop_assert_eq!(pattern.to_string(), text);
            pattern.fields_of(Path::new(&path), |_| false);
        }
    }
}

#[test]
fn a_long_name_that_almost_matches_takes_no_time() {
    let name = "x".repeat(250);
    let pattern = "{any}x{any}x{any}x{any}x{any}x{any}x{any}y";
    assert_eq!(fields(pattern, &name, &[]), None);
}
