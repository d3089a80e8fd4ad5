//! Validity of the values of a preset.

mod memory;

use shared::intent::Vocabulary;
use shared::units::{LOOK_BACK, PATCH, WINDOW, WINDOW_PATCHES};

use super::Preset;
use crate::augmentation::Augmentation;
use crate::distillation::MEMBERS;
use crate::training::LrSchedule;
use memory::LIMIT;

/// Maximum seconds of spliced recordings of a subject.
const DAY: f64 = 86_400.0;

/// Maximum standard deviation of the logarithm of a gain: a factor of 20.
const MOST_DEVIATION: f64 = 3.0;
/// Smallest number above 0, and largest below 1.
const ABOVE_0: f64 = 0.0_f64.next_up();
const BELOW_1: f64 = 1.0_f64.next_down();

/// Smallest and largest valid value of each number that has bounds of its own. With a rate, share or decay beyond them a
/// training runs, but never yields a model: 1e30 is the largest rate that single precision holds with room for a step.
/// No layer is as wide as the largest rank.
#[rustfmt::skip]
const BOUNDS: [(&str, f64, f64, &str); 28] = [
    ("teacher.window", (LOOK_BACK * PATCH) as f64, WINDOW as f64, "60 to 600 samples"),
    ("teacher.layers", 1.0, f64::MAX, "1 or more"),
    ("teacher.feed_forward", 1.0, f64::MAX, "1 or more"),
    ("teacher.dropout", 0.0, BELOW_1, "0 or more, below 1"),
    ("teacher.attention_dropout", 0.0, BELOW_1, "0 or more, below 1"),
    ("teacher_training.ema_decay", 0.0, BELOW_1, "0 or more, below 1"),
    ("teacher_training.learning_rate", ABOVE_0, 1e30, "above 0, at most 1e30"),
    ("teacher_training.weight_decay", 0.0, 1.0, "0 to 1"),
    ("teacher_training.epochs", 1.0, 1e6, "1 to 1000000"),
    ("teacher_training.lora.rank", 1.0, 1024.0, "1 to 1024"),
    ("teacher_training.lora.alpha", ABOVE_0, 1e6, "above 0, at most 1000000"),
    ("fine_tuning.learning_rate", ABOVE_0, 1e30, "above 0, at most 1e30"),
    ("fine_tuning.lora_learning_rate", ABOVE_0, 1e30, "above 0, at most 1e30"),
    ("fine_tuning.epochs", 0.0, 1e6, "at most 1000000"),
    ("fine_tuning.lora.rank", 1.0, 1024.0, "1 to 1024"),
    ("fine_tuning.lora.alpha", ABOVE_0, 1e6, "above 0, at most 1000000"),
    ("distillation.learning_rate", ABOVE_0, 1e30, "above 0, at most 1e30"),
    ("distillation.weight_decay", 0.0, 1.0, "0 to 1"),
    ("distillation.warm_up", 0.0, 1.0, "a warm-up of 0 to 1, the share of the steps"),
    ("distillation.epochs", 1.0, 1e6, "1 to 1000000"),
    ("distillation.ensemble.epochs", 1.0, 1e6, "1 to 1000000"),
    ("distillation.teacher_share", 0.0, 1.0, "0 to 1"),
    ("distillation.temperature", ABOVE_0, f64::MAX, "a positive number"),
    ("distillation.ema_decay", 0.0, BELOW_1, "0 or more, below 1"),
    ("data.held_out_share", 0.0, BELOW_1, "0 or more, below 1"),
    ("data.validation_share", 0.0, BELOW_1, "0 or more, below 1"),
    ("data.daily_life", 0.0, 0.9, "0 to 0.9"),
    ("data.balance", 0.0, 1.0, "0 to 1"),
];

