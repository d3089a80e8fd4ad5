//! The smoother against a reference that stores every window and sums by definition.

use super::*;
use alloc::{vec, vec::Vec};
use proptest::prelude::*;

mod early;

const CLASSES: usize = 4;
const ROWS: usize = 6;
type Rows = [[f32; CLASSES]; ROWS];

/// Sums for the instant `look_ahead` rows before the newest window's end; windows in time order.
fn naive_sums(settings: &Settings, windows: &[Rows]) -> [f64; CLASSES] {
    let ahead = settings.look_ahead;
    let mut sums = [0.0; CLASSES];
    for (late, window) in windows[windows.len() - 1 - ahead..].iter().enumerate() {
        for (after, row) in window[..=late].iter().rev().enumerate() {
            let single = settings.aggregation == AggregationMode::SameInstant;
            if single && after > 0 {
                continue;
            }
            for (sum, logit) in sums.iter_mut().zip(row) {
                *sum += f64::from(*logit);
            }
        }
    }
    sums
}

fn any_settings() -> impl Strategy<Value = Settings> {
    let aggregation = prop_oneof![
        Just(AggregationMode::AllRowsFrom),
        Just(AggregationMode::SameInstant)
    ];
    (aggregation, 0..ROWS, 1usize..5, 1u32..20).prop_map(
        |(aggregation, look_ahead, hold, row_samples)| Settings {
            aggregation,
            look_ahead,
            hold,
            row_samples,
            ..Settings::PAPER_IN_PATCHES
        },
    )
}

proptest! {
    #[test]
    fn a_restart_forgets_all_windows_and_the_label(
        settings in early::any_margins(),
        before in early::any_intents(),
        after in early::any_intents(),
    ) {
        let mut fresh = Smoother::<CLASSES, ROWS>::new(settings, CLASSES - 1).unwrap();
        let mut used = fresh.clone();
        for window in &before {
            used.push(SampleIndex(0), window);
        }
        used.restart();
        for window in &after {
            prop_assert_eq!(
                used.push(SampleIndex(7), window),
                fresh.push(SampleIndex(7), window)
            );
        }
    }
}

const PLAIN: Settings = Settings {
    row_samples: 1,
    hold: 1,
    look_ahead: 0,
    ..Settings::PAPER_IN_PATCHES
};

#[test]
fn rows_of_nan_and_infinity_still_give_a_class() {
    for row in [[f32::NAN; CLASSES], [f32::NEG_INFINITY; CLASSES]] {
        let mut smoother = Smoother::<CLASSES, ROWS>::new(PLAIN, CLASSES).unwrap();
        let label = smoother.push(SampleIndex(0), &[row; ROWS]);
        assert_eq!(label.map(|label| label.class), Some(0), "{row:?}");
    }
}

#[test]
fn impossible_settings_are_refused_each_with_its_reason() {
    let refused = |settings, classes| Smoother::<CLASSES, ROWS>::new(settings, classes).err();
    let (mut ahead, mut hold, mut other, mut rows) = (PLAIN, PLAIN, PLAIN, PLAIN);
    (ahead.look_ahead, hold.hold, rows.row_samples) = (6, 0, 0);
    other.margins.other = Some(0.0);
    let classes = |found| Some(SettingsError::Classes { most: 4, found });
    for (settings, used, expected) in [
        (
            ahead,
            3,
            Some(SettingsError::LookAhead { most: 5, found: 6 }),
        ),
        (hold, 3, Some(SettingsError::Hold)),
        (rows, 3, Some(SettingsError::RowSamples)),
        (PLAIN, 0, classes(0)),
        (PLAIN, 5, classes(5)),
        (other, 3, None),
        (other, 4, classes(5)),
    ] {
        assert_eq!(refused(settings, used), expected, "{settings:?}, {used}");
    }
}

#[test]
fn another_gate_is_in_force_from_the_next_label_on_and_the_settings_again_without_it() {
    let mut settings = PLAIN;
    settings.margins.entry = 1.0;
    let mut smoother = Smoother::<CLASSES, ROWS>::new(settings, CLASSES).unwrap();
    let [weak, rest] = [[0.0, 2.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]];
    let label = |smoother: &mut Smoother<CLASSES, ROWS>, row| {
        let decision = smoother.push(SampleIndex(0), &[row; ROWS]);
        decision.unwrap().class
    };
    assert_eq!(label(&mut smoother, weak), 1);
    let gate = |entry| Gate {
        entry: Some(entry),
        other: Some(900),
        reaction: None,
    };
    smoother.set_gate(gate(201));
    assert_eq!(label(&mut smoother, weak), 1, "it holds");
    assert_eq!(label(&mut smoother, rest), 0);
    assert_eq!(label(&mut smoother, weak), 0);
    smoother.set_gate(gate(200));
    assert_eq!(label(&mut smoother, weak), 1, "the margin itself is enough");
    assert_eq!(label(&mut smoother, rest), 0);
    smoother.set_gate(Gate::default());
    assert_eq!(label(&mut smoother, weak), 1);
    assert_eq!(label(&mut smoother, rest), 0);
    smoother.set_gate(Gate {
        reaction: Some(Reaction::Steady),
        ..Gate::default()
    });
    assert_eq!(label(&mut smoother, weak), 1, "2 is the margin of steady");
    assert!(!smoother.knows_other());
}
