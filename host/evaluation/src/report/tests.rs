//! Tables and a page of synthetic recordings, checked as a whole.

mod one_person;
mod shown;

use std::collections::BTreeMap;
use std::{error::Error, fs};

use shared::intent::{Intent, Vocabulary};
use shared::model::LookBackLogits;

use super::entry::Entry;
use super::page::Page;
use super::pictures::charts::Panel;
use super::pictures::stand_alone;
use super::pictures::timeline::{Timeline, svg};
use super::row::Row;
use super::scores::{summary, tables};
use crate::results::Results;
use crate::{
    CONSTANT, Candidate, ENERGY, EnergyDetector, EvaluatedRecording, LookAhead, System, Truth,
    constant, score_all,
};

/// Recordings, a model that sees each change of their labels after 100 ms, and the results of the model and the floors.
const INTEGER: &str = "integer student";

struct Evaluated {
    recordings: Vec<EvaluatedRecording>,
    model: Candidate,
    results: Results,
}

impl Evaluated {
    fn new(recordings: Vec<EvaluatedRecording>) -> Self {
        let logits = recordings.iter().map(|recording| {
            let rows = |patch: usize| {
                let mut rows = LookBackLogits::default();
                for (back, row) in rows.iter_mut().enumerate() {
                    let at = (patch * 10).saturating_sub(back * 10 + 20);
                    row[recording.lag_compensated[at].map_or(0, Intent::class)] = 1.0;
                }
                rows
            };
            (0..recording.emg.len() / 10).map(rows).collect()
        });
        let model = Candidate::without_margins(System::Integer, true, logits.collect());
        let detector = EnergyDetector::fit(&recordings)
            .unwrap()
            .candidate(&recordings);
        let candidates = [model.clone(), constant(&recordings), detector];
        let scores = |truths: &[Truth]| {
            score_all(&candidates, &recordings, Vocabulary::Three, truths).unwrap()
        };
        let results = Results {
            held_out: Vec::new(),
            aggregation: LookAhead::SameInstant,
            gestures: BTreeMap::new(),
            published: scores(&[Truth::Published, Truth::LagCompensated]),
        };
        Self {
            recordings,
            model,
            results,
        }
    }

    fn entry(&self) -> Entry<'_> {
        let look_ahead = LookAhead::SameInstant;
        let own = self.results.published.iter();
        let own = own
            .filter(|own| own.truth == Truth::LagCompensated)
            .map(Row::new);
        let (floors, scores): (Vec<_>, Vec<_>) = own.partition(|own| own.model.is_floor());
        let points = |end: f64| {
            (0..60)
                .map(|at| (f64::from(at), end + (-f64::from(at) / 12.0).exp()))
                .collect()
        };
        let curve = |name: &str, end| (name.to_owned(), points(end));
        Entry {
            name: "student".to_owned(),
            facts: Vec::new(),
            scores: scores
                .into_iter()
                .filter(|score| score.look_ahead == look_ahead)
                .collect(),
            beside: Vec::new(),
            floors,
            recordings: &self.recordings,
            candidate: &self.model,
            vocabulary: Vocabulary::Three,
            look_ahead,
            panels: vec![Panel {
                title: "Loss".to_owned(),
                axis: "epoch",
                curves: vec![curve("training", 0.3), curve("validation", 0.42)],
            }],
        }
    }
}

/// Two people, who close their hand twice.
fn two_people() -> Evaluated {
    let people = ["synthetic/a", "synthetic/b"];
    let recordings = people.map(|who| EvaluatedRecording::made_up(who, &[0, 2, 0, 2, 0]));
    Evaluated::new(recordings.to_vec())
}

/// Two people of three classes with onsets, one with holds alone, and one who never opens the hand.
fn four_people() -> Evaluated {
    let mut recordings = vec![
        EvaluatedRecording::made_up("synthetic/a", &[0, 1, 0, 2, 0]),
        EvaluatedRecording::made_up("synthetic/b", &[0, 2, 0, 1, 0]),
        EvaluatedRecording::made_up("synthetic/d", &[0, 2, 0, 2, 0]),
    ];
    recordings.extend([0, 1, 2].map(|class| EvaluatedRecording::made_up("synthetic/c", &[class])));
    Evaluated::new(recordings)
}

