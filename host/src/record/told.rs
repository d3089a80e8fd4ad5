//! Findings in words.

use serde::Serialize;

use super::quality::Finding;
use recordings::Severity;

/// A finding in words.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub(crate) struct Told {
    pub(crate) severity: Severity,
    pub(crate) text: String,
    pub(crate) advice: &'static str,
}

impl From<&Finding> for Told {
    fn from(finding: &Finding) -> Self {
        Self {
            severity: finding.severity(),
            text: finding.to_string(),
            advice: finding.advice(),
        }
    }
}
