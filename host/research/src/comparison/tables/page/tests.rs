//! The page of small studies.

use super::*;
use crate::comparison::results::fixture::{Fixture, score};

/// Two folds of one subject each, with teacher, integer student and LDA.
fn small() -> Fixture {
    let fixture = Fixture::new();
    for (number, subject) in [
        (1, score("roshambo/01", 0.9, &[0, 10], 2)),
        (2, score("ss-stm/sub2", 0.7, &[40], 2)),
    ] {
        let fold = fixture.fold("main", number, 2).score(subject);
        fold.model("integer student", true)
            .model("LDA", false)
            .write();
    }
    fixture
}

fn sheet<'a>(page: &'a Page, name: &str) -> &'a Sheet {
    page.sheets().find(|sheet| sheet.name == name).unwrap()
}

#[test]
fn the_main_table_has_every_subject_once_and_baselines_first() {
    let page = page(&small().study());
    let expected = "\
## Main results, 3 classes, lag-compensated labels

All models on the held-out subjects.

| model           |       look-ahead | roshambo balanced | roshambo TA | roshambo recognised | roshambo raw | roshambo n | ss-stm balanced | ss-stm TA | ss-stm recognised | ss-stm raw | ss-stm n | pooled balanced | pooled TA | pooled recognised |   pooled raw | pooled n |
| --------------- | ---------------: | ----------------: | ----------: | ------------------: | -----------: | ---------: | --------------: | --------: | ----------------: | ---------: | -------: | --------------: | --------: | ----------------: | -----------: | -------: |
| LDA             |                0 |             0.900 |       1.000 |               1.000 |        0.900 |      1 / 2 |           0.700 |     0.500 |             0.500 |      0.700 |    1 / 2 |           0.800 |     0.750 |             0.750 | 0.800 (0.14) |    2 / 4 |
| teacher         |                0 |             0.900 |       1.000 |               1.000 |        0.900 |      1 / 2 |           0.700 |     0.500 |             0.500 |      0.700 |    1 / 2 |           0.800 |     0.750 |             0.750 | 0.800 (0.14) |    2 / 4 |
| integer student |                0 |             0.900 |       1.000 |               1.000 |        0.900 |      1 / 2 |           0.700 |     0.500 |             0.500 |      0.700 |    1 / 2 |           0.800 |     0.750 |             0.750 | 0.800 (0.14) |    2 / 4 |
| LDA             | 0.25 s, all rows |                 - |           - |                   - |            - |          - |               - |         - |                 - |          - |        - |               - |         - |                 - |            - |        - |
| teacher         | 0.25 s, all rows |             0.900 |       1.000 |               1.000 |        0.900 |      1 / 2 |           0.700 |     0.500 |             0.500 |      0.700 |    1 / 2 |           0.800 |     0.750 |             0.750 | 0.800 (0.14) |    2 / 4 |
| integer student | 0.25 s, all rows |             0.900 |       1.000 |               1.000 |        0.900 |      1 / 2 |           0.700 |     0.500 |             0.500 |      0.700 |    1 / 2 |           0.800 |     0.750 |             0.750 | 0.800 (0.14) |    2 / 4 |

- `main`: preset quickstart, seed 42, revision abc; 2 of 2 folds; trained on 1 subjects; 2 subjects held out
- every number: main-lag-compensated.csv
";
    assert_eq!(sheet(&page, "main-lag-compensated").markdown(), expected);
    let csv = String::from_utf8(sheet(&page, "main-published").csv().unwrap()).unwrap();
    let last = csv.lines().last().unwrap();
    let start = "integer student,\"0.25 s, all rows\",0.900,,,,1.000,,,,1.000,,,,0.900,,1,2,\
        0.700,,,,0.500,,,,0.500,,,,0.700,,1,2,\
        0.800,0.14,,,0.750,0.35,,,0.750,0.35,,,0.800,0.14,2,4,";
    assert!(last.starts_with(start), "{last}");
}

