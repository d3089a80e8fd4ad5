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

fn any_windows() -> impl Strategy<Value = Vec<Rows>> {
    prop::collection::vec(
        prop::array::uniform6(prop::array::uniform4(-6.0f32..6.0)),
        1..20,
    )
}

proptest! {
    #[test]
    fn labels_are_those_of_the_definition(settings in any_settings(), windows in any_windows()) {
        let mut smoother = Smoother::<CLASSES, ROWS>::new(settings, CLASSES).unwrap();
        for (number, window) in windows.iter().enumerate() {
            let end = SampleIndex(599).plus(number as u32 * settings.row_samples);
            let decision = smoother.push(end, window);
            let due = number >= settings.look_ahead && number % settings.hold == 0;
            prop_assert_eq!(decision.is_some(), due);
            let Some(decision) = decision else { continue };
            prop_assert_eq!(decision.window_end, end);
            prop_assert_eq!(
                end.since(decision.instant),
                settings.look_ahead as u32 * settings.row_samples
            );
            // f32 against f64: the class has the largest sum, up to rounding.
            let sums = naive_sums(&settings, &windows[..=number]);
            let most = sums.iter().copied().fold(f64::MIN, f64::max);
            prop_assert!(most - sums[decision.class] < 1e-3);
        }
    }

    #[test]
    fn a_restart_forgets_all_windows_and_the_label(
        settings in any_settings(), before in any_windows(), after in any_windows(),
    ) {
        // The label before counts where a class needs a margin.
        let settings = Settings { margins: entry(2.0), ..settings };
        let mut fresh = Smoother::<CLASSES, ROWS>::new(settings, CLASSES).unwrap();
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
    ..Settings::PAPER_IN_PATCHES
};

/// The classes of the labels over windows whose every row is the same.
fn classes(settings: Settings, used: usize, windows: &[[f32; CLASSES]]) -> Vec<Option<usize>> {
    let mut smoother = Smoother::<CLASSES, ROWS>::new(settings, used).unwrap();
    windows
        .iter()
        .map(|row| smoother.push(SampleIndex(0), &[*row; ROWS]))
        .map(|decision| decision.map(|decision| decision.class))
        .collect()
}

#[test]
fn an_unused_class_never_wins_and_ties_go_to_the_lowest() {
    let settings = Settings {
        look_ahead: 0,
        ..PLAIN
    };
    assert_eq!(classes(settings, 3, &[[-9.0, -2.0, -2.0, 5.0]]), [Some(1)]);
}

#[test]
fn rows_of_nan_and_infinity_still_give_a_class() {
    let settings = Settings {
        look_ahead: 0,
        ..PLAIN
    };
    let rows = [[f32::NAN; CLASSES], [f32::NEG_INFINITY; CLASSES]];
    assert_eq!(classes(settings, CLASSES, &rows), [Some(0), Some(0)]);
}

/// Margins of classes that wait.
fn entry(entry: f32) -> Margins {
    Margins {
        entry,
        ..Margins::NONE
    }
}

#[test]
fn impossible_settings_are_refused_each_with_its_reason() {
    let refused = |settings, classes| Smoother::<CLASSES, ROWS>::new(settings, classes).err();
    let look_ahead = Settings {
        look_ahead: 6,
        ..PLAIN
    };
    assert_eq!(
        refused(look_ahead, 3),
        Some(SettingsError::LookAhead { most: 5, found: 6 })
    );
    assert_eq!(
        refused(Settings { hold: 0, ..PLAIN }, 3),
        Some(SettingsError::Hold)
    );
    for found in [0, 5] {
        assert_eq!(
            refused(PLAIN, found),
            Some(SettingsError::Classes { most: 4, found })
        );
    }
    let other = Settings {
        margins: Margins {
            other: Some(0.0),
            ..Margins::NONE
        },
        ..PLAIN
    };
    assert!(refused(other, 3).is_none());
    assert_eq!(
        refused(other, 4),
        Some(SettingsError::Classes { most: 4, found: 5 })
    );
    let row_samples = Settings {
        row_samples: 0,
        ..PLAIN
    };
    assert_eq!(refused(row_samples, 3), Some(SettingsError::RowSamples));
}

#[test]
fn another_gate_is_in_force_from_the_next_label_on_and_the_settings_again_without_it() {
    let settings = Settings {
        look_ahead: 0,
        margins: entry(1.0),
        ..PLAIN
    };
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
