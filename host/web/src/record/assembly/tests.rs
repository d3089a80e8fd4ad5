use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use shared::units::CHANNELS;

use super::*;
use crate::record::session::Output;

const O: Motion = Motion::Intent(Intent::Open);
const R: Motion = Motion::RELAX;
const U: Motion = Motion::Unknown;

fn cue(at: u32, cue: impl Into<Option<Motion>>, trial: u32) -> Entry {
    let at = SampleIndex(at);
    let cue = cue.into();
    Entry::of(Output::Cue { at, cue, trial })
}

fn quiet(first: u32, count: u32) -> Entry {
    let sample = |at: u32| [(at % 5) as i8 - 2; CHANNELS];
    let samples: Vec<Sample> = (first..first + count).map(sample).collect();
    Entry::samples(SampleIndex(first), &samples)
}

/// Noise of at most this amplitude.
fn noise(first: u32, count: u32, most: i8) -> Entry {
    let mut random = ChaCha8Rng::seed_from_u64(first.into());
    let sample = |_| [(); CHANNELS].map(|()| random.random_range(-most..=most));
    let samples: Vec<Sample> = (0..count).map(sample).collect();
    Entry::samples(SampleIndex(first), &samples)
}

#[test]
fn every_sample_has_the_cue_of_its_index_wherever_that_is_written() {
    let round = Entry::Round { number: 1, at: 100 };
    let before = [
        round.clone(),
        cue(100, None, 0),
        cue(110, R, 1),
        quiet(100, 20),
        quiet(120, 20),
    ];
    let after = [
        round,
        quiet(100, 20),
        cue(100, None, 0),
        cue(110, R, 1),
        quiet(120, 20),
    ];
    for entries in [before, after] {
        let assembly = assemble(&entries);
        let [part] = &assembly.parts[..] else {
            panic!("{assembly:?}");
        };
        assert_eq!((part.samples.len(), assembly.lost), (40, 0));
        assert!(part.cues[..10].iter().all(|cue| *cue == U));
        assert!(part.cues[10..].iter().all(|cue| *cue == R));
        assert_eq!((part.trials[9], part.trials[10]), (0, 1));
        assert_eq!(part.index, (100..140).collect::<Vec<_>>());
    }
}

#[test]
fn each_sample_has_the_placement_that_was_in_force_when_it_came() {
    let turned = Entry::Placement {
        turn: 3,
        mirrored: false,
    };
    let entries = [
        Entry::Round { number: 1, at: 0 },
        cue(0, R, 1),
        quiet(0, 20),
        turned,
        // Three samples are bridged: their labels are unknown.
        quiet(23, 20),
        // A gap begins another recording with the same placement.
        quiet(100, 20),
    ];
    let assembly = assemble(&entries);
    let [first, second] = &assembly.parts[..] else {
        panic!("{assembly:?}");
    };
    let placed = Alignment::new(3, false);
    assert_eq!(first.placements[..20], [Alignment::NONE; 20]);
    assert_eq!(first.placements[20..], [placed; 23]);
    assert_eq!(second.placements, [placed; 20]);
}

#[test]
fn five_missing_samples_are_bridged_and_said_and_six_begin_another_recording() {
    let entries = |second| {
        [
            Entry::Round { number: 1, at: 0 },
            cue(0, R, 1),
            quiet(0, 20),
            quiet(second, 20),
        ]
    };
    let bridged = assemble(&entries(25));
    let [part] = &bridged.parts[..] else {
        panic!("{bridged:?}");
    };
    assert_eq!((part.samples.len(), bridged.lost), (45, 5));
    assert_eq!(part.index, (0..45).collect::<Vec<_>>());
    assert!(
        part.samples[20..25]
            .iter()
            .all(|sample| *sample == part.samples[19])
    );
    let bridged: Vec<usize> = (0..45).filter(|&at| part.bridged[at]).collect();
    assert_eq!(bridged, [20, 21, 22, 23, 24]);
    let split = assemble(&entries(26));
    let lengths: Vec<_> = split.parts.iter().map(|part| part.samples.len()).collect();
    assert_eq!((lengths, split.lost), (vec![20, 20], 6));
    assert!(split.parts[1].cues.iter().all(|cue| *cue == R));
}

