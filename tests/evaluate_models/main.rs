//! Model files evaluated on any recordings, by the command line, on recordings of one person a file.

#[path = "../small.rs"]
mod small;

#[path = "../live/browser.rs"]
#[expect(dead_code, reason = "a page without keys")]
mod browser;
mod frame;
mod placement;

use std::fs;
use std::path::{Path, PathBuf};

use evaluation::model_evaluation::{ModelEvaluation, NamedModel, Selection, evaluate_models};
use myointent_tests::small_model as model;
use recordings::{LoadOptions, load};
use shared::intent::Vocabulary;
use small::{folder, in_folder, recordings};

/// Makes a folder of a test, with recordings in `data` and a small model, `one.intent`, that has seen these people.
fn with_model(test: &str, seen: &[&str]) -> PathBuf {
    let folder = folder(test);
    recordings(&folder);
    model(&folder.join("one.intent"), seen, Vocabulary::Three);
    folder
}

/// Evaluates models, which begin the words.
fn evaluate(folder: &Path, models: &str) -> bool {
    let line = "evaluate --data @data --csv @people.csv --report @page.html --model";
    in_folder(folder, &format!("{line} {models}"))
}

fn page(folder: &Path) -> String {
    fs::read_to_string(folder.join("page.html")).unwrap()
}

/// Returns subject, model and balanced accuracy of each row of the CSV file.
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
    let folder = with_model("evaluate-seen", &["synthetic/s1", "synthetic/s3"]);
    let with = |more: &str| evaluate(&folder, &format!("@one.intent {more}"));
    assert!(with(""));
    assert_eq!(people(&folder), ["synthetic/s2", "synthetic/s4"]);
    assert!(with("--seen"));
    assert_eq!(people(&folder).len(), 4);
    let text = fs::read_to_string(folder.join("people.csv")).unwrap();
    let marked = text
        .lines()
        .filter(|line| line.ends_with("seen in training by one"));
    // Both people have a row under the model, the constant and the energy detector.
    assert_eq!(marked.count(), 6);
    assert!(with("--subjects synthetic/s1"));
    assert_eq!(people(&folder), ["synthetic/s1"]);
    assert!(!with("--subjects synthetic/s9"));
    let evaluation = evaluated(&folder, &Selection::default());
    let json = serde_json::to_value(&evaluation.results).unwrap();
    assert_eq!(
        (&json["left_out_seen"][0], &json["models"][0]["seed"]),
        (&"synthetic/s1".into(), &5.into())
    );
}

#[test]
fn several_models_and_the_floors_stand_side_by_side_and_the_page_begins_with_the_worst() {
    let folder = folder("evaluate-several");
    recordings(&folder);
    for file in ["a.intent", "b.intent"] {
        model(&folder.join(file), &[], Vocabulary::Three);
    }
    assert!(evaluate(&folder, "@a.intent --model @b.intent"));
    let rows = rows(&folder);
    let of = |model: &str| -> Vec<f64> {
        let own = rows.iter().filter(|(_, name, _)| name == model);
        own.map(|(_, _, balanced)| *balanced).collect()
    };
    assert_eq!(of("a"), of("b"));
    assert_eq!(of("a").len(), 4);
    assert!(of("a").is_sorted());
    // Each of three classes is present, and relax is one of them.
    assert_eq!(of("constant relax"), [0.333; 4]);
    assert_eq!(of("energy detector").len(), 4);
    let page = page(&folder);
    let worst = &rows.iter().find(|(_, name, _)| name == "a").unwrap().0;
    let drawn = page.find("EMG and labels: ").unwrap();
    assert!(
        page[drawn..].starts_with(&format!("EMG and labels: {worst}")),
        "{}",
        &page[drawn..drawn + 60]
    );

    // On a phone no table is cut, and of a wide picture it is said that it goes on.
    if let Some(mut browser) = browser::Browser::start(browser::BrowserKind::Chromium) {
        browser.look(390, 844, "light", "no-preference");
        browser.open(&format!("file://{}", folder.join("page.html").display()));
        browser.wait_for("document.readyState === 'complete'");
        let cut = "[...document.querySelectorAll('.wide, .wide td, body')].filter((one) => one.scrollWidth > one.clientWidth + 1).length";
        assert_eq!(browser.value(cut), 0);
        let unsaid = "[...document.querySelectorAll('figure')].filter((one) => one.scrollWidth > one.clientWidth + 1 \
            && !getComputedStyle(one, '::before').content.includes('→')).length";
        assert_eq!(browser.value(unsaid), 0);
        let tiny = "[...document.querySelectorAll('svg text')].filter((one) => one.getBoundingClientRect().height < 7).length";
        assert_eq!(browser.value(tiny), 0);
    }

    model(&folder.join("six.intent"), &[], Vocabulary::Six);
    assert!(!evaluate(&folder, "@a.intent --model @six.intent"));
}

