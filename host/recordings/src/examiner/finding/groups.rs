//! Findings of many recordings, grouped.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;

use super::{Finding, Severity};

/// A finding, and the recordings that have it.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Group {
    /// Severity of the finding.
    pub severity: Severity,
    /// Name of the kind.
    pub kind: &'static str,
    /// Text of the finding in the first recording.
    pub what: String,
    /// Advice on what to do.
    pub advice: String,
    /// The recordings or files, in order.
    pub which: Vec<String>,
}

impl fmt::Display for Group {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let first = self.which.first().map_or("", String::as_str);
        write!(f, "{}: {first}: {}", self.severity.name(), self.what)?;
        if self.which.len() > 1 {
            write!(f, "; {} recordings have the like", self.which.len())?;
        }
        if !self.advice.is_empty() {
            write!(f, " ({})", self.advice)?;
        }
        Ok(())
    }
}

/// Groups findings, given with their recordings' names, by kind: the worst first, then by name. Known limits of a data
/// set are grouped by their text.
pub fn grouped<'f>(findings: impl IntoIterator<Item = (String, &'f Finding)>) -> Vec<Group> {
    let mut groups: BTreeMap<(&str, &str, Severity), Group> = BTreeMap::new();
    for (whose, finding) in findings {
        let words = match finding {
            Finding::Known(words) => words,
            _ => "",
        };
        let severity = finding.severity();
        let group = groups
            .entry((finding.kind(), words, severity))
            .or_insert_with(|| Group {
                severity,
                kind: finding.kind(),
                what: finding.to_string(),
                advice: finding.advice(),
                which: Vec::new(),
            });
        if group.which.last() != Some(&whose) {
            group.which.push(whose);
        }
    }
    let mut groups: Vec<Group> = groups.into_values().collect();
    groups.sort_by_key(|group| std::cmp::Reverse(group.severity));
    groups
}
