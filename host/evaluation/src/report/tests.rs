//! A report of synthetic numbers, checked as a whole.

use std::{error::Error, fs};

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use shared::intent::{Intent, Vocabulary};
use shared::units::CHANNELS;

use super::curves::{Curve, Panel};
use super::overview::{Kind, Row};
use super::people::{People, Person};
use super::timeline::{Timeline, timeline_svg};
use super::{Confusion, Errors, Headline, ReportData, Table, write_html};

/// Rest and gestures in turn, each with its own muscles; emitted labels 50 to 300 ms late.
fn synthetic_timeline(random: &mut ChaCha8Rng) -> Timeline {
    let mut timeline = Timeline {
        subject: "subject 3".into(),
        recording: "session 1 & <only>".into(),
        look_ahead_samples: 50,
        ..Timeline::default()
    };
    timeline.emitted = vec![None; 599];
    for block in 0..24 {
        let intent = if block % 2 == 0 {
            Intent::Relax
        } else {
            [Intent::Close, Intent::Open][block / 2 % 2]
        };
        let samples = random.random_range(150..400);
        let late = random.random_range(10..60);
        for sample in 0..samples {
            let contraction = if sample < 40 { 0.1 } else { 1.0 };
            timeline.emg.push(std::array::from_fn(|channel| {
                let muscle = match intent {
                    Intent::Relax => 4.0,
                    Intent::Open => 12.0 + 70.0 * f64::from(u8::from(channel < 3)),
                    _ => 12.0 + 60.0 * f64::from(u8::from(channel > 3)),
                };
                (random.random::<f64>() * (4.0 + muscle * contraction)) as u8
            }));
            timeline.truth.push(Some(intent));
            if timeline.truth.len() > 600 + late {
                timeline
                    .emitted
                    .push(timeline.truth[timeline.truth.len() - late]);
            }
        }
    }
    timeline
}

fn synthetic_report() -> ReportData {
    let random = &mut ChaCha8Rng::seed_from_u64(42);
    let mut table = Table::new(
        "Held-out subjects, look-ahead 0.25 s, mean ± SD over subjects",
        [
            "system",
            "raw accuracy",
            "transition accuracy",
            "mean offset",
            "parameters",
        ],
    );
    table.push([
        "teacher",
        "0.83 ± 0.06",
        "0.71 ± 0.12",
        "+142 ms",
        "1 204 000",
    ]);
    table.push([
        "student, float",
        "0.81 ± 0.07",
        "0.68 ± 0.11",
        "+151 ms",
        "74 000",
    ]);
    table.push([
        "student, integer",
        "0.81 ± 0.07",
        "0.68 ± 0.11",
        "+150 ms",
        "74 000",
    ]);
    let mut curve = |name: &str, start: f64, end: f64| Curve {
        name: name.into(),
        points: (0..60)
            .map(|i| {
                let fall = (-f64::from(i) / 12.0).exp();
                (
                    f64::from(i),
                    end + (start - end) * fall + 0.02 * random.random::<f64>(),
                )
            })
            .collect(),
    };
    let panels = vec![
        Panel {
            title: "Loss".into(),
            step: "epoch".into(),
            curves: vec![curve("training", 1.1, 0.3), curve("validation", 1.1, 0.42)],
        },
        Panel {
            title: "Accuracy on validation subjects".into(),
            step: "epoch".into(),
            curves: vec![
                curve("raw", 0.4, 0.81),
                curve("transition", 0.0, 0.78),
                curve("student", 0.3, 0.8),
            ],
        },
    ];
    let latencies = (0..240)
        .map(|at| {
            let spread: f64 = (0..4).map(|_| random.random::<f64>() - 0.5).sum();
            (at % 7 > 0).then_some((60.0 + 60.0 * spread).round() as i32)
        })
        .collect();
    ReportData {
        drawn: "A recording".to_owned(),
        title: "Intent detection on two unseen subjects".into(),
        summary: "Trained on six subjects with \"synthetic\" <EMG>, measured on two others.".into(),
        provenance: vec![(
            "A group".to_owned(),
            [
                ("data", "synthetic, seed 42"),
                ("left out", "subjects 3 and 6"),
                ("revision", "0000000"),
            ]
            .map(|(name, value)| (name.to_owned(), value.to_owned()))
            .to_vec(),
        )],
        headline: vec![Headline {
            name: "balanced accuracy".into(),
            value: "0.912".into(),
            remark: "[0.88, 0.94]".into(),
            floor: Some("0.700".into()),
        }],
        overview: vec![Row {
            name: "student".into(),
            kind: Kind::Entry(0),
            people: 1,
            values: [None; 3],
        }],
        people: Some(People {
            names: vec!["student".into()],
            floor: "energy detector".into(),
            rows: vec![Person {
                subject: "subject 3".into(),
                values: vec![Some(0.9)],
                floor: Some(0.7),
            }],
        }),
        tables: vec![table],
        timelines: vec![synthetic_timeline(random)],
        panels,
        errors: vec![Errors {
            name: "student".into(),
            confusion: Some(Confusion {
                counts: vec![
                    vec![9120, 310, 402, 31],
                    vec![820, 4110, 230, 12],
                    vec![960, 120, 3980, 0],
                ],
                ..Confusion::new(Vocabulary::Three)
            }),
            latencies,
        }],
        notes: vec!["Every number on this page is synthetic.".into()],
        ..ReportData::default()
    }
}

