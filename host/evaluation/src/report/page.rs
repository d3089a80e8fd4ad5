//! The report as HTML.

use std::path::Path;

use execution::run_folder::write_whole;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use recordings::statistics::{FEWEST, MeanSd};

use super::cell::{median, none, rate};
use super::entry::Entry;
use super::pictures::{INK, MUTED, STYLE, charts, confusion, entry_colour, overview, timeline};
use super::row::{Row, over_all};
use super::scores::{counted, estimated};
use super::table::Table;
use super::{Fact, recognition};
use crate::{EvaluationError, Measure, Score, confusion, gestures};

/// Style of the page; that of the pictures comes from `pictures`.
const PAGE_STYLE: &str = include_str!("page.css");

/// People who are drawn of a single entry, the lowest first; the best one is added.
const WORST: usize = 3;
/// Whom they are chosen from.
const AMONG: &str = ", of those whose recordings have all classes, if there are such";

/// Contents of a report; empty parts are left out of the page.
#[derive(Default)]
pub(super) struct Page<'a> {
    /// Headline.
    pub title: String,
    /// One sentence under the headline: what was evaluated, and on whom.
    pub summary: String,
    /// Runs and model files that are drawn.
    pub entries: &'a [Entry<'a>],
    /// Tables, the most important first.
    pub tables: Vec<Table>,
    /// Tables that few readers need, at the end of the page.
    pub more_tables: Vec<Table>,
    /// Scores of each person.
    pub people_tables: Vec<Table>,
    /// Origin of the numbers, in groups with a name, which may be empty.
    pub provenance: Vec<(String, Vec<Fact>)>,
    /// Limits of the numbers; one paragraph each.
    pub notes: Vec<String>,
}

/// Part of the page: its id, its title in the headline and in the contents, its content.
type Section = (&'static str, &'static str, Markup);

impl<'s> Page<'s> {
    /// Writes the page to `path`, under a temporary name first and renamed when whole.
    pub(super) fn write(&self, path: &Path) -> Result<(), EvaluationError> {
        Ok(write_whole(path, self.html()?.as_bytes())?)
    }

    pub(super) fn html(&self) -> Result<String, EvaluationError> {
        let sections = self.sections()?;
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (self.title) }
                    style { (PreEscaped(PAGE_STYLE)) (PreEscaped(STYLE)) }
                }
                body {
                    h1 { (self.title) }
                    @if !self.summary.is_empty() { p { (self.summary) } }
                    @if let [only] = self.entries { (headline(only)) }
                    @if sections.len() > 2 {
                        nav aria-label="Contents" {
                            @for (id, title, _) in &sections { a href={ "#" (id) } { (title) } " " }
                        }
                    }
                    @for (id, title, content) in &sections { section id=(id) { h2 { (title) } (content) } }
                }
            }
        };
        Ok(page.into_string())
    }

    /// The sections that have something to show, the most important first.
    fn sections(&self) -> Result<Vec<Section>, EvaluationError> {
        let entries = self.entries;
        let rows = overview_rows(entries);
        let panels: Vec<_> = entries.iter().flat_map(|entry| &entry.panels).collect();
        let results = html! {
            @if !rows.is_empty() {
                p.remark { (whose(&rows)) " Grey: floors, which need no model." }
                figure { (overview::overview(&rows)) }
            }
            @for table in &self.tables { (table) }
        };
        let people = html! {
            @for table in &self.people_tables { (table) }
        };
        let training = html! {
            @if !panels.is_empty() { div.pair { @for panel in panels { figure { (charts::curves(panel)) } } } }
        };
        let more = html! { @for table in &self.more_tables { (table) } };
        let provenance = html! {
            @for (name, facts) in self.provenance.iter().filter(|(_, facts)| !facts.is_empty()) {
                @if !name.is_empty() { h3 { (name) } }
                dl { @for (name, value) in facts { dt { (name) } dd { (value) } } }
            }
        };
        let limits = html! { @for note in &self.notes { p { (note) } } };
        let mut sections = vec![
            ("results", "Results", results),
            ("people", "People", people),
            ("errors", "Errors", errors(entries)?),
            ("recordings", "Recordings", recordings(entries)?),
            ("training", "Training", training),
            ("tables", "More tables", more),
            ("provenance", "What was evaluated", provenance),
            ("limits", "Limits of these numbers", limits),
        ];
        sections.retain(|(.., content)| !content.0.is_empty());
        Ok(sections)
    }
}

