//! Whether a prediction follows a change of the truth, by the paper's rule and its variants.

use shared::intent::Intent;

use super::{Label, Rule};

shared::names! {
    /// Whether the prediction follows a change of the truth from label A to label B, or why not. Names are those of the
    /// reference's golden cases.
    #[derive(PartialOrd, Ord, serde::Serialize)]
    #[serde(rename_all = "snake_case")]
    pub enum TransitionStatus {
        /// The prediction follows.
        Ok = "ok",
        /// A label other than A and B in the buffer, or none.
        BufferOtherClass = "buffer_other_class",
        /// No change from A straight to B in the buffer.
        NoChangeInBuffer = "no_change_in_buffer",
        /// A label other than B in the maintenance, or none.
        MaintenanceNotHeld = "maintenance_not_held",
        /// Relax allowed: a label other than B and relax in the maintenance.
        MaintenanceOtherClass = "maintenance_other_class",
        /// Relax allowed: no B in the maintenance.
        MaintenanceOnlyRelax = "maintenance_only_relax",
        /// Strict: a label other than A and B in the buffer, or none.
        StrictBufferOtherClass = "strict_buffer_other_class",
        /// Strict: no B in the buffer.
        StrictNoNewLabel = "strict_no_new_label",
        /// Strict: the buffer starts with B.
        StrictNewLabelAtStart = "strict_new_label_at_start",
        /// Strict: A again after B.
        StrictOldLabelAfterNew = "strict_old_label_after_new",
        /// Strict: a label other than B in the maintenance, or none.
        StrictMaintenanceNotHeld = "strict_maintenance_not_held",
        /// Strict, relax allowed: a label other than B and relax in the maintenance.
        StrictMaintenanceOtherClass = "strict_maintenance_other_class",
    }
}

impl TransitionStatus {
    /// Explanation for a user.
    pub const fn reason(self) -> &'static str {
        match self {
            Self::Ok => "follows",
            Self::BufferOtherClass | Self::StrictBufferOtherClass => {
                "a third label, or none, near the change"
            }
            Self::NoChangeInBuffer => "no change from the old label to the new one near the change",
            Self::MaintenanceNotHeld | Self::StrictMaintenanceNotHeld => {
                "the new label is not held until the next change"
            }
            Self::MaintenanceOtherClass | Self::StrictMaintenanceOtherClass => {
                "a third label, or none, while the new one should be held"
            }
            Self::MaintenanceOnlyRelax => "relax alone while the new label should be held",
            Self::StrictNoNewLabel => "the new label does not come near the change",
            Self::StrictNewLabelAtStart => "the new label comes too early",
            Self::StrictOldLabelAfterNew => "the old label comes back",
        }
    }
}

/// Checks a change from `from` to `to`: `near` are the predicted labels in the buffer, `later` those of the
/// maintenance. By the strict rule nothing else may follow once B has come.
pub(super) fn status(
    from: Intent,
    to: Intent,
    near: &[Label],
    later: &[Label],
    rule: &Rule,
) -> TransitionStatus {
    let (from, to, relax) = (Some(from), Some(to), rule.allow_relax);
    // Another label than B, and not relax where that is allowed.
    let other = |label: &Label| *label != to && !(relax && *label == Some(Intent::Relax));
    let is_third = near.iter().any(|label| *label != from && other(label));
    let is_left = later.iter().any(other);
    if rule.strict {
        let first = near.iter().position(|&label| label == to);
        return match first {
            _ if is_third => TransitionStatus::StrictBufferOtherClass,
            None => TransitionStatus::StrictNoNewLabel,
            Some(0) => TransitionStatus::StrictNewLabelAtStart,
            Some(first) if near[first..].iter().any(other) => {
                TransitionStatus::StrictOldLabelAfterNew
            }
            _ if is_left && relax => TransitionStatus::StrictMaintenanceOtherClass,
            _ if is_left => TransitionStatus::StrictMaintenanceNotHeld,
            _ => TransitionStatus::Ok,
        };
    }
    if is_third {
        TransitionStatus::BufferOtherClass
    } else if !near.windows(2).any(|pair| pair == [from, to]) {
        TransitionStatus::NoChangeInBuffer
    } else if is_left && relax {
        TransitionStatus::MaintenanceOtherClass
    } else if is_left {
        TransitionStatus::MaintenanceNotHeld
    } else if relax && !later.is_empty() && !later.contains(&to) {
        TransitionStatus::MaintenanceOnlyRelax
    } else {
        TransitionStatus::Ok
    }
}
