//! Presets: an accepted preset can be trained with, and is the same after writing and reading it.

use crate::input::Input;
use presets::invariants::check;
use presets::{BUILT_IN, Preset};

/// Values that no preset has, and some of which another key has.
#[rustfmt::skip]
const VALUES: [&str; 32] = [
    "0", "1", "-1", "3", "64", "600", "1000000", "4294967296", "9223372036854775807", "-9223372036854775808", "0.0",
    "-0.0", "0.5", "1.0", "51.0", "1e-320", "1e30", "1.7e308", "nan", "inf", "-inf", "true", "false", "\"\"",
    "\"class\"", "\"constant\"", "\"wang-myo/1\"", "[]", "[1.0, nan]", "[\"intent\", \"joint\"]", "{ warm-up = 2.0 }",
    "{ gain = 4.0, rotation = 9 }",
];
/// Keys that no built-in preset has.
#[rustfmt::skip]
const LINES: [&str; 7] = [
    "balance = 0.5", "normalize = true", "other_movement = \"class\"", "reaction = \"fast,other=-1\"",
    "aggregation = \"same-instant\"", "lora = { rank = 4, alpha = 8.0 }", "ensemble = { members = 3, epochs = 2 }",
];

/// Takes a byte for the kind: a text unchanged, or changes of a preset that comes with the program.
pub fn run(data: &[u8]) {
    let mut input = Input(data);
    let kind = input.below(1 + BUILT_IN.len());
    let text = if kind == 0 {
        let Ok(text) = std::str::from_utf8(input.0) else {
            return;
        };
        text.to_owned()
    } else {
        changed(BUILT_IN[kind - 1].1, &mut input)
    };
    match Preset::parse("fuzzed", &text) {
        Ok(preset) => check(&preset),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// Returns a preset with values replaced, lines inserted and removed, bytes changed.
fn changed(preset: &str, input: &mut Input<'_>) -> String {
    let mut lines: Vec<String> = preset.lines().map(str::to_owned).collect();
    while !input.is_empty() {
        let kind = input.byte();
        let at = input.below(lines.len());
        let key = lines[at].split_once(" = ").map(|(key, _)| key.to_owned());
        match (kind % 8, key) {
            (0..=2, Some(key)) => {
                lines[at] = format!("{key} = {}", VALUES[input.below(VALUES.len())])
            }
            (3, Some(key)) => {
                lines[at] = format!("{key} = {}", String::from_utf8_lossy(input.short()));
            }
            (4, _) => lines.insert(at, LINES[input.below(LINES.len())].to_owned()),
            (5, _) if lines.len() > 1 => drop(lines.remove(at)),
            (6, _) => {
                let other = input.below(lines.len());
                lines.swap(at, other);
            }
            _ => lines[at].push_str(&String::from_utf8_lossy(input.short())),
        }
    }
    lines.join("\n")
}
