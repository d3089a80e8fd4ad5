//! Labels that models are scored against.

use std::fs;
use std::path::Path;

use evaluation::model_evaluation::Selection;
use presets::LabelLag;
use recordings::npy;
use shared::intent::{Intent, Vocabulary};
use shared::model::noise::Noise;
use shared::units::{CHANNELS, Sample};

use super::{evaluated, model};
use crate::small::folder;

/// Generates rest, open, rest, scissors, rest, close repeatedly, with the cues; the muscle follows each cue by a time
/// near `late`.
fn cued(late: usize, seed: u64) -> (Vec<Sample>, Vec<&'static str>) {
    let mut random = Noise(seed);
    let (mut samples, mut cues, mut loud) = (Vec::new(), Vec::new(), false);
    for name in ["none", "paper", "none", "scissor", "none", "rock"]
        .repeat(3)
        .into_iter()
        .chain(["none"])
    {
        let late = late + (random.bits() % 40) as usize;
        for at in 0..400 {
            if at == late {
                loud = name != "none";
            }
            let most = if loud { 40.0 } else { 3.0 };
            samples.push([(); CHANNELS].map(|()| (most * random.signed()) as i8));
            cues.push(name);
        }
    }
    (samples, cues)
}

/// Writes recordings of people as roshambo publishes them.
fn as_roshambo(folder: &Path, people: &[(&str, usize)]) {
    fs::create_dir_all(folder).unwrap();
    for (at, &(person, late)) in people.iter().enumerate() {
        let (samples, cues) = cued(late, at as u64);
        let values = samples.iter().flatten();
        let bytes: Vec<u8> = values
            .flat_map(|&value| i64::from(value).to_le_bytes())
            .collect();
        let names = cues.iter().flat_map(|name| {
            let mut field = [0; 7];
            field[..name.len()].copy_from_slice(name.as_bytes());
            field
        });
        let path = |what: &str| folder.join(format!("subject{person}_session01_{what}.npy"));
        fs::write(
            path("emg"),
            npy::encode("<i8", &[cues.len(), CHANNELS], &bytes),
        )
        .unwrap();
        fs::write(
            path("ann"),
            npy::encode("|S7", &[cues.len()], &names.collect::<Vec<u8>>()),
        )
        .unwrap();
    }
}

/// Writes the same recordings as a user's own csv files, a folder a person.
fn as_own(folder: &Path, people: &[(&str, usize)]) {
    for (at, &(person, late)) in people.iter().enumerate() {
        let (samples, cues) = cued(late, at as u64);
        let mut text = "gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7\n".to_owned();
        for (sample, cue) in samples.iter().zip(&cues) {
            let class = match *cue {
                "none" => 0,
                "paper" => 1,
                "rock" => 2,
                _ => -1,
            };
            let values: String = sample.iter().map(|value| format!(",{value}")).collect();
            text += &format!("{class}{values}\n");
        }
        let own = folder.join(format!("p{person}"));
        fs::create_dir_all(&own).unwrap();
        fs::write(own.join(format!("p{person}_session01.csv")), text).unwrap();
    }
}

/// Returns the lag-compensated labels of each recording.
fn truths(folder: &Path, model: &Path, selection: &Selection) -> Vec<Vec<Option<Intent>>> {
    let recordings = evaluated(folder, model, selection).recordings;
    recordings
        .into_iter()
        .map(|recording| recording.lag_compensated)
        .collect()
}

#[test]
fn the_same_samples_have_the_same_labels_whichever_reader_takes_them() {
    let people = [("01", 60), ("02", 90)];
    let folder = folder("evaluate-twins");
    let file = folder.join("one.intent");
    model(&file, &[], Vocabulary::Three);
    let labels = ["published", "own"].map(|name| {
        let own = folder.join(name);
        if name == "published" {
            as_roshambo(&own.join("data"), &people);
        } else {
            as_own(&own.join("data"), &people);
        }
        truths(&own, &file, &Selection::default())
    });
    assert_eq!(labels[0], labels[1]);
    assert!(labels[0][0].contains(&Some(Intent::Open)));
}

#[test]
fn who_is_evaluated_takes_no_part_in_a_constant_lag() {
    let folder = folder("evaluate-lags");
    let file = folder.join("one.intent");
    model(&file, &[], Vocabulary::Three);
    // 01 and 02 are training people of roshambo; 03 and 06 are not.
    let people = [("01", 40), ("02", 40), ("03", 150), ("06", 150)];
    let selection = Selection {
        label_lag: LabelLag::Estimated,
        subjects: vec!["roshambo/03".to_owned()],
        ..Selection::default()
    };
    let first_open = |people: &[(&str, usize)]| {
        let own = folder.join(people.len().to_string());
        as_roshambo(&own.join("data"), people);
        let labels = truths(&own, &file, &selection);
        labels[0]
            .iter()
            .position(|label| *label == Some(Intent::Open))
            .unwrap()
    };
    let lag = first_open(&people) - 400;
    // The training people follow the cues 40 to 80 samples late.
    assert!((35..=85).contains(&lag), "{lag}");
    assert_eq!(first_open(&people[..3]) - 400, lag);
}
