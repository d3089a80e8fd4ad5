//! Whether a prediction follows a change of the truth, by the paper's rule and its variants.

use shared::intent::Intent;

use super::{Label, Rule};

/// Whether the prediction follows a change of the truth from label A to label B, or why not.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TransitionStatus {
    /// The prediction follows.
    Ok,
    /// A label other than A and B in the buffer, or none.
    BufferOtherClass,
    /// No change from A straight to B in the buffer.
    NoChangeInBuffer,
    /// A label other than B in the maintenance, or none.
    MaintenanceNotHeld,
    /// Relax allowed: a label other than B and relax in the maintenance.
    MaintenanceOtherClass,
    /// Relax allowed: no B in the maintenance.
    MaintenanceOnlyRelax,
    /// Strict: a label other than A and B in the buffer, or none.
    StrictBufferOtherClass,
    /// Strict: no B in the buffer.
    StrictNoNewLabel,
    /// Strict: the buffer starts with B.
    StrictNewLabelAtStart,
    /// Strict: A again after B.
    StrictOldLabelAfterNew,
    /// Strict: a label other than B in the maintenance, or none.
    StrictMaintenanceNotHeld,
    /// Strict, relax allowed: a label other than B and relax in the maintenance.
    StrictMaintenanceOtherClass,
}

impl TransitionStatus {
    /// Name in the reference's golden cases and in JSON.
    pub const fn code(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::BufferOtherClass => "buffer_other_class",
            Self::NoChangeInBuffer => "no_change_in_buffer",
            Self::MaintenanceNotHeld => "maintenance_not_held",
            Self::MaintenanceOtherClass => "maintenance_other_class",
            Self::MaintenanceOnlyRelax => "maintenance_only_relax",
            Self::StrictBufferOtherClass => "strict_buffer_other_class",
            Self::StrictNoNewLabel => "strict_no_new_label",
            Self::StrictNewLabelAtStart => "strict_new_label_at_start",
            Self::StrictOldLabelAfterNew => "strict_old_label_after_new",
            Self::StrictMaintenanceNotHeld => "strict_maintenance_not_held",
            Self::StrictMaintenanceOtherClass => "strict_maintenance_other_class",
        }
    }

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
/// maintenance.
pub(super) fn status(
    from: Intent,
    to: Intent,
    near: &[Label],
    later: &[Label],
    rule: &Rule,
) -> TransitionStatus {
    if rule.strict {
        strict(from, to, near, later, rule.allow_relax)
    } else {
        standard(from, to, near, later, rule.allow_relax)
    }
}

/// Whether a label is another one than this, and not relax where that is allowed.
fn other_than(to: Label, relax: bool) -> impl Fn(&Label) -> bool + Copy {
    move |label| *label != to && !(relax && *label == Some(Intent::Relax))
}

/// The paper's rule.
fn standard(
    from: Intent,
    to: Intent,
    near: &[Label],
    later: &[Label],
    relax: bool,
) -> TransitionStatus {
    let (from, to) = (Some(from), Some(to));
    let other = other_than(to, relax);
    if near.iter().any(|label| *label != from && other(label)) {
        return TransitionStatus::BufferOtherClass;
    }
    if !near.windows(2).any(|pair| pair == [from, to]) {
        return TransitionStatus::NoChangeInBuffer;
    }
    if relax {
        if later.iter().any(other) {
            return TransitionStatus::MaintenanceOtherClass;
        }
        if !later.is_empty() && !later.contains(&to) {
            return TransitionStatus::MaintenanceOnlyRelax;
        }
    } else if later.iter().any(|&label| label != to) {
        return TransitionStatus::MaintenanceNotHeld;
    }
    TransitionStatus::Ok
}

/// The strict rule: once B has come, nothing else may follow.
fn strict(
    from: Intent,
    to: Intent,
    near: &[Label],
    later: &[Label],
    relax: bool,
) -> TransitionStatus {
    let (from, to) = (Some(from), Some(to));
    let other = other_than(to, relax);
    if near.iter().any(|label| *label != from && other(label)) {
        return TransitionStatus::StrictBufferOtherClass;
    }
    let Some(first) = near.iter().position(|&label| label == to) else {
        return TransitionStatus::StrictNoNewLabel;
    };
    if first == 0 {
        return TransitionStatus::StrictNewLabelAtStart;
    }
    if near[first..].iter().any(other) {
        return TransitionStatus::StrictOldLabelAfterNew;
    }
    match later.iter().any(other) {
        true if relax => TransitionStatus::StrictMaintenanceOtherClass,
        true => TransitionStatus::StrictMaintenanceNotHeld,
        false => TransitionStatus::Ok,
    }
}
