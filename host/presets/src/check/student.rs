//! Validity of a student's dimensions, and of the settings of its training.

use super::{Invalid, are_heads, require};
use crate::Preset;
use crate::distillation::MEMBERS;
use shared::units::{LOOK_BACK, WINDOW_PATCHES};

impl Preset {
    /// The first dimension that no student can have, if there is one.
    pub(super) fn invalid_student(&self) -> Option<Invalid> {
        let student = &self.student;
        [
            require(
                are_heads(student.heads, student.d_model),
                "student.heads",
                student.heads,
                "a divisor of d_model",
            ),
            require(
                student.span > 0
                    && student.layers > 0
                    && student.receptive_field() <= WINDOW_PATCHES + 1 - LOOK_BACK,
                "student.span",
                student.receptive_field(),
                "layers * (span - 1) + 1 of at most 55 patches",
            ),
        ]
        .into_iter()
        .flatten()
        .next()
    }

    /// The first setting that no student can be trained with, if there is one.
    pub(super) fn invalid_distillation(&self) -> Option<Invalid> {
        let distillation = &self.distillation;
        [
            require(
                distillation.patches > self.student.span
                    && distillation.batch > 0
                    && distillation.steps > 0,
                "distillation",
                distillation.patches,
                "patches above the span; batch and steps of 1 or more",
            ),
            require(
                !self.other() || !distillation.needs_teacher(),
                "distillation.teacher_share",
                distillation.teacher_share,
                "0, or an ensemble, with data.other_movement = \"class\", which no teacher knows",
            ),
            require(
                distillation
                    .ensemble
                    .is_none_or(|own| (2..=MEMBERS.len()).contains(&own.members)),
                "distillation.ensemble",
                distillation.ensemble,
                "2 to 8 members",
            ),
        ]
        .into_iter()
        .flatten()
        .next()
    }
}
