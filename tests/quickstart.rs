//! Main command at a small size: from synthetic recordings to an evaluated model file.

#[path = "small.rs"]
mod small;

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use shared::model::file::Model;
use small::{folder, in_folder, recordings, small_preset};

fn quickstart(folder: &Path, run: &str) -> PathBuf {
    recordings(folder);
    small_preset(folder);
    let line = format!("quickstart --preset @small.toml --data @data --run @{run}");
    assert!(in_folder(folder, &line));
    folder.join(run)
}

#[test]
fn quickstart_leaves_a_model_a_table_and_a_page() {
    let folder = folder("quickstart");
    let run = quickstart(&folder, "run");
    let bytes = fs::read(run.join("student.intent")).unwrap();
    let model = Model::parse(&bytes).unwrap();
    assert_eq!(model.header.dimensions.width, 48);
    assert!(model.header.provenance.subjects_left_out.iter().count() > 0);
    assert!(model.header.provenance.metrics.iter().count() > 0);

    let results: serde_json::Value =
        serde_json::from_slice(&fs::read(run.join("results.json")).unwrap()).unwrap();
    let published = results["published"].as_array().unwrap().iter();
    let models = published
        .clone()
        .map(|line| line["model"].as_str().unwrap());
    let models: BTreeSet<_> = models.collect();
    assert_eq!(
        models.into_iter().collect::<Vec<_>>(),
        [
            "constant relax",
            "energy detector",
            "float student",
            "integer student",
            "teacher"
        ]
    );
    // A constant has a recall of 1 for one class of the three, and recognises no gesture.
    let is_constant = |line: &&serde_json::Value| line["model"] == "constant relax";
    let constant = published.clone().find(is_constant).unwrap();
    let subject = &constant["reference"][2]["subjects"][0];
    assert!((subject["balanced_accuracy"].as_f64().unwrap() - 1.0 / 3.0).abs() < 1e-9);
    let events = &constant["events"]["subjects"][0];
    assert!(events["gestures"].as_u64().unwrap() > 0);
    assert_eq!(events["recognised"], 0);
    assert_eq!(events["latency"]["median"], "missed");
    assert_eq!(events["rest"]["count"], 0);
    let page = fs::read_to_string(run.join("report.html")).unwrap();
    assert!(page.contains("</svg>") && page.contains("integer student"));
    assert!(page.contains("balanced") && page.contains("energy detector"));
}

#[test]
fn the_same_seed_gives_the_same_model_file_bit_for_bit() {
    let folder = folder("seed");
    let once = fs::read(quickstart(&folder, "once").join("student.intent")).unwrap();
    let again = fs::read(quickstart(&folder, "again").join("student.intent")).unwrap();
    assert!(once == again, "two runs of one seed differ");
}