/// Page with something in every part.
fn page<'a>(evaluated: &Evaluated, entries: &'a [Entry<'a>]) -> Page<'a> {
    let mut tables = tables(&evaluated.results, true);
    Page {
        title: "Intent detection on four people".to_owned(),
        summary: "Of \"synthetic\" <EMG>.".to_owned(),
        entries,
        people_tables: tables.split_off(3),
        more_tables: tables.split_off(2),
        tables,
        provenance: vec![(
            "A group".to_owned(),
            vec![("data".to_owned(), "synthetic".to_owned())],
        )],
        notes: vec!["Every number on this page is synthetic.".to_owned()],
    }
}

/// Whether every tag is closed in order, but `meta`, which never closes.
fn well_formed(markup: &str) -> Result<(), String> {
    let mut open: Vec<&str> = Vec::new();
    for piece in markup.split('<').skip(1) {
        let (tag, text) = piece
            .split_once('>')
            .ok_or_else(|| format!("unclosed <{piece}"))?;
        if text.contains('>') {
            return Err(format!("stray > after <{tag}>"));
        }
        if tag.starts_with('!') || tag.starts_with("meta ") {
            continue;
        }
        let name = tag.split_whitespace().next().unwrap_or_default();
        match name.strip_prefix('/') {
            None => open.push(name),
            Some(closed) if open.last() == Some(&closed) => {
                open.pop();
            }
            Some(closed) => return Err(format!("</{closed}> closes {open:?}")),
        }
    }
    if open.is_empty() {
        Ok(())
    } else {
        Err(format!("never closed: {open:?}"))
    }
}

#[test]
fn a_report_is_well_formed_and_whole_and_needs_nothing_from_elsewhere() -> Result<(), Box<dyn Error>>
{
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("report.html");
    let evaluated = four_people();
    let entries = [evaluated.entry()];
    page(&evaluated, &entries).write(&path)?;
    let html = fs::read_to_string(&path)?;
    // The temporary file is gone.
    assert_eq!(fs::read_dir(&folder)?.count(), 1);
    well_formed(&html)?;
    // Overview, recognition, confusion, latencies, a curve; the three people who have all classes.
    assert_eq!(html.matches("<svg").count(), 8);
    // The page's, and one for every picture.
    assert_eq!(html.matches("<title>").count(), 9);
    let parts = "<!DOCTYPE html>|student|Confusion matrix|median|Loss|Every number on this page is synthetic.|energy detector|\
                 with all 3 classes";
    for part in parts.split('|') {
        assert!(html.contains(part), "{part} is missing");
    }
    // Nothing is from elsewhere.
    for reference in "http: https: src= url( @import <script <link".split(' ') {
        assert!(!html.contains(reference), "{reference}");
    }
    // The contents refer to sections of the page itself.
    for link in html.split("href=\"").skip(1) {
        let id = link
            .strip_prefix('#')
            .and_then(|rest| rest.split('"').next());
        let id = id.expect("a place on this page");
        assert!(html.contains(&format!("<section id=\"{id}\">")), "{id}");
    }
    Ok(())
}

#[test]
fn text_is_escaped_on_the_page_and_in_pictures() -> Result<(), Box<dyn Error>> {
    let hostile = "<script>alert('&')</script>";
    let evaluated = Evaluated::new(vec![EvaluatedRecording::made_up(hostile, &[0, 1, 0, 2, 0])]);
    let entry = || {
        let mut entry = evaluated.entry();
        entry.name = hostile.into();
        entry.scores[0].name = hostile.into();
        entry.panels[0].title = hostile.into();
        entry.panels[0].curves[0].0 = hostile.into();
        entry
    };
    let entries = [entry(), entry()];
    let mut page = page(&evaluated, &entries);
    page.title = hostile.into();
    page.summary = hostile.into();
    page.notes = vec![hostile.into()];
    page.tables[0].caption = hostile.into();
    page.tables[0].header[0] = hostile.into();
    page.tables[0].rows[0][0] = hostile.into();
    page.provenance = vec![(hostile.into(), vec![(hostile.into(), hostile.into())])];
    let html = page.html()?;
    assert!(!html.contains("<script"));
    assert!(html.matches("&lt;script&gt;alert").count() > 20);
    well_formed(&html)?;
    Ok(())
}

#[test]
fn an_empty_report_is_a_page_too() -> Result<(), Box<dyn Error>> {
    let html = Page::default().html()?;
    well_formed(&html)?;
    assert!(!html.contains("<h2>"));
    let nobody = two_people();
    let mut entry = nobody.entry();
    entry.recordings = &[];
    entry.scores.clear();
    entry.floors.clear();
    entry.panels.clear();
    let html = Page {
        entries: &[entry],
        ..Page::default()
    }
    .html()?;
    well_formed(&html)?;
    // No errors but a matrix of zeros.
    assert_eq!(html.matches("<h2>").count(), 1);
    Ok(())
}

#[test]
fn the_picture_alone_names_its_language_and_carries_its_style() -> Result<(), Box<dyn Error>> {
    let timeline = Timeline {
        subject: "a\u{1}b",
        emg: &[[3; 8]; 400],
        truth: &[Some(Intent::Relax); 400],
        ..Timeline::default()
    };
    let svg = stand_alone(&svg(&timeline));
    assert!(svg.starts_with("<svg xmlns="));
    assert!(svg.contains("<style>") && svg.contains("a b"));
    well_formed(&svg)?;
    Ok(())
}

#[test]
fn a_report_that_cannot_be_written_says_where() {
    let missing = std::env::temp_dir().join("myointent-no-such-folder/report.html");
    let error = Page::default().write(&missing).unwrap_err();
    assert!(error.to_string().contains("myointent-no-such-folder"));
}

#[test]
fn every_column_has_its_own_number_of_people_and_two_class_people_stand_apart() {
    for table in tables(&four_people().results, true) {
        let column = |name: &str| table.header.iter().position(|own| own == name);
        let (classes, model) = (column("classes").unwrap(), column("model"));
        let Some(model) = model else {
            // Differences say their number of people in each cell.
            let found: Vec<&str> = table.rows.iter().map(|row| &row[classes][..]).collect();
            let both = found.contains(&"all 3") && found.contains(&"fewer");
            assert!(both, "{table:?}");
            continue;
        };
        for name in [INTEGER, CONSTANT, ENERGY] {
            let rows: Vec<_> = table.rows.iter().filter(|row| row[model] == name).collect();
            let all = rows.iter().find(|row| row[classes] == "all 3").unwrap();
            let fewer = rows.iter().find(|row| row[classes] == "fewer").unwrap();
            let people = column("subjects").unwrap();
            assert_eq!([&all[people], &fewer[people]], ["3", "1"], "{table:?}");
            for name in ["TA", "recognised", "decided", "latency ms"] {
                if let Some(at) = column(name) {
                    assert!(all[at].ends_with("n 2"), "{name}: {all:?}");
                    assert!(!fewer[at].contains("n 1"), "{name}: {fewer:?}");
                }
            }
            if let Some(at) = column("balanced") {
                assert!(!all[at].contains('n'), "{all:?}");
            }
        }
    }
    let table = summary(&four_people().results);
    let names = ["synthetic", "synthetic: relax", "synthetic: energy"];
    let groups = ["all 3", "fewer"];
    let expected: Vec<_> = names
        .iter()
        .flat_map(|name| groups.map(|group| [*name, group]))
        .collect();
    let found = table.rows.iter().map(|row| [&row[0][..], &row[1]]);
    assert_eq!(found.collect::<Vec<_>>(), expected);
    assert!(
        table.rows[0][3].ends_with("n 2") && table.rows[0][7] == "3",
        "{table:?}"
    );
}

#[test]
fn every_table_of_scores_has_its_floors_and_the_differences_to_them() {
    let tables = tables(&two_people().results, true);
    let found: Vec<Vec<&str>> = tables
        .iter()
        .map(|table| table.rows.iter().map(|row| row[2].as_str()).collect())
        .collect();
    // Rows without look-ahead and with the model file's.
    let scores = vec![INTEGER, INTEGER, CONSTANT, ENERGY];
    let constant = format!("{INTEGER} - {CONSTANT}");
    let energy = format!("{INTEGER} - {ENERGY}");
    let differences = vec![constant.as_str(), &energy, &constant, &energy];
    let expected = [scores.clone(), differences, scores.clone(), scores];
    assert_eq!(found, expected);
    let cells = |table: usize, row: usize| tables[table].rows[row][4..].to_vec();
    let floor = &cells(0, 2);
    // Relax and close: the recall of relax is 1.
    assert_eq!(floor[0], "0.500");
    let rates = ["0.0 (0.0)", "0.0 (0.0)"];
    assert_eq!(floor[2..6], ["0.000", "0.000", ">50 % missed", "-"]);
    assert_eq!(floor[6..9], [rates[0], "1.000 (0.00)", rates[1]]);
    assert_eq!(cells(0, 1)[2], "1.000");
    assert_eq!(cells(1, 2)[2], "+1.000 n 2, no difference shown");
}
