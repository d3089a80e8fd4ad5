//! The report as HTML.

use std::fmt::Write as _;

use super::{
    Errors, Fact, Headline, ReportData, ReportError,
    canvas::{STYLE, escape},
    confusion, curves, device, latencies, overview, people, timeline,
};

/// Style of the page; that of the pictures comes from `canvas`.
const PAGE_STYLE: &str = include_str!("page.css");

/// The whole report as HTML.
pub(super) fn html(data: &ReportData) -> Result<String, ReportError> {
    let title = escape(&data.title);
    let sections = sections(data)?;
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <title>{title}</title>\n<style>{PAGE_STYLE}{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
    );
    if !data.summary.is_empty() {
        paragraph(&mut page, "", &data.summary);
    }
    headline(&mut page, &data.headline);
    if sections.len() > 2 {
        page.push_str("<nav aria-label=\"Contents\">");
        for section in &sections {
            let (id, title) = (section.id, escape(&section.title));
            let _ = write!(page, "<a href=\"#{id}\">{title}</a> ");
        }
        page.push_str("</nav>\n");
    }
    for section in &sections {
        let (id, title) = (section.id, escape(&section.title));
        let _ = writeln!(page, "<section id=\"{id}\">\n<h2>{title}</h2>");
        page.push_str(&section.content);
        page.push_str("</section>\n");
    }
    page.push_str("</body>\n</html>\n");
    Ok(page)
}

/// A part of the page with a headline.
struct Section {
    id: &'static str,
    /// Title in the headline and in the contents.
    title: String,
    content: String,
}

impl Section {
    fn new(id: &'static str, title: impl Into<String>, remark: &str) -> Self {
        let mut content = String::new();
        if !remark.is_empty() {
            paragraph(&mut content, " class=\"remark\"", remark);
        }
        Self {
            id,
            title: title.into(),
            content,
        }
    }
}

/// The sections that have something to show, the most important first.
fn sections(data: &ReportData) -> Result<Vec<Section>, ReportError> {
    let mut sections = Vec::new();
    if !data.tables.is_empty() || !data.overview.is_empty() {
        let mut own = Section::new("results", "Results", "");
        if !data.overview.is_empty() {
            paragraph(
                &mut own.content,
                " class=\"remark\"",
                "Means over people who have all classes of the model, and of the others in rows of their own (fewer); with 95 % \
                 intervals, from six people on. n: people of a number, where the row has more. Grey: floors, which need no model.",
            );
            figure(&mut own.content, &overview::svg(&data.overview)?);
        }
        let tables = data.tables.iter();
        tables.for_each(|table| own.content.push_str(&table.html()));
        sections.push(own);
    }
    if data.people.is_some() || !data.people_tables.is_empty() {
        let mut own = Section::new("people", "People", "");
        if let Some(people) = &data.people {
            figure(&mut own.content, &people::svg(people)?);
        }
        let tables = data.people_tables.iter();
        tables.for_each(|table| own.content.push_str(&table.html()));
        sections.push(own);
    }
    sections.extend(errors(&data.errors)?);
    if !data.timelines.is_empty() {
        let mut own = Section::new(
            "recordings",
            "Recordings",
            "Rectified EMG, all channels on one scale. Thin lines mark where the true label changes; \
             the emitted label should change near them.",
        );
        if !data.drawn.is_empty() {
            let _ = writeln!(own.content, "<h3>{}</h3>", escape(&data.drawn));
        }
        for recording in &data.timelines {
            figure(&mut own.content, &timeline::svg(recording)?);
        }
        sections.push(own);
    }
    if !data.panels.is_empty() {
        let mut own = Section::new("training", "Training", "");
        let pictures: Result<Vec<_>, _> = data.panels.iter().map(curves::svg).collect();
        pair(&mut own.content, &pictures?);
        sections.push(own);
    }
    if !data.device.is_empty() {
        let mut own = Section::new("device", "Cost on a board", "");
        own.content.push_str(&device::table(&data.device).html());
        if !device::all_counted(&data.device) {
            paragraph(
                &mut own.content,
                " class=\"remark\"",
                "Instructions of a model of another shape: cargo xtask count --model FILE counts them on an emulated core.",
            );
        }
        sections.push(own);
    }
    if !data.more_tables.is_empty() {
        let mut own = Section::new("tables", "More tables", "");
        let tables = data.more_tables.iter();
        tables.for_each(|table| own.content.push_str(&table.html()));
        sections.push(own);
    }
    if !data.provenance.is_empty() {
        let mut own = Section::new("provenance", "What was evaluated", "");
        for (name, facts) in &data.provenance {
            provenance(&mut own.content, name, facts);
        }
        sections.push(own);
    }
    if !data.notes.is_empty() {
        let mut own = Section::new("limits", "Limits of these numbers", "");
        let notes = data.notes.iter();
        notes.for_each(|note| paragraph(&mut own.content, "", note));
        sections.push(own);
    }
    Ok(sections)
}

/// Section of confusion and latencies, a row of two pictures for each entry.
fn errors(errors: &[Errors]) -> Result<Option<Section>, ReportError> {
    let mut own = Section::new(
        "errors",
        "Errors",
        "Of all people, whatever their classes. Confusion matrix: each row is one true label and adds up to 100 % of its samples. Latency: the gestures that were \
         recognised, from the onset to the emitted label; the orange line is the median over all gestures, missed ones included.",
    );
    let mut any = false;
    for entry in errors {
        let mut pictures = Vec::new();
        if let Some(matrix) = &entry.confusion {
            pictures.push(confusion::svg(matrix)?);
        }
        if !entry.latencies.is_empty() {
            pictures.push(latencies::svg(&entry.latencies)?);
        }
        if pictures.is_empty() {
            continue;
        }
        any = true;
        if errors.len() > 1 {
            let _ = writeln!(own.content, "<h3>{}</h3>", escape(&entry.name));
        }
        pair(&mut own.content, &pictures);
    }
    Ok(any.then_some(own))
}

fn headline(page: &mut String, figures: &[Headline]) {
    if figures.is_empty() {
        return;
    }
    page.push_str("<ul class=\"headline\">\n");
    for own in figures {
        let floor = own.floor.as_ref().map_or_else(String::new, |floor| {
            format!(
                "<span class=\"floor\">energy detector {}</span>",
                escape(floor)
            )
        });
        let _ = writeln!(
            page,
            "<li><span class=\"name\">{}</span><span class=\"value\">{}</span><span class=\"with\">{}</span>{floor}</li>",
            escape(&own.name),
            escape(&own.value),
            escape(&own.remark),
        );
    }
    page.push_str("</ul>\n");
}

fn paragraph(page: &mut String, attributes: &str, text: &str) {
    let _ = writeln!(page, "<p{attributes}>{}</p>", escape(text));
}

fn provenance(page: &mut String, name: &str, facts: &[Fact]) {
    if facts.is_empty() {
        return;
    }
    if !name.is_empty() {
        let _ = writeln!(page, "<h3>{}</h3>", escape(name));
    }
    page.push_str("<dl>\n");
    for (name, value) in facts {
        let _ = writeln!(page, "<dt>{}</dt><dd>{}</dd>", escape(name), escape(value));
    }
    page.push_str("</dl>\n");
}

fn figure(page: &mut String, svg: &str) {
    let _ = writeln!(page, "<figure>{svg}</figure>");
}

fn pair(page: &mut String, pictures: &[String]) {
    page.push_str("<div class=\"pair\">\n");
    pictures.iter().for_each(|svg| figure(page, svg));
    page.push_str("</div>\n");
}
