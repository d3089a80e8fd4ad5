//! Findings of many recordings: the same one is told once, with how many have it.

use std::collections::BTreeMap;
use std::fmt;

use serde::Serialize;

use super::{Finding, Severity};

/// A finding, and the recordings that have it.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Group {
    /// How bad it is.
    pub severity: Severity,
    /// Name of the kind.
    pub kind: &'static str,
    /// What was found in the first recording.
    pub what: String,
    /// What to do.
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

/// Findings with whose they are, the same kind together: the worst first, then by name. What readers know of their data set
/// is told apart by its words.
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
