//! Evaluation of a turned armband, lost notifications, alignment and its template.

use std::fs;

use evaluation::model_evaluation::{ModelEvaluation, Selection, Turn, Worn};
use shared::intent::Vocabulary;
use shared::model::file::Model;
use shared::stream::alignment::Template;
use shared::uart_line::alignment::AlignmentState;
use shared::units::CHANNELS;

use super::{evaluate, evaluated, model, with_model};
use crate::small::{folder, in_folder, recordings};

/// Selection of everybody, with the armband turned by so many places, with or without an alignment.
fn turned(places: u8, align: bool) -> Selection {
    Selection {
        worn: Worn {
            turn: Turn::By(places),
            mirrored: false,
        },
        align,
        ..Selection::default()
    }
}

#[test]
fn a_rotated_armband_changes_what_the_model_sees_and_not_the_amplitude() {
    let folder = with_model("evaluate-rotated", &[]);
    let with = |places| evaluated(&folder, &turned(places, false));
    let (straight, rotated, full_turn) = (with(0), with(4), with(8));
    assert_ne!(straight.candidates[0].logits, rotated.candidates[0].logits);
    assert_eq!(
        straight.candidates[0].logits,
        full_turn.candidates[0].logits
    );
    let energy = |evaluation: &ModelEvaluation| evaluation.candidates[2].logits.clone();
    assert_eq!(energy(&straight), energy(&rotated));
    assert_eq!(
        straight.recordings[0].raw[7][0],
        rotated.recordings[0].raw[7][4]
    );
}

#[test]
fn alignment_finds_the_same_however_the_armband_is_turned_and_its_openings_are_not_scored() {
    let folder = with_model("evaluate-aligned", &[]);
    let with = |places, align| evaluated(&folder, &turned(places, align));
    let (plain, straight, turned) = (with(0, false), with(0, true), with(3, true));
    let names: Vec<_> = straight
        .candidates
        .iter()
        .map(|own| own.model.to_string())
        .collect();
    assert_eq!(
        names,
        ["one", "one, aligned", "constant relax", "energy detector"]
    );
    assert_eq!(straight.results.alignments.len(), 4);
    assert_eq!(straight.results.alignments, turned.results.alignments);
    let aligned = straight.results.alignments.iter();
    assert!(
        aligned
            .clone()
            .any(|own| own.outcome == AlignmentState::Aligned)
    );
    // The logits are compared where an alignment was found.
    for (at, recording) in straight.recordings.iter().enumerate() {
        let mut found = aligned
            .clone()
            .filter(|own| own.outcome == AlignmentState::Aligned);
        if found.any(|own| own.subject == recording.subject) {
            let logits = |evaluation: &ModelEvaluation| evaluation.candidates[1].logits[at].clone();
            assert_eq!(logits(&straight), logits(&turned));
        }
    }
    let labels = |evaluation: &ModelEvaluation| -> usize {
        let recordings = evaluation.recordings.iter();
        recordings
            .map(|recording| recording.lag_compensated.iter().flatten().count())
            .sum()
    };
    assert!(labels(&straight) + 4 * 2 * 60 <= labels(&plain));
    let words = "@one.intent --rotate any --mirror --align";
    assert!(evaluate(&folder, words));
    let text = fs::read_to_string(folder.join("people.csv")).unwrap();
    assert!(text.contains("one, aligned"));
}

#[test]
fn an_alignment_that_is_told_the_arm_takes_no_placement_on_the_other_one() {
    let folder = with_model("evaluate-arm-told", &[]);
    let file = folder.join("one.intent");
    // The second template's electrodes run the other way round: one of the two templates is for the wrong arm.
    let bytes = fs::read(&file).unwrap();
    let template = Model::parse(&bytes).unwrap().header.template.unwrap();
    let mut reversed = template.to_bytes();
    reversed[..2 * CHANNELS].as_chunks_mut::<2>().0.reverse();
    let reversed = Template::from_bytes(&reversed).unwrap();
    let wrong = |mirrored, arm_told| {
        let selection = Selection {
            worn: Worn {
                mirrored,
                ..Worn::default()
            },
            align: true,
            arm_told,
            ..Selection::default()
        };
        let count = |template| {
            fs::write(&file, Model::with_template(&bytes, Some(template)).unwrap()).unwrap();
            let results = evaluated(&folder, &selection).results;
            let alignments = results.alignments.iter();
            alignments.filter(|own| own.wrong_arm).count()
        };
        count(&template) + count(&reversed)
    };
    for mirrored in [false, true] {
        assert!(wrong(mirrored, false) > 0);
        assert_eq!(wrong(mirrored, true), 0);
    }
}

#[test]
fn a_template_is_made_of_the_people_whom_the_model_has_seen_and_nothing_else_changes() {
    let folder = folder("template");
    recordings(&folder);
    let made = |seen: &[&str]| {
        let file = folder.join("bare.intent");
        model(&file, seen, Vocabulary::Three);
        let bare = Model::with_template(&fs::read(&file).unwrap(), None).unwrap();
        fs::write(&file, &bare).unwrap();
        let done = in_folder(&folder, "template @bare.intent --data @data");
        let bytes = fs::read(&file).unwrap();
        assert_eq!(Model::with_template(&bytes, None).unwrap(), bare);
        done.then(|| {
            Model::parse(&bytes)
                .unwrap()
                .header
                .template
                .expect("a template")
        })
    };
    let first = made(&["synthetic/s1", "synthetic/s2", "synthetic/s3"]);
    let other = made(&["synthetic/s2", "synthetic/s3", "synthetic/s4"]);
    assert!(first.is_some() && other.is_some());
    assert_ne!(first, other);
    assert_eq!(made(&["synthetic/s1", "synthetic/s2"]), None);
}
