//! Validity of the settings of a student's training.

use super::{Invalid, require};
use crate::Preset;
use crate::distillation::MEMBERS;

impl Preset {
    /// The first setting that no student can be trained with, if there is one.
    pub(super) fn invalid_distillation(&self) -> Option<Invalid> {
        let distillation = &self.distillation;
        [
            require(
                distillation.patches > self.student.span
                    && distillation.batch > 0
                    && distillation.steps > 0
                    && distillation.epochs > 0,
                "distillation",
                distillation.patches,
                "patches above the span; batch, steps and epochs of 1 or more",
            ),
            require(
                (0.0..=1.0).contains(&distillation.teacher_share),
                "distillation.teacher_share",
                distillation.teacher_share,
                "0 to 1",
            ),
            require(
                !self.other() || !distillation.needs_teacher(),
                "distillation.teacher_share",
                distillation.teacher_share,
                "0, or an ensemble, with data.other_movement = \"class\", which no teacher knows",
            ),
            require(
                distillation.ensemble.is_none_or(|ensemble| {
                    (2..=MEMBERS.len()).contains(&ensemble.members) && ensemble.epochs > 0
                }),
                "distillation.ensemble",
                distillation.ensemble,
                "2 to 8 members, epochs of 1 or more",
            ),
            require(
                distillation.temperature.is_finite() && distillation.temperature > 0.0,
                "distillation.temperature",
                distillation.temperature,
                "a positive number",
            ),
            require(
                (0.0..1.0).contains(&distillation.ema_decay),
                "distillation.ema_decay",
                distillation.ema_decay,
                "0 or more, below 1",
            ),
        ]
        .into_iter()
        .flatten()
        .next()
    }
}
