//! Contents of a folder of recordings, as tables.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;
use shared::intent::Intent;
use shared::units::SAMPLE_PERIOD_MS;

use crate::record::{PersonQuality, quality_by_person};
use evaluation::report::Table;
pub use recordings::library::inspection::{Files, Inspection, SetInspection};
pub use recordings::printable;
use recordings::{Group, Library};
use web::outcome::FindingText;

/// Greatest number of files listed with the same finding; `--json` lists all.
const SHOWN: usize = 4;

/// Contents of a library, and whether its guided recordings are good enough to tune a model on.
#[derive(Serialize)]
pub(super) struct Recordings {
    #[serde(flatten)]
    inspection: Inspection,
    guided: Vec<Guided>,
}

#[derive(Serialize)]
struct Guided {
    person: String,
    files: usize,
    seconds: f64,
    good: bool,
    /// Number of labelled stretches of each class.
    counts: BTreeMap<&'static str, usize>,
    findings: Vec<FindingText>,
}

impl Recordings {
    pub(super) fn new(library: &Library) -> Self {
        let guided = |own: PersonQuality| Guided {
            person: own.person,
            files: own.files,
            seconds: own.quality.seconds,
            good: own.quality.is_good_enough(),
            findings: own.quality.findings.iter().map(FindingText::from).collect(),
            counts: own.quality.counts,
        };
        Self {
            inspection: Inspection::new(library),
            guided: quality_by_person(library).into_iter().map(guided).collect(),
        }
    }
}

impl fmt::Display for Guided {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.good {
            "good enough to tune a model on"
        } else {
            "not good enough to tune a model on"
        };
        let counts = self.counts.iter();
        let counts = counts.map(|(class, count)| format!("{class} {count}"));
        writeln!(
            f,
            "{}: {:.0} s, guided recordings: {}; {}: {verdict}",
            printable(&self.person),
            self.seconds,
            self.files,
            counts.collect::<Vec<_>>().join(", ")
        )?;
        for FindingText {
            severity,
            said,
            advice,
        } in &self.findings
        {
            writeln!(f, "    {}: {said}: {advice}", severity.name())?;
        }
        Ok(())
    }
}

pub(super) fn tables(recordings: &Recordings) -> String {
    let Recordings { inspection, guided } = recordings;
    let mut text = sets(&inspection.sets).plain() + "\n";
    for set in &inspection.sets {
        text += &format!("labels of {}: {}\n", set.data_set.name(), set.labels);
    }
    text += &("\n".to_owned() + &taken(&inspection.taken).plain());
    for sentence in &inspection.people {
        text += &format!("\n{}\n", printable(sentence));
    }
    let skipped = &inspection.skipped;
    if !skipped.is_empty() {
        let count = skipped.len();
        let head = format!("left out, because they cannot be read as they are ({count})");
        text += &list(&head, skipped);
    }
    for Group { finding, which } in &inspection.findings {
        let colon = if finding.advice.is_empty() { "" } else { ": " };
        let head = format!(
            "{}: {finding}{colon}{} ({})",
            finding.severity.name(),
            finding.advice,
            which.len()
        );
        text += &list(&head, which);
    }
    for ignored in &inspection.ignored {
        text += &format!(
            "\n{} files not read, {}: {}{}\n",
            ignored.files,
            ignored.what,
            printable(&ignored.first.display().to_string()),
            if ignored.files > 1 { ", ..." } else { "" }
        );
    }
    for person in guided {
        text += &format!("\n{person}");
    }
    text
}

/// Formats a heading and the first of its entries.
fn list(head: &str, entries: &[String]) -> String {
    let mut text = format!("\n{}\n", printable(head));
    for entry in entries.iter().take(SHOWN) {
        text += &format!("    {}\n", printable(entry));
    }
    if entries.len() > SHOWN {
        text += "    ...\n";
    }
    text
}

fn taken(taken: &[Files]) -> Table {
    let caption = "Which reader took how many files, and what it recognises them by.";
    let mut table = Table::new(caption, ["data set", "files", "recognised by", "first"]);
    for files in taken {
        let first = files.first.file_name().unwrap_or_default();
        table.push([
            files.what.clone(),
            files.files.to_string(),
            files.recognised_by.to_owned(),
            first.to_string_lossy().into_owned(),
        ]);
    }
    table
}

fn sets(sets: &[SetInspection]) -> Table {
    let columns = [
        &["data set", "subjects", "recordings", "seconds"][..],
        &Intent::ALL.map(Intent::name),
        &[
            "other",
            "unlabelled",
            "transitions",
            "saturated %",
            "lag ms",
        ],
    ];
    let caption = "Seconds by label; other: movement that is none of the six intents; the largest share of a \
        channel that saturates in a recording; label lag (median; onset: the labels are the muscle's onsets).";
    let mut table = Table::new(caption, columns.concat());
    for set in sets {
        let mut row = vec![
            set.data_set.name().to_owned(),
            set.subjects.to_string(),
            set.recordings.to_string(),
            format!("{:.0}", set.seconds),
        ];
        row.extend(Intent::ALL.map(|intent| {
            let seconds = set.seconds_by_intent.get(intent.name());
            seconds.map_or_else(String::new, |seconds| format!("{seconds:.0}"))
        }));
        let lag = set
            .label_lag
            .map(|lag| lag.lag_samples * SAMPLE_PERIOD_MS as usize);
        row.extend([
            format!("{:.0}", set.seconds_other_movement),
            format!("{:.0}", set.seconds_unlabelled),
            set.transitions.to_string(),
            format!("{:.1}", 100.0 * set.worst_saturation),
            match lag {
                Some(lag) => lag.to_string(),
                None if set.labels.recordings.muscle > 0 => "onset".to_owned(),
                None => String::new(),
            },
        ]);
        table.push(row);
    }
    table
}