#[test]
fn a_missing_variant_leaves_the_command_that_would_fill_its_place() {
    let page = page(&small().study());
    let text = page.markdown();
    for line in [
        "## Main results, 4 or 5 classes\n\nMissing: run `myointent-research study --variant wrist` (wrist intents",
        "## Pre-training ablation, 3 classes\n\nMissing: run `myointent-research study --variant scratch`",
        "`myointent-research study --variant lora` (the pre-trained teacher, fine-tuned on roshambo with LoRA).",
        "## Window length of the teacher, 3 classes\n\nMissing: run `myointent-research study --variant window-100`",
    ] {
        assert!(text.contains(line), "{line:?} is missing in\n{text}");
    }
    let names: Vec<&str> = page.sheets().map(|sheet| sheet.name.as_str()).collect();
    let expected = [
        "main-lag-compensated",
        "main-published",
        "events-lag-compensated",
        "events-published",
        "offsets-lag-compensated",
        "offsets-published",
        "buffer-lag-compensated",
        "buffer-published",
        "differences-lag-compensated",
        "differences-published",
        "folds",
    ];
    assert_eq!(names, expected);
}

#[test]
fn an_ablation_has_a_row_per_variant_and_names_the_missing_ones() {
    let fixture = small();
    for name in ["scratch", "lora", "window-50", "window-300"] {
        fixture.fold(name, 1, 1).held_out("roshambo/01").write();
    }
    let page = page(&fixture.study());
    let labels = |name: &str| {
        let rows = &sheet(&page, name).rows;
        let half = rows[..rows.len() / 2].iter();
        half.map(|row| row.cells[0].shown.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(labels("pre-training-lag-compensated"), ["scratch", "lora"]);
    assert_eq!(labels("window-published"), ["50", "300", "600"]);
    let missing = &sheet(&page, "window-lag-compensated").warnings;
    assert!(missing[0].contains("--variant window-100`"), "{missing:?}");
    let sources: Vec<&str> = sheet(&page, "window-lag-compensated")
        .rows
        .iter()
        .map(|row| &row.source[..12])
        .collect();
    assert_eq!(sources[1..3], ["`window-300`", "`main`: pres"]);
}

#[test]
fn students_of_several_sizes_have_a_table_of_their_own() {
    let fixture = Fixture::new();
    for name in ["student-128x3", "student-64x2"] {
        let fold = fixture.fold(name, 1, 1).held_out("roshambo/01");
        fold.model("integer student", true).write();
    }
    let page = page(&fixture.study());
    let rows = &sheet(&page, "sizes-lag-compensated").rows;
    let of = |column: usize| rows.iter().map(move |row| row.cells[column].shown.as_str());
    assert_eq!(
        of(0).collect::<Vec<_>>(),
        ["64x2", "128x3", "64x2", "128x3"]
    );
    assert_eq!(of(1).nth(2), Some("0.25 s, all rows"));
}

#[test]
fn a_variant_of_another_name_gets_a_table_of_its_own() {
    let fixture = small();
    fixture.fold("narrow", 1, 1).held_out("ss-stm/sub2").write();
    let page = page(&fixture.study());
    assert_eq!(sheet(&page, "variant-narrow-lag-compensated").rows.len(), 2);
    let title = &sheet(&page, "variant-narrow-published").title;
    assert_eq!(title, "Variant `narrow`, labels as published");
}

#[test]
fn missing_folds_mark_the_title_of_every_table() {
    let fixture = Fixture::new();
    fixture.fold("main", 2, 3).held_out("roshambo/01").write();
    let page = page(&fixture.study());
    for sheet in page.sheets().filter(|sheet| sheet.name != "folds") {
        assert!(
            sheet.title.ends_with("(`main`: 1 of 3 folds)"),
            "{}",
            sheet.title
        );
        assert!(
            sheet
                .markdown()
                .contains("**Note:** `main` has 1 of 3 folds: 1, 3 missing")
        );
    }
}

#[test]
fn the_appendix_names_every_held_out_subject() {
    let page = page(&small().study());
    let rows = &sheet(&page, "folds").rows;
    let last = |row: usize| rows[row].cells.last().unwrap().shown.as_str();
    assert_eq!((last(0), last(1)), ("roshambo/01", "ss-stm/sub2"));
}
