//! Channels of published sets: one frame in every command.

use std::fs;

use evaluation::model_evaluation::{NamedModel, Selection, evaluate_models};
use evaluation::smooth;
use myointent::cli::replay;
use myointent_tests::{recorded, shipped};
use recordings::{LoadOptions, load};
use shared::intent::Intent;
use shared::model::file::Model;

use crate::small::{folder, myointent};

#[test]
fn predict_gives_the_labels_that_evaluate_scores_of_files_of_published_sets() {
    let folder = folder("frame");
    let file = shipped("three-class");
    let named = NamedModel::read(&file).unwrap();
    let model = Model::parse(&named.bytes).unwrap();
    let settings = model.header.smoother.in_patches();
    for (recording, turned) in [
        ("roshambo/data/subject02_session01_emg.npy", false),
        (
            "cote-allard/PreTrainingDataset/Male0/training0/classe_5.dat",
            true,
        ),
        ("one-subject-myo/trial_1/R_0_C_0.csv", true),
        ("myoup/s1/e2_emg.npy", true),
        ("wang-myo/EMG_S1/1_fist.npy", true),
        ("uci-gestures/01/1_raw_data_13-12_22.03.16.txt", true),
    ] {
        let Some(path) = recorded(recording) else {
            continue;
        };
        let labels = |flag: &str| {
            let out = folder.join("labels.csv");
            let [model, path, to] = [&file, &path, &out].map(|path| path.display());
            let line = format!("predict --model {model} --recording {path} --out {to} {flag}");
            assert!(myointent(&line));
            fs::read_to_string(out).unwrap()
        };
        let evaluated = |as_recorded| {
            let options = LoadOptions {
                as_recorded,
                ..LoadOptions::default()
            };
            let library = load(&path, &options).unwrap();
            assert_eq!(library.frames().is_empty(), !turned, "{recording}");
            let selection = Selection {
                seen: true,
                test: true,
                ..Selection::default()
            };
            let models = std::slice::from_ref(&named);
            let evaluation = evaluate_models(models, &library, &selection).unwrap();
            let (logits, samples) = (
                &evaluation.candidates[0].logits[0],
                evaluation.recordings[0].raw.len(),
            );
            smooth(logits, samples, 3, settings).unwrap().reference
        };
        for (flag, as_recorded) in [("", false), ("--as-recorded", true)] {
            let table = labels(flag);
            let number = |row: &str| row.split(',').next().unwrap().parse::<i32>().unwrap();
            let predicted: Vec<i32> = table.lines().skip(1).map(number).collect();
            let class = |label: &Option<Intent>| label.map_or(-1, |own| own.class() as i32);
            let expected: Vec<i32> = evaluated(as_recorded).iter().map(class).collect();
            assert_eq!(predicted, expected, "{recording} {flag:?}");
        }
        assert_eq!(labels("") != labels("--as-recorded"), turned, "{recording}");
        let replayed = replay::recording_of(&path, None, false).unwrap();
        let library = load(&path, &LoadOptions::default()).unwrap();
        assert_eq!(replayed.samples, library.recordings[0].samples);
    }
}
