//! Invariants of an accepted preset that training relies on: asserted of damaged ones here and by `tests/fuzz`.

use crate::Preset;

/// Collects every number of a preset.
fn all_numbers(value: &toml::Value, numbers: &mut Vec<f64>) {
    match value {
        toml::Value::Float(number) => numbers.push(*number),
        toml::Value::Array(values) => values.iter().for_each(|one| all_numbers(one, numbers)),
        toml::Value::Table(table) => table.values().for_each(|one| all_numbers(one, numbers)),
        _ => {}
    }
}

/// Asserts all invariants.
///
/// # Panics
/// If one does not hold.
pub fn check(preset: &Preset) {
    let text = preset.to_toml();
    let again = Preset::parse("again", &text);
    assert_eq!(
        again.ok().as_ref(),
        Some(preset),
        "written and read again: {text}"
    );
    let mut numbers = Vec::new();
    all_numbers(&toml::Value::Table(text.parse().unwrap()), &mut numbers);
    assert!(numbers.iter().all(|number| number.is_finite()), "{text}");
    let (teacher, training, student) = (
        &preset.teacher,
        &preset.teacher_training,
        &preset.distillation,
    );
    for rate in [
        training.learning_rate,
        student.learning_rate,
        preset.fine_tuning.learning_rate,
        preset.fine_tuning.lora_learning_rate,
    ] {
        // A training that diverges is stopped by its loss, however large its steps.
        assert!(
            rate > 0.0 && (rate as f32).is_finite(),
            "a learning rate of {rate}: {text}"
        );
    }
    for share in [teacher.dropout, teacher.attention_dropout] {
        assert!((0.0..1.0).contains(&share), "a dropout of {share}: {text}");
    }
    for decay in [training.weight_decay, student.weight_decay] {
        assert!(
            (0.0..=1.0).contains(&decay),
            "a weight decay of {decay}: {text}"
        );
    }
    assert!(preset.student.receptive_field() <= 55);
    assert!(teacher.layers > 0 && teacher.feed_forward > 0, "{text}");
    assert!(
        preset.teacher_bytes() + preset.student_bytes() < 2e11,
        "{text}"
    );
}

#[cfg(test)]
mod tests {
    //! Damaged presets: whatever numbers and bytes are changed, a preset is refused or can be trained with.

    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::check;
    use crate::{BUILT_IN, Preset};

    /// Presets tried; `MYOINTENT_PRESET_CASES` tries more.
    const CASES: usize = 100_000;

    /// Values that no preset has.
    const WILD: [&str; 22] = [
        "0",
        "1",
        "-1",
        "3",
        "1000000",
        "4294967296",
        "4611686018427387904",
        "9223372036854775807",
        "-9223372036854775808",
        "0.0",
        "-0.0",
        "1.0",
        "1e-320",
        "1e30",
        "1.7e308",
        "nan",
        "inf",
        "-inf",
        "true",
        "\"\"",
        "[]",
        "[1.0, nan]",
    ];

    /// Ranges of the numbers in a text.
    fn numbers(text: &str) -> Vec<std::ops::Range<usize>> {
        let is_number = |byte: u8| byte.is_ascii_digit() || b".-+e".contains(&byte);
        let bytes = text.as_bytes();
        let mut found = Vec::new();
        let mut at = 0;
        while at < bytes.len() {
            let length = bytes[at..]
                .iter()
                .take_while(|byte| is_number(**byte))
                .count();
            if bytes[at].is_ascii_digit() && (at == 0 || b" [".contains(&bytes[at - 1])) {
                found.push(at..at + length);
            }
            at += length.max(1);
        }
        found
    }

    fn damaged(text: &str, random: &mut ChaCha8Rng) -> String {
        let mut text = text.to_owned();
        for _ in 0..random.random_range(1..4) {
            if random.random_bool(0.8) {
                let numbers = numbers(&text);
                let place = numbers[random.random_range(0..numbers.len())].clone();
                text.replace_range(place, WILD[random.random_range(0..WILD.len())]);
            } else {
                let at = random.random_range(0..text.len());
                if text.is_char_boundary(at) && text.is_char_boundary(at + 1) {
                    let byte = char::from(random.random_range(b' '..=b'~'));
                    text.replace_range(at..=at, byte.encode_utf8(&mut [0; 4]));
                }
            }
        }
        text
    }

    #[test]
    fn damaged_presets_are_refused_or_can_be_trained_with() {
        let cases = std::env::var("MYOINTENT_PRESET_CASES").map_or(CASES, |cases| {
            cases
                .parse()
                .expect("MYOINTENT_PRESET_CASES: a number of presets")
        });
        let mut random = ChaCha8Rng::seed_from_u64(16);
        let mut accepted = 0;
        for case in 0..cases {
            let text = damaged(BUILT_IN[case % BUILT_IN.len()].1, &mut random);
            if let Ok(preset) = Preset::parse("damaged", &text) {
                accepted += 1;
                check(&preset);
            }
        }
        assert!(accepted > cases / 100, "{accepted} of {cases}");
    }
}
