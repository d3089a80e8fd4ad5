//! Validity of the values of a preset.

mod memory;
mod numbers;
mod student;

use shared::intent::Vocabulary;
use shared::units::{LOOK_BACK, MAX_ENTRY_MARGIN, PATCH, WINDOW};

use super::{EntryMargins, Preset};
use memory::LIMIT;

/// Maximum number of epochs of a training.
const EPOCHS: usize = 1_000_000;
/// Maximum seconds of spliced recordings of a subject.
const DAY: f64 = 86_400.0;

/// Maximum standard deviation of the logarithm of a gain: a factor of 20.
const MOST_DEVIATION: f64 = 3.0;
/// A value that a run cannot use.
pub(super) struct Invalid {
    pub(super) key: &'static str,
    /// Value that was found.
    pub(super) found: String,
    /// Valid values.
    pub(super) expected: &'static str,
}

/// Refuses a value that is not valid.
fn require(
    valid: bool,
    key: &'static str,
    found: impl std::fmt::Debug,
    expected: &'static str,
) -> Option<Invalid> {
    (!valid).then(|| Invalid {
        key,
        found: format!("{found:?}"),
        expected,
    })
}

impl Preset {
    /// The first invalid value, if there is one.
    pub(super) fn invalid(&self) -> Option<Invalid> {
        let classes = require(
            Vocabulary::with_classes(self.classes).is_some(),
            "classes",
            self.classes,
            "3, 5 or 6",
        );
        classes
            .or_else(|| self.invalid_teacher())
            .or_else(|| self.invalid_teacher_training())
            .or_else(|| self.invalid_student())
            .or_else(|| self.invalid_distillation())
            .or_else(|| self.invalid_augmentation())
            .or_else(|| self.invalid_smoother())
            .or_else(|| self.invalid_data())
            .or_else(|| self.invalid_numbers())
            .or_else(|| self.too_large())
    }

    fn invalid_teacher(&self) -> Option<Invalid> {
        let teacher = &self.teacher;
        [
            require(
                (LOOK_BACK * PATCH..=WINDOW).contains(&teacher.window),
                "teacher.window",
                teacher.window,
                "60 to 600 samples",
            ),
            require(
                teacher.patch > 0 && teacher.window.is_multiple_of(teacher.patch),
                "teacher.patch",
                teacher.patch,
                "a divisor of the window",
            ),
            require(
                are_heads(teacher.heads, teacher.d_model),
                "teacher.heads",
                teacher.heads,
                "a divisor of d_model",
            ),
            require(teacher.layers > 0, "teacher.layers", 0, "1 or more"),
            require(
                teacher.feed_forward > 0,
                "teacher.feed_forward",
                0,
                "1 or more",
            ),
        ]
        .into_iter()
        .flatten()
        .next()
    }

    fn invalid_teacher_training(&self) -> Option<Invalid> {
        let training = &self.teacher_training;
        [
            require(
                training.stride > 0 && training.batch > 0 && training.epochs > 0,
                "teacher_training",
                0,
                "stride, batch and epochs of 1 or more",
            ),
            require(
                !training.tasks.is_empty(),
                "teacher_training.tasks",
                &training.tasks,
                "one task or more",
            ),
            require(
                (0.0..1.0).contains(&training.ema_decay),
                "teacher_training.ema_decay",
                training.ema_decay,
                "0 or more, below 1",
            ),
        ]
        .into_iter()
        .flatten()
        .next()
    }

    fn invalid_smoother(&self) -> Option<Invalid> {
        let few = match &self.smoother.entry_margins {
            None | Some(EntryMargins::Same(_)) => true,
            Some(EntryMargins::ByClass(margins)) => margins.len() <= self.classes,
        };
        let valid = |margin: &f32| (0.0..=MAX_ENTRY_MARGIN).contains(margin);
        require(
            few && self.smoother.entry_margins().iter().all(valid),
            "smoother.entry_margins",
            &self.smoother.entry_margins,
            "a margin of 0 to 50, or one for each class at most",
        )
        .or_else(|| {
            let margin = self.smoother.other_margin;
            let range = -MAX_ENTRY_MARGIN..=MAX_ENTRY_MARGIN;
            require(
                margin.is_none_or(|margin| self.other() && range.contains(&margin)),
                "smoother.other_margin",
                margin.unwrap_or(0.0),
                "-50 to 50, with data.other_movement = \"class\"",
            )
        })
    }

    fn invalid_augmentation(&self) -> Option<Invalid> {
        let (training, distillation) = (&self.teacher_training, &self.distillation);
        [&training.augmentation, &distillation.augmentation]
            .into_iter()
            .flatten()
            .find_map(|augmentation| {
                require(
                    (0.0..=MOST_DEVIATION).contains(&augmentation.gain)
                        && augmentation.rotation <= 3,
                    "augmentation",
                    augmentation,
                    "gain of 0 to 3, rotation of 0 to 3",
                )
            })
    }

