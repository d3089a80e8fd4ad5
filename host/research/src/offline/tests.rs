//! Aggregation of windows that are easy to foretell; the reference's numbers are in `tests/`.

use super::*;
use shared::units::WINDOW;

/// Windows of stride 1 whose every row votes for the window's own class.
fn windows(classes: &[usize], look_ahead: usize) -> WindowRows {
    let mut windows = WindowRows::new(3, 1, look_ahead).unwrap();
    for class in classes {
        let mut row = [0.0; 3];
        row[*class] = 1.0;
        windows.push(&row.repeat(WINDOW)).unwrap();
    }
    windows
}

const MAJORITY: Offline = Offline {
    aggregation: AggregationMode::SameInstant,
    vote: Vote::Majority,
    look_ahead: 2,
    hold: 1,
};

#[test]
fn the_first_window_speaks_alone_until_others_end_within_the_look_ahead() {
    let windows = windows(&[2, 1, 1], 2);
    let labels = MAJORITY.classes(&windows, 602, 3).unwrap();
    // Sample 598: windows ending at 599, 600 vote 2 and 1, a tie; 599: 2, 1, 1.
    assert_eq!(labels[..598], [Some(2); 598]);
    assert_eq!(labels[598..], [Some(1), Some(1), None, None]);
}

#[test]
fn a_later_window_can_be_given_more_weight() {
    let windows = windows(&[1, 0], 1);
    let label = |max_factor| {
        let offline = Offline {
            vote: Vote::MeanLogits { max_factor },
            look_ahead: 1,
            ..MAJORITY
        };
        offline.classes(&windows, 601, 3).unwrap()[599]
    };
    assert_eq!(label(0.5), Some(1));
    assert_eq!(label(1.5), Some(0));
}

#[test]
fn a_class_that_is_not_live_is_never_a_label() {
    let windows = windows(&[2], 0);
    let offline = Offline {
        look_ahead: 0,
        ..MAJORITY
    };
    let labels = offline.intents(&windows, 600, 2).unwrap();
    assert_eq!(labels, [Some(Intent::Relax); 600]);
}

#[test]
fn without_windows_nothing_is_said() {
    let windows = windows(&[], 2);
    assert_eq!(MAJORITY.classes(&windows, 3, 3), Ok(vec![None; 3]));
}

#[test]
fn what_does_not_fit_is_refused() {
    assert_eq!(WindowRows::new(3, 0, 0), Err(OfflineError::Stride));
    let mut windows = windows(&[0, 0], 1);
    let refused = OfflineError::Logits {
        fewest: 6,
        most: 1800,
        classes: 3,
        found: 5,
    };
    assert_eq!(windows.push(&[0.0; 5]), Err(refused));
    let refused = OfflineError::Rows {
        expected: 3,
        found: 2,
    };
    assert_eq!(MAJORITY.classes(&windows, 601, 3), Err(refused));
    let near = Offline {
        look_ahead: 1,
        ..MAJORITY
    };
    let refused = OfflineError::Samples {
        expected: 601,
        found: 600,
    };
    assert_eq!(near.classes(&windows, 600, 3), Err(refused));
    let refused = OfflineError::Classes { most: 3, found: 4 };
    assert_eq!(near.classes(&windows, 601, 4), Err(refused));
    let held = Offline { hold: 0, ..near };
    assert_eq!(held.classes(&windows, 601, 3), Err(OfflineError::Hold));
}
