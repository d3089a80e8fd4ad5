use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use shared::intent::Intent;
use shared::units::{Sample, SampleIndex};

use super::*;
use crate::record::assembly::assemble;
use crate::record::journal::Entry;
use crate::record::session::Output;

const CLASSES: [Intent; 3] = [Intent::Relax, Intent::Open, Intent::Close];

/// Session with this many holds of open and close each; `amplitude` gives a channel's amplitude in a class.
fn assembly(holds: usize, mut amplitude: impl FnMut(usize, Intent) -> i8) -> Assembly {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mut entries = vec![Entry::Round { number: 1, at: 0 }];
    let mut at = 0;
    let mut one = |intent, trial, count: u32, amplitude: &mut dyn FnMut(usize, Intent) -> i8| {
        let (first, cue) = (SampleIndex(at), Some(Motion::Intent(intent)));
        entries.push(Entry::of(Output::Cue {
            at: first,
            cue,
            trial,
        }));
        let mut sample = || {
            std::array::from_fn(|channel| {
                let most = amplitude(channel, intent);
                random.random_range(-most..=most)
            })
        };
        let samples: Vec<Sample> = (0..count).map(|_| sample()).collect();
        entries.push(Entry::samples(first, &samples));
        at += count;
    };
    for hold in 0..2 * holds {
        let trial = hold as u32 + 1;
        one(Intent::Relax, trial, 500, &mut amplitude);
        one(CLASSES[1 + hold % 2], trial, 600, &mut amplitude);
    }
    one(Intent::Relax, 99, 500, &mut amplitude);
    entries.push(Entry::Over);
    assemble(&entries)
}

fn loud(_: usize, intent: Intent) -> i8 {
    if intent == Intent::Relax { 3 } else { 40 }
}

fn found(assembly: &Assembly) -> Vec<String> {
    let findings = judge(assembly).findings;
    findings
        .iter()
        .map(|finding| format!("{:?} {finding}", finding.severity()))
        .collect()
}

#[test]
fn a_good_session_is_good_enough() {
    let assembly = assembly(8, loud);
    let quality = judge(&assembly);
    assert!(quality.is_good_enough(), "{quality:?}");
    assert_eq!((quality.counts["open"], quality.counts["close"]), (8, 8));
    assert_eq!(
        found(&assembly).len(),
        1,
        "the lag alone: {:?}",
        found(&assembly)
    );
}

#[test]
fn too_few_gestures_are_counted() {
    assert!(found(&assembly(5, loud)).contains(&"Serious open 5 times, 6 are needed".to_owned()));
    assert!(found(&assembly(7, loud)).contains(&"Warning close 7 times, 8 are needed".to_owned()));
}

#[test]
fn a_silent_and_a_saturated_electrode_are_named_as_the_armband_counts() {
    let assembly = assembly(8, |channel, intent| match channel {
        2 => 0,
        5 if intent != Intent::Relax => 127,
        _ => loud(channel, intent),
    });
    let found = found(&assembly);
    assert!(
        found.contains(&"Serious channel 3 is silent".to_owned()),
        "{found:?}"
    );
    // Noise of -127 to 127 saturates less than 2 % of the samples: this channel is clipped.
    let mut clipped = assembly;
    for sample in &mut clipped.parts[0].samples {
        sample[5] = sample[5].saturating_mul(4);
    }
    let found = self::found(&clipped);
    assert!(
        found
            .iter()
            .any(|one| one.starts_with("Warning channel 6 is saturated")),
        "{found:?}"
    );
}

#[test]
fn a_gesture_like_rest_and_one_that_is_sometimes_forgotten_are_told_apart() {
    let weak = assembly(8, |channel, intent| {
        if intent == Intent::Open {
            3
        } else {
            loud(channel, intent)
        }
    });
    let found = self::found(&weak);
    assert!(
        found
            .iter()
            .any(|one| one.starts_with("Serious open hardly rises above rest")),
        "{found:?}"
    );
    let mut calls = 0;
    let forgotten = assembly(8, |channel, intent| {
        calls += usize::from(intent == Intent::Open);
        // Only the first holds.
        if intent == Intent::Open && calls <= 8 * 600 {
            3
        } else {
            loud(channel, intent)
        }
    });
    let found = self::found(&forgotten);
    assert!(
        found.contains(&"Warning open: 1 of 8 cues were not followed".to_owned()),
        "{found:?}"
    );
}

#[test]
fn losses_an_early_end_and_nothing_at_all_are_said() {
    let mut lossy = assembly(8, loud);
    lossy.lost = 2_500;
    assert!(
        found(&lossy)[0].starts_with("Serious 2500 samples were lost, 12."),
        "{:?}",
        found(&lossy)
    );
    lossy.lost = 600;
    assert!(found(&lossy)[0].starts_with("Warning 600 samples were lost"));
    lossy.complete = false;
    assert!(found(&lossy).contains(&"Note the session ended early".to_owned()));
    assert_eq!(
        found(&Assembly::default())[0],
        "Serious nothing was recorded"
    );
}

#[test]
fn every_finding_says_what_to_do() {
    let findings = [
        Finding::Nothing,
        Finding::Silent { channel: 1 },
        Finding::Early,
        Finding::Damaged {
            lines: 1,
            seconds: 0.1,
        },
        Finding::Late { late_ms: 250 },
    ];
    for finding in findings {
        assert!(finding.advice().len() > 20, "{finding}");
    }
}

#[test]
fn a_free_session_without_a_gesture_is_not_good_enough() {
    let assembly = assembly(0, loud);
    let quality = judge(&assembly);
    assert!(!quality.is_good_enough(), "{quality:?}");
}