/// Whether every tag is closed in order; elements of HTML that never close are written `<x/>`.
fn well_formed(markup: &str) -> Result<(), String> {
    let mut open: Vec<&str> = Vec::new();
    for piece in markup.split('<').skip(1) {
        let (tag, text) = piece
            .split_once('>')
            .ok_or_else(|| format!("unclosed <{piece}"))?;
        if text.contains('>') {
            return Err(format!("stray > after <{tag}>"));
        }
        if tag.starts_with('!') || tag.ends_with('/') {
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
fn a_report_is_well_formed_and_whole() -> Result<(), Box<dyn Error>> {
    let folder = std::env::temp_dir().join(format!("myointent-report-{}", std::process::id()));
    fs::create_dir_all(&folder)?;
    let path = folder.join("report.html");
    write_html(&synthetic_report(), &path)?;
    let html = fs::read_to_string(&path)?;
    assert_eq!(
        fs::read_dir(&folder)?.count(),
        1,
        "the temporary file is gone"
    );
    // To view the page: MYOINTENT_KEEP_REPORT=folder cargo test report
    if let Some(keep) = std::env::var_os("MYOINTENT_KEEP_REPORT") {
        fs::write(std::path::Path::new(&keep).join("report.html"), &html)?;
        let picture = timeline_svg(&synthetic_report().timelines[0])?;
        fs::write(std::path::Path::new(&keep).join("timeline.svg"), picture)?;
    }
    fs::remove_dir_all(&folder)?;

    well_formed(&html)?;
    assert_eq!(html.matches("<svg").count(), 7);
    assert_eq!(
        html.matches("<title>").count(),
        8,
        "the page's and one for every picture"
    );
    for part in [
        "student, integer",
        "Confusion matrix",
        "median",
        "Loss",
        "Every number on this page is synthetic.",
        "+150 ms",
    ] {
        assert!(html.contains(part), "{part} is missing");
    }
    Ok(())
}

#[test]
fn a_report_needs_nothing_from_elsewhere() -> Result<(), Box<dyn Error>> {
    let html = super::page::html(&synthetic_report())?;
    for reference in [
        "http:", "https:", "src=", "url(", "@import", "<script", "<link",
    ] {
        assert!(
            !html.contains(reference),
            "{reference} refers to something outside"
        );
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
    let mut data = synthetic_report();
    data.title = hostile.into();
    data.summary = hostile.into();
    data.notes = vec![hostile.into()];
    data.tables[0].caption = hostile.into();
    data.tables[0].rows[0][0] = hostile.into();
    data.timelines[0].subject = hostile.into();
    data.panels[0].title = hostile.into();
    data.panels[0].step = hostile.into();
    data.panels[0].curves[0].name = hostile.into();
    data.headline[0].name = hostile.into();
    data.headline[0].floor = Some(hostile.into());
    data.overview[0].name = hostile.into();
    data.people.as_mut().unwrap().rows[0].subject = hostile.into();
    data.provenance[0].0 = hostile.into();
    let html = super::page::html(&data)?;
    assert!(!html.contains("<script"));
    well_formed(&html)?;
    Ok(())
}

#[test]
fn an_empty_report_is_a_page_too() -> Result<(), Box<dyn Error>> {
    let html = super::page::html(&ReportData::default())?;
    well_formed(&html)?;
    assert!(!html.contains("<h2>"));
    let empty = ReportData {
        timelines: vec![Timeline::default()],
        panels: vec![Panel::default()],
        ..ReportData::default()
    };
    well_formed(&super::page::html(&empty)?)?;
    Ok(())
}

#[test]
fn the_picture_alone_names_its_language_and_carries_its_style() -> Result<(), Box<dyn Error>> {
    let timeline = Timeline {
        emg: vec![[3; CHANNELS]; 400],
        truth: vec![Some(Intent::Relax); 400],
        ..Timeline::default()
    };
    let svg = timeline_svg(&timeline)?;
    assert!(svg.starts_with("<svg xmlns="));
    assert!(svg.contains("<style>"));
    well_formed(&svg)?;
    Ok(())
}

#[test]
fn a_report_that_cannot_be_written_says_where() {
    let missing = std::env::temp_dir().join("myointent-no-such-folder/report.html");
    let error = write_html(&ReportData::default(), &missing).unwrap_err();
    assert!(error.to_string().contains("myointent-no-such-folder"));
}
