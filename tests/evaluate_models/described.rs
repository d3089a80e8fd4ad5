//! From a folder of any layout to the first table: two commands.

use std::fmt::Write as _;
use std::fs;

use recordings::synthetic::{self, SynthOptions};
use shared::intent::{Intent, Vocabulary};

use super::small::{folder, myointent};
use super::{evaluate, model, people};

#[test]
fn a_folder_of_any_layout_is_evaluated_in_two_commands() {
    let folder = folder("evaluate-described");
    let options = SynthOptions {
        subjects: 3,
        recordings: 1,
        seconds: 30,
        ..SynthOptions::default()
    };
    for (at, recording) in synthetic::generate(&options).iter().enumerate() {
        // Channels by letters from the last on, decimals with a comma, words for labels.
        let mut text = "pose;h;g;f;e;d;c;b;a;clock\n".to_owned();
        for (row, (sample, label)) in recording.samples.iter().zip(&recording.labels).enumerate() {
            let word = match label {
                Some(Intent::Open) => "paper",
                Some(Intent::Close) => "fist",
                _ => "rest",
            };
            let values = sample.iter().rev().map(|&value| f64::from(value) / 128.0);
            let values: Vec<String> = values
                .map(|value| value.to_string().replace('.', ","))
                .collect();
            writeln!(text, "{word};{};{}", values.join(";"), 5 * row).unwrap();
        }
        let path = folder.join(format!("data/P0{at}/monday/take_1.txt"));
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    let file = folder.join("one.intent");
    model(&file, &[], Vocabulary::Three);
    let (data, file) = (folder.join("data"), file.to_str().unwrap());
    // Without a description nothing is read.
    assert!(!evaluate(&folder, &["--model", file]));
    assert!(myointent(&["data", "describe", data.to_str().unwrap()]));
    assert!(evaluate(&folder, &["--model", file]));
    assert_eq!(
        people(&folder),
        ["react-emg/P00", "react-emg/P01", "react-emg/P02"]
    );
    let text = fs::read_to_string(data.join("recordings.toml")).unwrap();
    assert!(
        text.contains("\nscale = 128\n")
            && text.contains(
                "\nlabels = { close = [\"fist\"], open = [\"paper\"], relax = [\"rest\"] }"
            ),
        "{text}"
    );
    assert!(
        !myointent(&["data", "describe", data.to_str().unwrap()]),
        "an existing description stays"
    );
}
