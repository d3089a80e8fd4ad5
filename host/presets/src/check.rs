//! Validity of the values of a preset.

mod memory;

use shared::intent::Vocabulary;
use shared::units::{LOOK_BACK, PATCH, WINDOW, WINDOW_PATCHES};

use super::Preset;
use crate::distillation::MEMBERS;
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
const BOUNDS: [(&str, f64, f64, &str); 42] = [
    ("teacher.window", (LOOK_BACK * PATCH) as f64, WINDOW as f64, "60 to 600 samples"),
    ("teacher.d_model", 1.0, f64::MAX, "1 or more"),
    ("teacher.layers", 1.0, f64::MAX, "1 or more"),
    ("teacher.feed_forward", 1.0, f64::MAX, "1 or more"),
    ("teacher.dropout", 0.0, BELOW_1, "0 or more, below 1"),
    ("teacher.attention_dropout", 0.0, BELOW_1, "0 or more, below 1"),
    ("teacher_training.stride", 1.0, f64::MAX, "1 or more"),
    ("teacher_training.batch", 1.0, f64::MAX, "1 or more"),
    ("teacher_training.lr_schedule.warm-up", 0.0, 1.0, "0 to 1, the share of the steps"),
    ("teacher_training.augmentation.gain", 0.0, MOST_DEVIATION, "0 to 3"),
    ("teacher_training.augmentation.rotation", 0.0, 3.0, "0 to 3"),
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
    ("student.d_model", 1.0, f64::MAX, "1 or more"),
    ("student.span", 1.0, f64::MAX, "1 or more"),
    ("student.layers", 1.0, f64::MAX, "1 or more"),
    ("distillation.batch", 1.0, f64::MAX, "1 or more"),
    ("distillation.steps", 1.0, f64::MAX, "1 or more"),
    ("distillation.augmentation.gain", 0.0, MOST_DEVIATION, "0 to 3"),
    ("distillation.augmentation.rotation", 0.0, 3.0, "0 to 3"),
    ("distillation.ensemble.members", 2.0, MEMBERS.len() as f64, "2 to 8"),
    ("distillation.learning_rate", ABOVE_0, 1e30, "above 0, at most 1e30"),
    ("distillation.weight_decay", 0.0, 1.0, "0 to 1"),
    ("distillation.warm_up", 0.0, 1.0, "0 to 1, the share of the steps"),
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

impl Preset {
    /// The first invalid value, if there is one.
    pub(super) fn invalid(&self) -> Option<Invalid> {
        let written = match toml::Value::try_from(self) {
            Ok(written) => written,
            Err(error) => {
                return Some(Invalid {
                    key: "preset",
                    found: error.to_string(),
                    expected: "values that TOML has",
                });
            }
        };
        let value = |key: &str| value(&written, key);
        let is_beyond = |&&(key, least, most, _): &&(&str, f64, f64, &str)| {
            let number = value(key).and_then(|own| {
                let whole = || own.as_integer().map(|whole| whole as f64);
                own.as_float().or_else(whole)
            });
            number.is_some_and(|number| !(least..=most).contains(&number))
        };
        let beyond = || BOUNDS.iter().find(is_beyond).map(|own| (own.0, own.3));
        let (key, expected) = match self.contradiction().or_else(beyond) {
            Some(found) => found,
            None => return self.too_large(),
        };
        let found = value(key).map(|own| match own.as_float() {
            Some(float) => format!("{float:?}"),
            None => own.to_string(),
        });
        Some(Invalid {
            key,
            found: found.unwrap_or_default(),
            expected,
        })
    }

    /// The first value that does not go with others, and what does.
    fn contradiction(&self) -> Option<(&'static str, &'static str)> {
        let (teacher, student, data) = (&self.teacher, &self.student, &self.data);
        let distillation = &self.distillation;
        let divides = |part: usize, whole: usize| part > 0 && whole.is_multiple_of(part);
        let has_margin = || {
            self.smoother
                .reaction
                .is_some_and(|own| own.other.is_some())
        };
        let (least, most) = (if data.as_published { 0.0 } else { 10.0 }, DAY);
        #[rustfmt::skip]
        let conditions = [
            (Vocabulary::with_classes(self.classes).is_some(), "classes", "3, 5 or 6"),
            (divides(teacher.patch, teacher.window), "teacher.patch", "a divisor of the window"),
            (divides(teacher.heads, teacher.d_model), "teacher.heads", "a divisor of d_model"),
            (!self.teacher_training.tasks.is_empty(), "teacher_training.tasks", "one task or more"),
            (divides(student.heads, student.d_model), "student.heads", "a divisor of d_model"),
            (student.receptive_field() <= WINDOW_PATCHES + 1 - LOOK_BACK, "student.span",
                "a span of which layers * (span - 1) + 1 is 55 patches at most"),
            (distillation.patches > student.span, "distillation.patches", "more than the span"),
            (!self.other() || !distillation.needs_teacher(), "distillation.teacher_share",
                "0, or an ensemble, with data.other_movement = \"class\", which no teacher knows"),
            (self.other() || !has_margin(), "smoother.reaction",
                "a margin over other movement only with data.other_movement = \"class\""),
            ((least..=most).contains(&data.spliced_seconds), "data.spliced_seconds",
                "10 to 86400, or as_published = true"),
        ];
        let mut unmet = conditions.into_iter().filter(|(is_met, ..)| !is_met);
        unmet.next().map(|(_, key, expected)| (key, expected))
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

/// The value of a key such as `student.span`; none where a preset leaves it out.
fn value<'w>(written: &'w toml::Value, key: &str) -> Option<&'w toml::Value> {
    let mut parts = key.split('.');
    parts.try_fold(written, |table, part| table.get(part))
}

#[cfg(test)]
mod tests {
    use super::{BOUNDS, value};
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
teacher_training.lr_schedule.warm-up | warm-up = 0.05 | warm-up = -1.0
distillation.warm_up | warm_up = 0.05 | warm_up = inf
fine_tuning.lora.alpha | alpha = 8.0 | alpha = nan
fine_tuning.lora.rank | rank = 16 | rank = 9223372036854775807
teacher.feed_forward | feed_forward = 256 | feed_forward = 0
teacher | feed_forward = 256 | feed_forward = 4000000000000
student | patches = 100 | patches = 100000000000
data.spliced_seconds | spliced_seconds = 180.0 | spliced_seconds = 1e15
teacher_training.epochs | epochs = 5 | epochs = 9000000000000000000
distillation.ensemble.members | temperature = 2.0 | temperature = 2.0 ; ensemble = { members = 9, epochs = 3 }
distillation.ensemble.epochs | temperature = 2.0 | temperature = 2.0 ; ensemble = { members = 2, epochs = 1000001 }";

    #[test]
    fn each_bound_is_of_a_number_that_presets_have() {
        let more = "
            [teacher_training]
            ema_decay = 0.9
            augmentation = { gain = 0.1, rotation = 1 }
            lora = { rank = 4, alpha = 8.0 }
            [distillation]
            ema_decay = 0.9
            augmentation = { gain = 0.1, rotation = 1 }
            ensemble = { members = 2, epochs = 3 }
            [data]
            daily_life = 0.1";
        let mut written: toml::Table = BUILT_IN[0].1.parse().unwrap();
        for (section, more) in more.parse::<toml::Table>().unwrap() {
            let own = written.get_mut(&section).and_then(|own| own.as_table_mut());
            own.unwrap().extend(more.as_table().unwrap().clone());
        }
        let preset = Preset::parse("whole", &toml::to_string(&written).unwrap()).unwrap();
        let written = toml::Value::try_from(&preset).unwrap();
        for (key, ..) in BOUNDS {
            let own = value(&written, key);
            let is_number = own.is_some_and(|own| own.is_float() || own.is_integer());
            assert!(is_number, "{key}: {own:?}");
        }
    }

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
