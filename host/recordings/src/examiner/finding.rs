//! Findings of the examiner: what is wrong with a recording, and what to do.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;

shared::names! {
    /// Severity of a finding.
    #[derive(PartialOrd, Ord, Serialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum Severity {
        /// Information only.
        Note = "note",
        /// The recording is usable, but has a defect.
        Warning = "warning",
        /// Results on the recording are unreliable.
        Serious = "serious",
    }
}

/// Defect of a recording, made where it is found. Channels and rows count from 1.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Finding {
    /// Severity of the finding if the recording is kept.
    pub severity: Severity,
    /// Name of the kind, by which findings are grouped.
    pub kind: &'static str,
    /// Sentence of what was expected and what was found.
    pub what: String,
    /// Advice on what to do; empty if there is nothing to do.
    pub advice: Cow<'static, str>,
}

/// Kind of the known limits of a data set.
const KNOWN: &str = "known";

impl Finding {
    /// Finding of severity warning; also the reason of a refusal.
    pub(crate) fn warning(
        kind: &'static str,
        what: impl Into<String>,
        advice: impl Into<Cow<'static, str>>,
    ) -> Self {
        Self {
            severity: Severity::Warning,
            kind,
            what: what.into(),
            advice: advice.into(),
        }
    }

    /// A known limit, without advice.
    pub(crate) fn known(what: impl Into<String>) -> Self {
        Self {
            severity: Severity::Note,
            ..Self::warning(KNOWN, what, "")
        }
    }

    /// Finding that is serious where `is_serious`: it makes results unreliable.
    pub(crate) fn serious_if(mut self, is_serious: bool) -> Self {
        if is_serious {
            self.severity = Severity::Serious;
        }
        self
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.what)
    }
}

/// A finding, and the recordings that have it.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Group {
    /// Finding in the first recording.
    #[serde(flatten)]
    pub finding: Finding,
    /// The recordings or files, in order.
    pub which: Vec<String>,
}

impl fmt::Display for Group {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let first = self.which.first().map_or("", String::as_str);
        let finding = &self.finding;
        write!(f, "{}: {first}: {finding}", finding.severity.name())?;
        if self.which.len() > 1 {
            write!(f, "; {} recordings have the like", self.which.len())?;
        }
        if !finding.advice.is_empty() {
            write!(f, " ({})", finding.advice)?;
        }
        Ok(())
    }
}

/// Groups findings, given with their recordings' names, by kind: the worst first, then by name. Known limits of a data
/// set are grouped by their text.
pub fn grouped<'f>(findings: impl IntoIterator<Item = (String, &'f Finding)>) -> Vec<Group> {
    let mut groups: BTreeMap<(&str, &str, Severity), Group> = BTreeMap::new();
    for (whose, finding) in findings {
        let words = if finding.kind == KNOWN {
            &*finding.what
        } else {
            ""
        };
        let group = groups
            .entry((finding.kind, words, finding.severity))
            .or_insert_with(|| Group {
                finding: finding.clone(),
                which: Vec::new(),
            });
        if group.which.last() != Some(&whose) {
            group.which.push(whose);
        }
    }
    let mut groups: Vec<Group> = groups.into_values().collect();
    groups.sort_by_key(|group| std::cmp::Reverse(group.finding.severity));
    groups
}
