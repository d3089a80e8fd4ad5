//! Model files evaluated on any recordings, by the command line, on recordings of one person a file.

#[path = "small.rs"]
#[expect(dead_code, reason = "nothing is trained here")]
mod small;

use std::fs;
use std::path::Path;

use evaluation::model_evaluation::{
    ModelEvaluation, NamedModel, Selection, Turn, Worn, evaluate_models,
};
use presets::LabelLag;
use recordings::{LoadOptions, load, npy};
use shared::intent::{Intent, Vocabulary};
use shared::model::dimensions::Dimensions;
use shared::model::file::Model;
use shared::model::file::random::random_model;
use shared::model::noise::Noise;
use shared::stream::alignment::Template;
use shared::units::{CHANNELS, Sample};
use small::{folder, myointent, recordings};

/// A small model that has seen these people.
fn model(path: &Path, seen: &[&str], vocabulary: Vocabulary) {
    let dimensions = Dimensions {
        width: 32,
        layers: 1,
        span: 20,
        vocabulary,
        other: false,
    };
    let mut parts = random_model(dimensions, 5);
    parts.provenance.subjects_seen = seen.iter().map(|&name| name.to_owned()).collect();
    fs::write(path, parts.to_bytes().unwrap()).unwrap();
}

fn evaluate(folder: &Path, more: &[&str]) -> bool {
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (data, csv, page) = (path("data"), path("people.csv"), path("page.html"));
    let mut arguments = vec![
        "evaluate", "--data", &data, "--csv", &csv, "--report", &page,
    ];
    arguments.extend(more);
    myointent(&arguments)
}

/// Subject, model and balanced accuracy of each row of the CSV file.
fn rows(folder: &Path) -> Vec<(String, String, f64)> {
    let text = fs::read_to_string(folder.join("people.csv")).unwrap();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        (
            cells[0].to_owned(),
            cells[1].to_owned(),
            cells[2].parse().unwrap(),
        )
    };
    text.lines().skip(1).map(row).collect()
}

fn people(folder: &Path) -> Vec<String> {
    let mut people: Vec<String> = rows(folder)
        .into_iter()
        .map(|(subject, _, _)| subject)
        .collect();
    people.sort_unstable();
    people.dedup();
    people
}

#[test]
fn people_whom_a_model_has_seen_are_left_out_unless_asked_for() {
    let folder = folder("evaluate-seen");
    recordings(&folder);
    let file = folder.join("one.intent");
    model(&file, &["synthetic/s1", "synthetic/s3"], Vocabulary::Three);
    let file = file.to_str().unwrap();
    assert!(evaluate(&folder, &["--model", file]));
    assert_eq!(people(&folder), ["synthetic/s2", "synthetic/s4"]);
    assert!(evaluate(&folder, &["--model", file, "--seen"]));
    assert_eq!(people(&folder).len(), 4);
    let text = fs::read_to_string(folder.join("people.csv")).unwrap();
    let marked = text
        .lines()
        .filter(|line| line.ends_with("seen in training by one"));
    // Both people, under the model, the constant and the energy detector.
    assert_eq!(marked.count(), 6);
    assert!(evaluate(
        &folder,
        &["--model", file, "--subjects", "synthetic/s1"]
    ));
    assert_eq!(people(&folder), ["synthetic/s1"]);
    assert!(!evaluate(
        &folder,
        &["--model", file, "--subjects", "synthetic/s9"]
    ));
}

#[test]
fn several_models_and_the_floors_stand_side_by_side_and_the_page_begins_with_the_worst() {
    let folder = folder("evaluate-several");
    recordings(&folder);
    let files = ["a.intent", "b.intent"].map(|name| folder.join(name));
    for file in &files {
        model(file, &[], Vocabulary::Three);
    }
    let [a, b] = files.each_ref().map(|file| file.to_str().unwrap());
    assert!(evaluate(&folder, &["--model", a, "--model", b]));
    let rows = rows(&folder);
    let of = |model: &str| -> Vec<f64> {
        let own = rows.iter().filter(|(_, name, _)| name == model);
        own.map(|(_, _, balanced)| *balanced).collect()
    };
    assert_eq!(of("a"), of("b"));
    assert_eq!(of("a").len(), 4);
    assert!(of("a").is_sorted());
    // Each of three classes is present, and relax is one of them.
    assert!(
        of("constant relax")
            .iter()
            .all(|&balanced| balanced == 0.333)
    );
    assert_eq!(of("energy detector").len(), 4);
    let page = fs::read_to_string(folder.join("page.html")).unwrap();
    let worst = &rows.iter().find(|(_, name, _)| name == "a").unwrap().0;
    let drawn = page.find("EMG and labels: ").unwrap();
    assert!(
        page[drawn..].starts_with(&format!("EMG and labels: {worst}")),
        "{}",
        &page[drawn..drawn + 60]
    );

    let six = folder.join("six.intent");
    model(&six, &[], Vocabulary::Six);
    assert!(!evaluate(
        &folder,
        &["--model", a, "--model", six.to_str().unwrap()]
    ));
}