    /// The first size that no memory holds, or number of epochs that no training completes, if there is one.
    fn too_large(&self) -> Option<Invalid> {
        let gibibytes = |bytes: f64| format!("of about {:.0} GiB", bytes / f64::from(1 << 30));
        let memory = |key, bytes: f64| {
            (bytes > LIMIT).then(|| Invalid {
                key,
                found: gibibytes(bytes),
                expected: "a step of 64 GiB at most: smaller dimensions or a smaller batch",
            })
        };
        let epochs = [
            ("teacher_training.epochs", self.teacher_training.epochs),
            ("fine_tuning.epochs", self.fine_tuning.epochs),
            ("distillation.epochs", self.distillation.epochs),
            (
                "distillation.ensemble.epochs",
                self.distillation.ensemble.map_or(0, |own| own.epochs),
            ),
        ];
        epochs
            .into_iter()
            .find_map(|(key, epochs)| require(epochs <= EPOCHS, key, epochs, "at most 1000000"))
            .or_else(|| memory("teacher", self.teacher_bytes()))
            .or_else(|| memory("student", self.student_bytes()))
    }

    fn invalid_data(&self) -> Option<Invalid> {
        let data = &self.data;
        let seconds = data.spliced_seconds;
        [
            require(
                (0.0..1.0).contains(&data.held_out_share),
                "data.held_out_share",
                data.held_out_share,
                "0 or more, below 1",
            ),
            require(
                (0.0..1.0).contains(&data.validation_share),
                "data.validation_share",
                data.validation_share,
                "0 or more, below 1",
            ),
            require(
                (0.0..=1.0).contains(&data.balance),
                "data.balance",
                data.balance,
                "0 to 1",
            ),
            require(
                (0.0..=DAY).contains(&seconds) && (seconds >= 10.0 || data.as_published),
                "data.spliced_seconds",
                seconds,
                "10 to 86400, or as_published = true",
            ),
        ]
        .into_iter()
        .flatten()
        .next()
    }
}

/// Whether tokens of this width can be divided into this number of attention heads.
fn are_heads(heads: usize, d_model: usize) -> bool {
    heads > 0 && d_model > 0 && d_model.is_multiple_of(heads)
}

#[cfg(test)]
mod tests {
    use crate::{BUILT_IN, Preset, PresetError};

    /// The key that is refused after an edit of the quickstart preset.
    fn refused(from: &str, to: &str) -> &'static str {
        let text = BUILT_IN[0].1.replace(from, to);
        match Preset::parse("mine", &text) {
            Err(PresetError::Value { key, .. }) => key,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_receptive_field_beyond_the_window_is_refused() {
        assert_eq!(refused("span = 27", "span = 30"), "student.span");
    }

    #[test]
    fn a_span_of_zero_is_refused() {
        assert_eq!(refused("span = 27", "span = 0"), "student.span");
    }

    #[test]
    fn a_patch_that_does_not_divide_the_window_is_refused() {
        assert_eq!(refused("patch = 20", "patch = 7"), "teacher.patch");
        assert_eq!(refused("patch = 20", "patch = 0"), "teacher.patch");
    }

    #[test]
    fn a_receptive_field_beyond_all_numbers_is_refused() {
        assert_eq!(
            refused(
                "layers = 2\nspan = 27",
                "layers = 9\nspan = 4611686018427387904"
            ),
            "student.span"
        );
    }

    #[test]
    fn numbers_that_no_training_survives_are_refused() {
        for (from, to, key) in [
            ("dropout = 0.15", "dropout = nan", "teacher.dropout"),
            (
                "weight_decay = 0.01",
                "weight_decay = nan",
                "teacher_training.weight_decay",
            ),
            (
                "warm-up = 0.05",
                "warm-up = -1.0",
                "teacher_training.lr_schedule",
            ),
            ("warm_up = 0.05", "warm_up = inf", "distillation.warm_up"),
            ("alpha = 8.0", "alpha = nan", "fine_tuning.lora.alpha"),
            (
                "rank = 16",
                "rank = 9223372036854775807",
                "fine_tuning.lora.rank",
            ),
            (
                "feed_forward = 256",
                "feed_forward = 0",
                "teacher.feed_forward",
            ),
            (
                "temperature = 2.0",
                "temperature = 2.0\nensemble = { members = 9, epochs = 3 }",
                "distillation.ensemble",
            ),
            (
                "temperature = 2.0",
                "temperature = 2.0\nensemble = { members = 2, epochs = 1000001 }",
                "distillation.ensemble.epochs",
            ),
            (
                "temperature = 2.0",
                "temperature = 2.0\nrow_weights = [1.0, 1.0, 1.0, 1.0, 1.0, -1.0]",
                "distillation.row_weights",
            ),
            (
                "temperature = 2.0",
                "temperature = 2.0\nrow_weights = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]",
                "distillation.row_weights",
            ),
        ] {
            assert_eq!(refused(from, to), key, "{to}");
        }
    }
}