/// Evaluates the model of a test's folder on its recordings.
fn evaluated(folder: &Path, selection: &Selection) -> ModelEvaluation {
    let models = [NamedModel::read(&folder.join("one.intent")).unwrap()];
    let library = load(&folder.join("data"), &LoadOptions::default()).unwrap();
    evaluate_models(&models, &library, selection).unwrap()
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
    let report = |models: &str| {
        let line = format!("report --data @data --out @page.html {models}");
        in_folder(&folder, &line)
    };
    assert!(report("@a.intent @b.intent"));
    let text = page(&folder);
    // Each has three people; s3 and s4 are of both.
    assert!(text.contains("a on 3 subjects, b on 3 subjects"));
    let row = text
        .split("<tr>")
        .find(|row| row.contains("b - a"))
        .unwrap();
    assert!(row.contains(" n 2, no difference shown"), "{row}");
    // The floors of other people are other floors.
    assert!(text.contains("energy detector (b)"));
    for section in ["Results", "People", "Errors", "Recordings"] {
        assert!(text.contains(&format!("<h2>{section}</h2>")), "{section}");
    }
    // The report draws the worst and the best recording of each.
    assert_eq!(text.matches("EMG and labels: ").count(), 4);
    assert!(!text.contains("<script") && !text.contains("http"));

    // Two copies of one file have two names, and no difference.
    assert!(report("@a.intent @a.intent"));
    let text = page(&folder);
    let row = text
        .split("<tr>")
        .find(|row| row.contains("a (2) - a"))
        .unwrap();
    assert!(row.contains("+0.000 n 3"), "{row}");

    model(&folder.join("six.intent"), &[], Vocabulary::Six);
    assert!(!report("@a.intent @six.intent"));
    assert!(!in_folder(&folder, "report @a.intent --out @page.html"));
    assert!(!report(&"@a.intent ".repeat(6)));
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
    let report = |models: &str, more: &str| {
        let line = format!("report --data @data --out @page.html {models} {more}");
        assert!(in_folder(&folder, &line), "{line}");
        page(&folder)
    };
    let unseen = "people whom it has not seen";
    for more in ["", "--seen"] {
        let text = report("@own.intent @shipped.intent", more);
        assert!(!text.contains(unseen), "{more:?}");
        assert!(text.contains("own (has seen them) on 4 subjects, shipped on 4 subjects"));
        // Marks are in tables, differences and pictures too.
        let row = |cell: &str| text.split("<tr>").any(|row| row.contains(cell));
        assert!(row(">own (has seen them)</td>") && row("shipped - own (has seen them)"));
        assert!(text.contains("seen in training"));
    }
    let one = report("@own.intent", "--subjects synthetic/s1");
    assert!(one.contains("own (has seen them) on 1 subject, of "));
    let alone = report("@own.intent", "");
    assert!(alone.contains("own (has seen them) on 4 subjects"));
    let text = report("@part.intent @shipped.intent", "--seen");
    assert!(text.contains("part (has seen 1 of 4) on 4 subjects") && !text.contains(unseen));
    let text = report("@part.intent @shipped.intent", "");
    assert!(text.contains("part on 3 subjects") && text.contains(unseen));

    // `evaluate` marks a model in the same words.
    let both = "@own.intent --model @shipped.intent --seen";
    assert!(evaluate(&folder, both));
    let text = page(&folder);
    assert!(text.contains(">own (has seen them)</td>") && !text.contains("shipped (has seen"));
}