/// A value that a run cannot use.
#[derive(Debug, thiserror::Error)]
#[error("{key} is {found}, expected {expected}")]
pub struct Invalid {
    key: &'static str,
    /// Value that was found.
    found: String,
    /// Valid values.
    expected: &'static str,
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
        let Self {
            teacher,
            teacher_training: training,
            student,
            distillation,
            data,
            ..
        } = self;
        let warm_up = match training.lr_schedule {
            LrSchedule::WarmUp(share) => share,
            LrSchedule::Constant => 0.0,
        };
        let is_extreme =
            |own: &&Augmentation| !(0.0..=MOST_DEVIATION).contains(&own.gain) || own.rotation > 3;
        let augmentations = [&training.augmentation, &distillation.augmentation];
        let extreme = augmentations.into_iter().flatten().find(is_extreme);
        let reaction = self.smoother.reaction.unwrap_or_default();
        let seconds = data.spliced_seconds;
        let conditions = [
            require(
                Vocabulary::with_classes(self.classes).is_some(),
                "classes",
                self.classes,
                "3, 5 or 6",
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
            require(
                training.stride > 0 && training.batch > 0,
                "teacher_training",
                0,
                "stride and batch of 1 or more",
            ),
            require(
                !training.tasks.is_empty(),
                "teacher_training.tasks",
                &training.tasks,
                "one task or more",
            ),
            require(
                (0.0..=1.0).contains(&warm_up),
                "teacher_training.lr_schedule",
                warm_up,
                "a warm-up of 0 to 1, the share of the steps",
            ),
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
            require(
                distillation.patches > student.span
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
            extreme.and_then(|found| {
                let expected = "gain of 0 to 3, rotation of 0 to 3";
                require(false, "augmentation", found, expected)
            }),
            require(
                self.other() || reaction.other.is_none(),
                "smoother.reaction",
                reaction.to_string(),
                "a margin over other movement only with data.other_movement = \"class\"",
            ),
            require(
                (0.0..=DAY).contains(&seconds) && (seconds >= 10.0 || data.as_published),
                "data.spliced_seconds",
                seconds,
                "10 to 86400, or as_published = true",
            ),
        ];
        let mut unmet = conditions.into_iter().flatten();
        unmet
            .next()
            .or_else(|| self.beyond_bounds())
            .or_else(|| self.too_large())
    }

    /// The first number beyond its bounds, if there is one.
    fn beyond_bounds(&self) -> Option<Invalid> {
        let written = match toml::Value::try_from(self) {
            Ok(written) => written,
            Err(error) => return require(false, "preset", error, "values that TOML has"),
        };
        BOUNDS.iter().find_map(|&(key, least, most, expected)| {
            let mut parts = key.split('.');
            let value = parts.try_fold(&written, |table, part| table.get(part))?;
            let float = value.as_float();
            let number = float.or_else(|| value.as_integer().map(|whole| whole as f64))?;
            let found = float.map_or_else(|| value.to_string(), |float| format!("{float:?}"));
            (!(least..=most).contains(&number)).then_some(Invalid {
                key,
                found,
                expected,
            })
        })
    }

    /// The first size that no memory holds, if there is one.
    fn too_large(&self) -> Option<Invalid> {
        let memory = |key, bytes: f64| {
            (bytes > LIMIT).then(|| Invalid {
                key,
                found: format!("of about {:.0} GiB", bytes / f64::from(1 << 30)),
                expected: "a step of 64 GiB at most: smaller dimensions or a smaller batch",
            })
        };
        memory("teacher", self.teacher_bytes()).or_else(|| memory("student", self.student_bytes()))
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
            Err(PresetError::Value { value, .. }) => value.key,
            other => panic!("{other:?}"),
        }
    }

    /// The key that is refused, a text of the preset, and what takes its place.
    const REFUSED: &str = "\
student.span | span = 27 | span = 30
student.span | span = 27 | span = 0
student.span | layers = 2 ; span = 27 | layers = 9 ; span = 4611686018427387904
teacher.patch | patch = 20 | patch = 7
teacher.patch | patch = 20 | patch = 0
teacher.dropout | dropout = 0.15 | dropout = nan
teacher_training.weight_decay | weight_decay = 0.01 | weight_decay = nan
teacher_training.lr_schedule | warm-up = 0.05 | warm-up = -1.0
distillation.warm_up | warm_up = 0.05 | warm_up = inf
fine_tuning.lora.alpha | alpha = 8.0 | alpha = nan
fine_tuning.lora.rank | rank = 16 | rank = 9223372036854775807
teacher.feed_forward | feed_forward = 256 | feed_forward = 0
teacher | feed_forward = 256 | feed_forward = 4000000000000
student | patches = 100 | patches = 100000000000
data.spliced_seconds | spliced_seconds = 180.0 | spliced_seconds = 1e15
teacher_training.epochs | epochs = 5 | epochs = 9000000000000000000
distillation.ensemble | temperature = 2.0 | temperature = 2.0 ; ensemble = { members = 9, epochs = 3 }
distillation.ensemble.epochs | temperature = 2.0 | temperature = 2.0 ; ensemble = { members = 2, epochs = 1000001 }";

    #[test]
    fn values_that_no_training_or_model_survives_are_refused() {
        for case in REFUSED.lines() {
            let parts: Vec<String> = case
                .split(" | ")
                .map(|part| part.replace(" ; ", "\n"))
                .collect();
            assert_eq!(refused(&parts[1], &parts[2]), parts[0], "{case}");
        }
    }
}
