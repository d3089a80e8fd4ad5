//! The report as HTML.

use std::fmt::Write as _;

use super::{
    ReportData, ReportError,
    canvas::{STYLE, escape},
    confusion, curves, latencies, timeline,
};

/// Style of the page; that of the pictures comes from `canvas`.
const PAGE_STYLE: &str = "\
:root{color-scheme:light dark;--paper:#fff;--ink:#1F2933;--muted:#667085;--rule:#E2E6EB}\
@media(prefers-color-scheme:dark){:root{--paper:#14181D;--ink:#E6E9ED;--muted:#9AA4B0;--rule:#2D353F}}\
*{box-sizing:border-box}\
body{margin:0 auto;max-width:1160px;padding:40px 30px 80px;background:var(--paper);color:var(--ink);\
font:16px/1.55 system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif}\
h1{font-size:30px;line-height:1.2;margin:0 0 8px;letter-spacing:-.01em}\
h2{font-size:20px;margin:52px 0 4px}\
p{margin:4px 0 14px;max-width:46em}.remark,caption{color:var(--muted)}\
dl{display:grid;grid-template-columns:max-content 1fr;gap:2px 20px;font-size:14px;margin:20px 0}\
dt{color:var(--muted)}dd{margin:0;overflow-wrap:anywhere}\
.wide{overflow-x:auto;margin:14px 0 26px}\
table{border-collapse:collapse;font-size:15px;font-variant-numeric:tabular-nums}\
caption{text-align:left;padding-bottom:6px;font-size:14px}\
th,td{padding:6px 22px 6px 0;text-align:left;border-bottom:1px solid var(--rule);white-space:nowrap}\
th{font-weight:600;border-bottom-color:var(--muted)}th.number,td.number{text-align:right}\
figure{margin:14px 0 26px}svg{display:block;width:100%;height:auto}\
.pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,440px),1fr));gap:10px 30px;align-items:start}\
@media print{body{max-width:none;padding:0}h2,figure{break-inside:avoid}}";

/// The whole report as HTML.
pub(super) fn html(data: &ReportData) -> Result<String, ReportError> {
    let title = escape(&data.title);
    let mut page = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <title>{title}</title>\n<style>{PAGE_STYLE}{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
    );
    if !data.summary.is_empty() {
        paragraph(&mut page, "", &data.summary);
    }
    provenance(&mut page, &data.provenance);
    if !data.tables.is_empty() {
        heading(&mut page, "Results", "");
        data.tables
            .iter()
            .for_each(|table| page.push_str(&table.html()));
    }
    if !data.timelines.is_empty() {
        heading(
            &mut page,
            &data.drawn,
            "Rectified EMG, all channels on one scale. Thin lines mark where the true label changes; \
             the emitted label should change near them.",
        );
        for recording in &data.timelines {
            figure(&mut page, &timeline::svg(recording)?);
        }
    }
    if !data.panels.is_empty() {
        heading(&mut page, "Training", "");
        let pictures: Result<Vec<_>, _> = data.panels.iter().map(curves::svg).collect();
        pair(&mut page, &pictures?);
    }
    let mut errors = Vec::new();
    if let Some(matrix) = &data.confusion {
        errors.push(confusion::svg(matrix)?);
    }
    if !data.latencies.is_empty() {
        errors.push(latencies::svg(&data.latencies)?);
    }
    if !errors.is_empty() {
        heading(
            &mut page,
            "Errors",
            "Left: confusion matrix; each row is one true label and adds up to 100 % of its samples. Right: latency of \
             the gestures that were recognised, from the onset to the emitted label; the orange line is the median over all \
             gestures, missed ones included.",
        );
        pair(&mut page, &errors);
    }
    if !data.notes.is_empty() {
        heading(&mut page, "Limits of these numbers", "");
        data.notes
            .iter()
            .for_each(|note| paragraph(&mut page, "", note));
    }
    page.push_str("</body>\n</html>\n");
    Ok(page)
}

fn heading(page: &mut String, title: &str, remark: &str) {
    let _ = writeln!(page, "<h2>{}</h2>", escape(title));
    if !remark.is_empty() {
        paragraph(page, " class=\"remark\"", remark);
    }
}

fn paragraph(page: &mut String, attributes: &str, text: &str) {
    let _ = writeln!(page, "<p{attributes}>{}</p>", escape(text));
}

fn provenance(page: &mut String, facts: &[(String, String)]) {
    if facts.is_empty() {
        return;
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
