//! Text of findings for people.

use serde::Serialize;

use super::quality::Finding;
use recordings::Severity;

/// Finding as text, with its severity.
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
