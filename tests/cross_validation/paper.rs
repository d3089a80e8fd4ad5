//! Tables of the paper.

use std::fs;

use super::{cross_validate, json, names, preset_with_baselines, roshambo};
use crate::small::{folder, recordings};

/// Returns the rows of the table with this caption, cell by cell.
fn rows<'a>(page: &'a str, caption: &str) -> Vec<Vec<&'a str>> {
    let from = page
        .find(caption)
        .unwrap_or_else(|| panic!("no {caption}: {page}"));
    let lines = page[from..]
        .lines()
        .skip_while(|line| !line.starts_with('|'));
    let rows = lines.take_while(|line| line.starts_with('|')).skip(2);
    let cells = |line: &'a str| line.trim_matches('|').split('|').map(str::trim).collect();
    rows.map(cells).collect()
}

#[test]
fn the_papers_tables_are_those_of_one_cross_validation_that_goes_on() {
    let folder = folder("paper");
    let (data, _) = recordings(&folder);
    roshambo(&folder, &["01", "02", "04", "05"]);
    let preset = preset_with_baselines(&folder);
    let text = fs::read_to_string(&preset).unwrap();
    let text = text.replace(r#"data_sets = ["roshambo", "ss-stm"]"#, "data_sets = []");
    fs::write(&preset, text).unwrap();
    let out = folder.join("out");
    let command = |rest: &[&str]| {
        cross_validate(
            [&preset, &data, &out],
            "2-fold",
            &[&["--paper"], rest].concat(),
        )
    };
    assert!(!command(&["--seeds", "1,2"]), "one seed");
    assert!(command(&["--list"]) && !out.exists());
    // A job that starts from another teacher says which.
    assert!(!command(&["--only", "teacher-lora", "--fold", "2"]));
    assert!(command(&["--only", "teacher-pre-trained", "--fold", "2"]));
    let job = |name: &str| out.join(name).join("seed-42/fold-2");
    let weights = || fs::read(job("small-teacher-pre-trained").join("teacher.bpk")).unwrap();
    let before = weights();
    assert!(command(&["--only", "teacher-lora", "--fold", "2"]));
    assert!(!out.join("paper.md").exists(), "most jobs are left");
    assert!(command(&[]));
    assert!(weights() == before, "trained once");

    let config = |name: &str| json(&job(name).join("config.json"));
    let pre_trained = &config("small-teacher-pre-trained")["split"];
    for role in ["training", "validation", "held_out"] {
        let people = names(&pre_trained[role]);
        assert!(!people.is_empty() && people.iter().all(|one| one.starts_with("synthetic/")));
    }
    let tuned = config("small-teacher-fine-tuned");
    assert!(
        names(&tuned["split"]["training"])
            .iter()
            .all(|one| one.starts_with("roshambo/"))
    );
    assert!(
        tuned["start"]
            .as_str()
            .unwrap()
            .contains("small-teacher-pre-trained/seed-42/fold-2")
    );
    assert_eq!(
        config("small-teacher-window-100")["preset"]["teacher"]["window"],
        100
    );

    let page = fs::read_to_string(out.join("paper.md")).unwrap();
    let names_of =
        |caption: &str| -> Vec<&str> { rows(&page, caption).iter().map(|row| row[1]).collect() };
    let models = [
        "small",
        "teacher",
        "LDA",
        "MLP",
        "LSTM",
        "ED-TCN",
        "TraHGR",
        "constant relax",
        "energy detector",
    ];
    assert_eq!(names_of("Main result"), models);
    assert_eq!(names_of("TA by the buffer"), models);
    assert_eq!(names_of("Window of the teacher"), ["100", "300", "600"]);
    assert_eq!(names_of("Pre-training").len(), 4);
    assert_eq!(
        names_of("Look-ahead")[..6],
        ["small", "small", "small", "teacher", "teacher", "teacher"]
    );
    // Everybody counts once, the target's people in its table; relax alone follows no gesture.
    let constant = &rows(&page, "Main result")[7];
    assert_eq!(constant[0], "all 3");
    assert!(constant[8].starts_with("8 / "), "{constant:?}");
    assert_eq!(constant[4], "0.000 (0.00)");
    assert!(
        rows(&page, "Pre-training")
            .iter()
            .all(|row| row[8].starts_with("4 / "))
    );
    assert!(names_of("Prediction offsets").contains(&"energy detector"));
}