#[test]
fn a_break_and_a_round_begin_another_recording() {
    let assembly = assemble(&[
        Entry::Round { number: 1, at: 0 },
        cue(0, R, 1),
        quiet(0, 20),
        Entry::Break,
        // A restart begins the count anew.
        cue(4, R, 2),
        quiet(4, 20),
        Entry::Round { number: 2, at: 14 },
        cue(14, None, 0),
        Entry::Over,
    ]);
    let found: Vec<_> = assembly
        .parts
        .iter()
        .map(|part| (part.index[0], part.samples.len()))
        .collect();
    assert_eq!(found, [(0, 20), (4, 10), (14, 10)]);
    assert!(assembly.complete && assembly.lost == 0);
}

#[test]
fn samples_of_a_bad_trial_stay_and_have_no_label() {
    let entries = |bad: bool| {
        let mut entries = vec![
            Entry::Round { number: 1, at: 0 },
            cue(0, R, 1),
            noise(0, 700, 3),
            cue(600, O, 1),
            noise(700, 600, 40),
            cue(1200, R, 2),
            noise(1300, 500, 3),
        ];
        if bad {
            let (trial, why) = (1, RejectReason::Person);
            entries.push(Entry::Rejected { trial, why });
        }
        entries.push(Entry::Over);
        assemble(&entries)
    };
    let (good, bad) = (entries(false), entries(true));
    assert_eq!(good.parts[0].samples, bad.parts[0].samples);
    assert_eq!(
        (good.parts[0].motions[1000], good.parts[0].motions[300]),
        (O, R)
    );
    assert!(
        bad.parts[0].motions[..1200]
            .iter()
            .all(|motion| *motion == U)
    );
    assert_eq!(
        (bad.parts[0].cues[1000], bad.parts[0].motions[1700]),
        (O, R)
    );
    assert_eq!(
        (good.parts[0].holds.len(), bad.parts[0].holds.len()),
        (1, 0)
    );
    // The muscle still works when the rest of the next trial begins, so no rest is labelled there.
    assert_ne!(bad.parts[0].motions[1250], R);
}

#[test]
fn a_long_part_is_cut_in_its_rests_and_nothing_is_missing() {
    // Rest and gesture alternate, five seconds each.
    let label = |at: usize| if (at / 1000).is_multiple_of(2) { R } else { O };
    let part = |motions: Vec<Motion>| AssembledRecording {
        samples: vec![[0; CHANNELS]; motions.len()],
        motions,
        ..AssembledRecording::default()
    };
    let long = part((0..20_000).map(label).collect());
    let files = long.files(6_500);
    assert_eq!(files.first().unwrap().start, 0);
    assert_eq!(files.last().unwrap().end, 20_000);
    for pair in files.windows(2) {
        let [before, after] = pair else {
            unreachable!()
        };
        assert_eq!(before.end, after.start);
        assert!(before.len() <= 6_500 && before.len() > 3_000, "{before:?}");
        assert_eq!(long.motions[before.end - 100..before.end + 100], [R; 200]);
    }
    // A recording without a rest is cut all the same.
    let held = part(vec![O; 20_000]).files(6_500);
    assert_eq!(
        held,
        [0..6_500, 6_500..13_000, 13_000..19_500, 19_500..20_000]
    );
    assert_eq!(part(vec![O; 6_500]).files(6_500), vec![0..6_500]);
}

#[test]
fn lost_lines_end_a_recording_and_the_trial_in_progress_alone_is_not_used() {
    let entries = [
        Entry::Round { number: 1, at: 0 },
        cue(0, R, 1),
        quiet(0, 100),
        cue(100, R, 2),
        cue(150, O, 2),
        quiet(100, 100),
        Entry::Damage { lines: 1 },
        quiet(220, 100),
        cue(320, R, 3),
        quiet(320, 100),
        Entry::Damage { lines: 2 },
    ];
    let assembly = assemble(&entries);
    let lengths: Vec<usize> = assembly.parts.iter().map(|own| own.samples.len()).collect();
    assert_eq!(lengths, [200, 200]);
    assert_eq!(assembly.parts[1].index[0], 220);
    // The last cue, of which no later line shows that it still held.
    assert_eq!(assembly.parts[1].cues[0], O);
    // In the rest at its beginning, the person may have rejected the trial before it.
    let rejected: Vec<u32> = assembly.rejected.keys().copied().collect();
    assert_eq!(rejected, [2, 3]);
    assert_eq!((assembly.damaged, assembly.lost), ((3, 20 + 40), 0));
}
