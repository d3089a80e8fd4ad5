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
fn each_flaw_is_found_with_its_severity() {
    let flawed = |channel, intent| match channel {
        2 => 0,
        5 if intent != Intent::Relax => 127,
        _ => loud(channel, intent),
    };
    // Noise of -127 to 127 saturates less than 2 % of the samples: this channel is clipped.
    let mut clipped = assembly(8, flawed);
    for sample in &mut clipped.parts[0].samples {
        sample[5] = sample[5].saturating_mul(4);
    }
    let mut calls = 0;
    // Opens the hand as weakly as in rest, before a call.
    let mut weak = |until: usize| {
        assembly(8, |channel, intent| {
            calls += usize::from(intent == Intent::Open);
            let is_weak = intent == Intent::Open && calls <= until;
            if is_weak { 3 } else { loud(channel, intent) }
        })
    };
    let (forgotten, weak) = (weak(8 * 600), weak(usize::MAX));
    let lossy = |lost| Assembly {
        lost,
        ..assembly(8, loud)
    };
    let early = Assembly {
        complete: false,
        ..assembly(8, loud)
    };
    for (assembly, expected) in [
        (
            assembly(0, loud),
            "Serious open 0 times: 6 are enough, 8 are better",
        ),
        (
            assembly(5, loud),
            "Serious open 5 times: 6 are enough, 8 are better",
        ),
        (
            assembly(7, loud),
            "Warning close 7 times: 6 are enough, 8 are better",
        ),
        (assembly(8, flawed), "Serious channel 3 is silent"),
        (clipped, "Warning channel 6 is saturated"),
        (weak, "Serious open hardly rises above rest"),
        (forgotten, "Warning open: 1 of 8 cues were not followed"),
        (lossy(2_500), "Serious 2500 samples were lost, 12."),
        (lossy(600), "Warning 600 samples were lost"),
        (early, "Note the session ended early"),
        (Assembly::default(), "Serious nothing was recorded"),
    ] {
        let found = found(&assembly);
        let is_found = found.iter().any(|one| one.starts_with(expected));
        assert!(is_found, "{expected}: {found:?}");
    }
}