/// The evaluation of one model on the recordings below `folder`.
fn evaluated(folder: &Path, file: &Path, selection: &Selection) -> ModelEvaluation {
    let models = [NamedModel {
        name: "one".to_owned(),
        bytes: fs::read(file).unwrap(),
    }];
    let library = load(&folder.join("data"), &LoadOptions::default()).unwrap();
    evaluate_models(&models, &library, selection).unwrap()
}

#[test]
fn a_rotated_armband_changes_what_the_model_sees_and_not_the_amplitude() {
    let folder = folder("evaluate-rotated");
    recordings(&folder);
    let file = folder.join("one.intent");
    model(&file, &[], Vocabulary::Three);
    let with = |places| {
        let selection = Selection {
            worn: Worn {
                turn: Turn::By(places),
                mirrored: false,
            },
            ..Selection::default()
        };
        evaluated(&folder, &file, &selection)
    };
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
fn lost_notifications_repeat_the_sample_before_them() {
    let folder = folder("evaluate-losses");
    recordings(&folder);
    let file = folder.join("one.intent");
    model(&file, &[], Vocabulary::Three);
    let with = |lost_percent| {
        let selection = Selection {
            lost_percent,
            ..Selection::default()
        };
        evaluated(&folder, &file, &selection)
    };
    let (whole, half, again) = (with(0), with(50), with(50));
    assert_eq!(half.recordings[0].raw, again.recordings[0].raw);
    assert_eq!(half.recordings[0].published, whole.recordings[0].published);
    assert_ne!(whole.candidates[0].logits, half.candidates[0].logits);
    let pairs = whole.recordings[0]
        .raw
        .chunks(2)
        .zip(half.recordings[0].raw.chunks(2));
    let lost = pairs.filter(|(sent, received)| sent != received).count();
    let share = lost as f64 / (whole.recordings[0].raw.len() / 2) as f64;
    assert!((0.45..0.55).contains(&share), "{share}");
}

#[test]
fn alignment_finds_the_same_however_the_armband_is_turned_and_its_openings_are_not_scored() {
    let folder = folder("evaluate-aligned");
    recordings(&folder);
    let file = folder.join("one.intent");
    model(&file, &[], Vocabulary::Three);
    let with = |places, align| {
        let selection = Selection {
            worn: Worn {
                turn: Turn::By(places),
                mirrored: false,
            },
            align,
            ..Selection::default()
        };
        evaluated(&folder, &file, &selection)
    };
    let (plain, straight, turned) = (with(0, false), with(0, true), with(3, true));
    let names: Vec<_> = straight
        .candidates
        .iter()
        .map(|own| &own.name[..])
        .collect();
    assert_eq!(
        names,
        ["one", "one, aligned", "constant relax", "energy detector"]
    );
    assert_eq!(straight.results.alignments.len(), 4);
    assert_eq!(straight.results.alignments, turned.results.alignments);
    let aligned = straight.results.alignments.iter();
    assert!(aligned.clone().any(|own| own.outcome == "aligned"));
    // As the logits are, where an alignment was found.
    for (at, recording) in straight.recordings.iter().enumerate() {
        let mut found = aligned.clone().filter(|own| own.outcome == "aligned");
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
    let text = folder.join("people.csv");
    assert!(evaluate(
        &folder,
        &[
            "--model",
            file.to_str().unwrap(),
            "--rotate",
            "any",
            "--mirror",
            "--align"
        ]
    ));
    assert!(fs::read_to_string(text).unwrap().contains("one, aligned"));
}

#[test]
fn an_alignment_that_is_told_the_arm_takes_no_placement_on_the_other_one() {
    let folder = folder("evaluate-arm-told");
    recordings(&folder);
    let file = folder.join("one.intent");
    model(&file, &[], Vocabulary::Three);
    // And a template whose electrodes run the other way round: one of the two is on the wrong arm.
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
            let results = evaluated(&folder, &file, &selection).results;
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
    let data = folder.join("data");
    let made = |seen: &[&str]| {
        let file = folder.join("bare.intent");
        model(&file, seen, Vocabulary::Three);
        let bare = Model::with_template(&fs::read(&file).unwrap(), None).unwrap();
        fs::write(&file, &bare).unwrap();
        let arguments = [
            "template",
            file.to_str().unwrap(),
            "--data",
            data.to_str().unwrap(),
        ];
        let done = myointent(&arguments);
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

#[test]
fn a_page_of_several_compares_them_over_the_people_whom_both_have_not_seen() {
    let folder = folder("report-several");
    recordings(&folder);
    let seen: [(&str, &[&str]); 2] = [
        ("a.intent", &["synthetic/s1"]),
        ("b.intent", &["synthetic/s2"]),
    ];
    for (name, seen) in seen {
        model(&folder.join(name), seen, Vocabulary::Three);
    }
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (a, b, data, page) = (
        path("a.intent"),
        path("b.intent"),
        path("data"),
        path("page.html"),
    );
    let report = |models: &[&str]| {
        let mut line = vec!["report", "--data", &data, "--out", &page];
        line.extend(models);
        myointent(&line)
    };
    assert!(report(&[&a, &b]));
    let text = fs::read_to_string(&page).unwrap();
    // Each has three people; s3 and s4 are of both.
    assert!(text.contains("a on 3 subjects, b on 3 subjects"));
    let row = text
        .split("<tr>")
        .find(|row| row.contains("b - a"))
        .unwrap();
    assert!(row.contains(" n 2, no difference shown"), "{row}");
    // Floors over other people are other floors.
    assert!(text.contains("energy detector (b)"));
    for section in [
        "Results",
        "People",
        "Errors",
        "Recordings",
        "Cost on a board",
    ] {
        assert!(text.contains(&format!("<h2>{section}</h2>")), "{section}");
    }
    // Worst and best of each.
    assert_eq!(text.matches("EMG and labels: ").count(), 4);
    assert!(!text.contains("<script") && !text.contains("http"));

    // The same file twice has two names, and nothing to compare.
    assert!(report(&[&a, &a]));
    let text = fs::read_to_string(&page).unwrap();
    let row = text
        .split("<tr>")
        .find(|row| row.contains("a (2) - a"))
        .unwrap();
    assert!(row.contains("+0.000 n 3"), "{row}");

    let six = path("six.intent");
    model(Path::new(&six), &[], Vocabulary::Six);
    assert!(!report(&[&a, &six]));
    assert!(!myointent(&["report", &a, "--out", &page]));
    assert!(!report(&[&a, &a, &a, &a, &a, &a]));
}

#[test]
fn a_model_tuned_on_the_only_person_is_reported_and_said_to_have_seen_them() {
    let folder = folder("report-own");
    recordings(&folder);
    let everybody = [
        "synthetic/s1",
        "synthetic/s2",
        "synthetic/s3",
        "synthetic/s4",
    ];
    model(&folder.join("own.intent"), &everybody, Vocabulary::Three);
    model(
        &folder.join("part.intent"),
        &everybody[..1],
        Vocabulary::Three,
    );
    model(&folder.join("shipped.intent"), &[], Vocabulary::Three);
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (data, page) = (path("data"), path("page.html"));
    let report = |models: &[&str], more: &[&str]| {
        let models: Vec<String> = models.iter().map(|name| path(name)).collect();
        let mut line = vec!["report", "--data", &data, "--out", &page];
        line.extend(models.iter().map(String::as_str));
        line.extend(more);
        assert!(myointent(&line), "{line:?}");
        fs::read_to_string(&page).unwrap()
    };
    let unseen = "people whom it has not seen";
    for more in [&[][..], &["--seen"]] {
        let text = report(&["own.intent", "shipped.intent"], more);
        assert!(!text.contains(unseen), "{more:?}");
        assert!(text.contains("own (has seen them) on 4 subjects, shipped on 4 subjects"));
        // In tables, differences and pictures too.
        let row = |cell: &str| text.split("<tr>").any(|row| row.contains(cell));
        assert!(row("<td>own (has seen them)</td>") && row("shipped - own (has seen them)"));
        assert!(text.contains("seen in training"));
    }
    let alone = report(&["own.intent"], &[]);
    assert!(alone.contains("own (has seen them) on 4 subjects"));
    let text = report(&["part.intent", "shipped.intent"], &["--seen"]);
    assert!(text.contains("part (has seen 1 of 4) on 4 subjects") && !text.contains(unseen));
    let text = report(&["part.intent", "shipped.intent"], &[]);
    assert!(text.contains("part on 3 subjects") && text.contains(unseen));

    // `evaluate` marks a model in the same words.
    let [own, shipped] = ["own.intent", "shipped.intent"].map(path);
    assert!(evaluate(
        &folder,
        &["--model", &own, "--model", &shipped, "--seen"]
    ));
    let text = fs::read_to_string(&page).unwrap();
    assert!(text.contains("<td>own (has seen them)</td>") && !text.contains("shipped (has seen"));
}

#[test]
fn json_names_models_people_and_scores() {
    let folder = folder("evaluate-json");
    recordings(&folder);
    let file = folder.join("one.intent");
    model(&file, &["synthetic/s1"], Vocabulary::Three);
    let evaluation = evaluated(&folder, &file, &Selection::default());
    let json = serde_json::to_value(&evaluation.results).unwrap();
    assert_eq!(json["left_out_seen"][0], "synthetic/s1");
    assert_eq!(json["subjects"].as_array().unwrap().len(), 3);
    assert_eq!(json["models"][0]["seed"], 5);
    assert_eq!(json["scores"].as_array().unwrap().len(), 3);
}

/// Rest, open, rest, scissors, rest, close, again and again; the muscle follows each cue after another time about `late`.
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

/// Writes the same recordings as somebody's own csv files, a folder a person.
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

/// The lag-compensated labels of each recording.
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
    // The cues are followed 40 to 80 samples late by those who are trained on.
    assert!((35..=85).contains(&lag), "{lag}");
    assert_eq!(first_open(&people[..3]) - 400, lag);
}
