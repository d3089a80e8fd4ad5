use super::*;
use crate::comparison::fixture::{Fixture, score};

/// Two folds of one person each; the integer student is judged beside the teacher.
fn small() -> Fixture {
    let fixture = Fixture::new();
    for (number, person) in [
        (1, score("roshambo/01", 0.9, &[0, 10], 2)),
        (2, score("ss-stm/sub2", 0.7, &[40], 2)),
    ] {
        let fold = fixture.fold("main", number, 2).score(person);
        fold.model("integer student", true)
            .model("LDA", false)
            .write();
    }
    fixture
}

fn sheet<'a>(tables: &'a Tables, name: &str) -> &'a Sheet {
    tables.sheets().find(|sheet| sheet.name == name).unwrap()
}

#[test]
fn the_main_table_shows_every_person_once_peers_first() {
    let tables = tables(&small().study());
    let expected = "\
## Main results, 3 classes, labels moved

All models on the people left out.

| model           |       look-ahead | roshambo raw | roshambo TA | roshambo n | ss-stm raw | ss-stm TA | ss-stm n |   pooled raw |    pooled TA | pooled n |
| --------------- | ---------------: | -----------: | ----------: | ---------: | ---------: | --------: | -------: | -----------: | -----------: | -------: |
| LDA             |                0 |        0.900 |       1.000 |      1 / 2 |      0.700 |     0.500 |    1 / 2 | 0.800 (0.14) | 0.750 (0.35) |    2 / 4 |
| teacher         |                0 |        0.900 |       1.000 |      1 / 2 |      0.700 |     0.500 |    1 / 2 | 0.800 (0.14) | 0.750 (0.35) |    2 / 4 |
| integer student |                0 |        0.900 |       1.000 |      1 / 2 |      0.700 |     0.500 |    1 / 2 | 0.800 (0.14) | 0.750 (0.35) |    2 / 4 |
| LDA             | 0.25 s, all rows |            - |           - |          - |          - |         - |        - |            - |            - |        - |
| teacher         | 0.25 s, all rows |        0.900 |       1.000 |      1 / 2 |      0.700 |     0.500 |    1 / 2 | 0.800 (0.14) | 0.750 (0.35) |    2 / 4 |
| integer student | 0.25 s, all rows |        0.900 |       1.000 |      1 / 2 |      0.700 |     0.500 |    1 / 2 | 0.800 (0.14) | 0.750 (0.35) |    2 / 4 |

- `main`: preset quickstart, seed 42, revision abc; 2 of 2 folds; trained on 1 subjects; 2 subjects left out
- numbers one by one: main-moved.csv
";
    assert_eq!(sheet(&tables, "main-moved").markdown(), expected);
    let csv = String::from_utf8(sheet(&tables, "main-published").csv().unwrap()).unwrap();
    let last = csv.lines().last().unwrap();
    let start = "integer student,\"0.25 s, all rows\",0.900,,1.000,,1,2,0.700,,0.500,,1,2,0.800,0.14,0.750,0.35,2,4,";
    assert!(last.starts_with(start), "{last}");
}

#[test]
fn variants_that_are_not_there_leave_a_line_that_says_what_would_fill_it() {
    let tables = tables(&small().study());
    let page = tables.markdown();
    for line in [
        "## Main results, 4 or 5 classes\n\nNot there: `myointent study --variant wrist` (the wrist's",
        "## Pre-training ablation, 3 classes\n\nNot there: `myointent study --variant scratch`",
        "`myointent study --variant lora` (that teacher, fine-tuned on roshambo with LoRA) would fill it.",
        "## Window of the teacher, 3 classes\n\nNot there: `myointent study --variant window-100`",
    ] {
        assert!(page.contains(line), "{line:?} is missing in\n{page}");
    }
    let names: Vec<&str> = tables.sheets().map(|sheet| sheet.name.as_str()).collect();
    let expected = [
        "main-moved",
        "main-published",
        "offsets-moved",
        "offsets-published",
        "buffer-moved",
        "buffer-published",
        "ours-moved",
        "ours-published",
        "folds",
    ];
    assert_eq!(names, expected);
}

#[test]
fn an_ablation_has_a_row_for_each_variant_and_tells_of_the_others() {
    let fixture = small();
    for name in ["scratch", "lora", "window-50", "window-300"] {
        fixture.fold(name, 1, 1).left_out("roshambo/01").write();
    }
    let tables = tables(&fixture.study());
    let labels = |name: &str| {
        let rows = &sheet(&tables, name).rows;
        let half = rows[..rows.len() / 2].iter();
        half.map(|row| row.cells[0].shown.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(labels("pre-training-moved"), ["scratch", "lora"]);
    assert_eq!(labels("window-published"), ["50", "300", "600"]);
    let missing = &sheet(&tables, "window-moved").warnings;
    assert!(missing[0].contains("--variant window-100`"), "{missing:?}");
    let sources: Vec<&str> = sheet(&tables, "window-moved")
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
        let fold = fixture.fold(name, 1, 1).left_out("roshambo/01");
        fold.model("integer student", true).write();
    }
    let tables = tables(&fixture.study());
    let rows = &sheet(&tables, "sizes-moved").rows;
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
    fixture.fold("narrow", 1, 1).left_out("ss-stm/sub2").write();
    let tables = tables(&fixture.study());
    assert_eq!(sheet(&tables, "variant-narrow-moved").rows.len(), 2);
    let title = &sheet(&tables, "variant-narrow-published").title;
    assert_eq!(title, "Outcome `narrow`, labels as published");
}

#[test]
fn missing_folds_mark_the_title_of_every_table() {
    let fixture = Fixture::new();
    fixture.fold("main", 2, 3).left_out("roshambo/01").write();
    let tables = tables(&fixture.study());
    for sheet in tables.sheets().filter(|sheet| sheet.name != "folds") {
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
fn the_appendix_names_everybody_left_out() {
    let tables = tables(&small().study());
    let rows = &sheet(&tables, "folds").rows;
    let last = |row: usize| rows[row].cells.last().unwrap().shown.as_str();
    assert_eq!((last(0), last(1)), ("roshambo/01", "ss-stm/sub2"));
}