/// Sentence about the picture at the top: whose scores it shows, and whether it has intervals.
fn whose(rows: &[(&str, &Row<'_>)]) -> String {
    let people = rows.iter().map(|(_, score)| score.widest().subjects.len());
    let means = "Means over people who have all classes of the model, and of the others in rows of their own (fewer)";
    let n = "n: people of a number, where the row has more.";
    match people.max().unwrap_or(0) {
        1 if all_of_one_person(rows.iter().map(|(_, row)| row.score)) => {
            "One person: no intervals.".to_owned()
        }
        0..FEWEST => format!("{means}. Fewer than six people: no intervals. {n}"),
        _ => format!("{means}; with 95 % intervals, from six people on. {n}"),
    }
}

/// Whether all rows are of one and the same person.
fn all_of_one_person<'s>(rows: impl IntoIterator<Item = &'s Score>) -> bool {
    let rows = rows.into_iter();
    let mut people = rows.flat_map(|score| &score.widest().subjects);
    let first = people.next().map(|own| &own.subject);
    first.is_some() && people.all(|own| Some(&own.subject) == first)
}

/// Confusion and latencies, a row of two pictures for each entry.
fn errors(entries: &[Entry<'_>]) -> Result<Markup, EvaluationError> {
    let latencies = |entry: &Entry<'_>| -> Result<Vec<_>, EvaluationError> {
        let (candidate, recordings) = (entry.candidate, entry.recordings);
        let gestures = gestures(candidate, recordings, entry.vocabulary, entry.look_ahead)?;
        Ok(gestures.iter().map(|own| own.latency).collect())
    };
    let latencies: Vec<Vec<_>> = entries.iter().map(latencies).collect::<Result<_, _>>()?;
    let histograms = charts::latencies(&latencies);
    Ok(html! {
        @if !entries.is_empty() {
            p.remark {
                "Of all people, whatever their classes. Confusion matrix: each row is one true label and adds up to 100 % of its \
                 samples, with each predicted label at the time that it is for. Latency: the gestures that were recognised, from the onset to the emitted label; the orange line is the \
                 median over all gestures, missed ones included."
            }
        }
        @if let Some(panel) = recognition::of_entries(entries) { figure { (charts::curves(&panel)) } }
        @for (at, entry) in entries.iter().enumerate() {
            @let (candidate, recordings) = (entry.candidate, entry.recordings);
            @let matrix = confusion(candidate, recordings, entry.vocabulary, entry.look_ahead)?;
            @if entries.len() > 1 { h3 { (entry.name) } }
            div.pair {
                figure { (confusion::matrix(&matrix)) }
                @if !latencies[at].is_empty() { figure { (histograms[at]) } }
            }
        }
    })
}

/// Recordings with true and emitted labels.
fn recordings(entries: &[Entry<'_>]) -> Result<Markup, EvaluationError> {
    let several = entries.len() > 1;
    let mut timelines = Vec::new();
    for entry in entries {
        timelines.extend(entry.drawn(if several { 1 } else { WORST }, several)?);
    }
    Ok(html! {
        @if !timelines.is_empty() {
            p.remark {
                "Rectified EMG, all channels on one scale. Below it the true label, from the muscle's onset to its end, and the label \
                 that the model has emitted by then. Thin lines mark where the true label changes; the emitted one should change soon \
                 after them."
            }
            h3 {
                @if all_of_one_person(entries.iter().flat_map(Entry::everybody).map(|row| row.score)) { "The person's recording with the most gestures" }
                @else if several { "The person with the lowest balanced accuracy of each model, then its best one" (AMONG) }
                @else { "The people with the lowest balanced accuracy, the worst first, then the best one" (AMONG) }
            }
            @for recording in &timelines { figure { (timeline::svg(recording)) } }
        }
    })
}

/// Rows of the picture at the top, with their colours: entries, other models of their runs, then floors.
fn overview_rows<'a>(entries: &'a [Entry<'_>]) -> Vec<(&'static str, &'a Row<'a>)> {
    let numbered = entries.iter().enumerate();
    let own = numbered.map(|(at, entry)| (entry_colour(at), &entry.scores));
    let beside = entries.iter().map(|entry| (INK, &entry.beside));
    let floors = entries.iter().map(|entry| (MUTED, &entry.floors));
    let mut rows = Vec::new();
    for (colour, scores) in own.chain(beside).chain(floors) {
        for score in over_all(scores) {
            // Floors of several entries may be the same.
            if colour != MUTED || !rows.contains(&(colour, score)) {
                rows.push((colour, score));
            }
        }
    }
    rows
}

/// Numbers at the top of a page, each beside the energy detector's: of people who have all classes, if there are any.
fn headline(entry: &Entry<'_>) -> Markup {
    let Some(own) = over_all(&entry.scores).next() else {
        return html! {};
    };
    let energy = entry.energy().find(|floor| floor.people == own.people);
    let share = |name, measure: Measure, why| {
        let shown = counted(estimated(own, measure), own, measure);
        let (value, interval) = shown.split_once(' ').unwrap_or((&shown, ""));
        let floor = energy.and_then(|floor| measure.mean(floor));
        let floor = floor.map(|floor| format!("{:.3}", floor.mean));
        tile(name, value, interval, why, floor)
    };
    let of_both = |name, of: fn(&Score) -> String, unit, why| {
        let floor = energy.map(|floor| of(floor));
        tile(name, &of(own), unit, why, floor)
    };
    let people = own.widest().subjects.len().to_string();
    let is_other_marked = Measure::OtherActivations.mean(own).is_some();
    html! {
        ul.headline {
            (tile("people", &people, &own.people.told(own.classes), "", None))
            (share("balanced accuracy", Measure::BalancedAccuracy, "nobody here has two classes"))
            (share("transition accuracy", Measure::TransitionAccuracy, "no label changes here"))
            (share("gestures recognised", Measure::Recognition, "no gesture begins here"))
            (share("one decision a gesture", Measure::Decided, "no gesture begins here"))
            (of_both("median latency, ms", |of| of.events.latency.map_or_else(none, median), "from the muscle's onset", "no gesture begins here"))
            (of_both("median release, ms", |of| of.events.release.map_or_else(none, median), "from the muscle's end", "no gesture is let go here"))
            (of_both("false activations", |of| mean_rate(of, Measure::FalseActivations), "a minute of rest", "there is no rest here"))
            @if is_other_marked {
                (of_both("labels in other movement", |of| mean_rate(of, Measure::OtherActivations), "a minute of it", ""))
            }
        }
    }
}

/// Mean of a rate, without its deviation.
fn mean_rate(of: &Score, measure: Measure) -> String {
    let mean = measure.mean(of);
    rate(mean.map(|mean| MeanSd { sd: None, ..mean }))
}

/// A number with its interval or unit, or why it is missing, and the number of the energy detector.
fn tile(name: &str, value: &str, with: &str, why: &str, floor: Option<String>) -> Markup {
    let is_missing = value == none();
    html! {
        li {
            span.name { (name) } span.value { (value) } span.with { (if is_missing { why } else { with }) }
            @if let Some(floor) = floor.filter(|floor| *floor != none()) { span.floor { "energy detector " (floor) } }
        }
    }
}
