//! Invariants of an accepted preset that training relies on: asserted by `tests/fuzz`.

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
    for rate in [
        preset.teacher_training.learning_rate,
        preset.distillation.learning_rate,
        preset.fine_tuning.learning_rate,
        preset.fine_tuning.lora_learning_rate,
    ] {
        // A training that diverges is stopped by its loss, however large its steps.
        assert!(
            rate > 0.0 && (rate as f32).is_finite(),
            "a learning rate of {rate}: {text}"
        );
    }
    assert!(preset.student.receptive_field() <= 55);
    assert!(
        preset.teacher_bytes() + preset.student_bytes() < 2e11,
        "{text}"
    );
}
