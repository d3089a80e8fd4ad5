//! Validity of rates, shares and decays: with a wrong one a training runs, but never yields a model.

use super::{Invalid, require};
use crate::Preset;
use crate::teacher::LoraConfig;
use crate::training::LrSchedule;

/// Largest learning rate that single precision holds with room for a step. A training that diverges with less is
/// stopped by its loss.
const MOST_RATE: f64 = 1e30;
/// Largest rank of adapters: more than any layer is wide.
const MOST_RANK: usize = 1024;

impl Preset {
    /// The first number that no training survives, if there is one.
    pub(super) fn invalid_numbers(&self) -> Option<Invalid> {
        self.invalid_dropout()
            .or_else(|| self.invalid_rates())
            .or_else(|| self.invalid_warm_up())
            .or_else(|| {
                let keys = ["fine_tuning.lora.rank", "fine_tuning.lora.alpha"];
                invalid_lora(keys, &self.fine_tuning.lora)
            })
            .or_else(|| {
                let keys = ["teacher_training.lora.rank", "teacher_training.lora.alpha"];
                invalid_lora(keys, self.teacher_training.lora.as_ref()?)
            })
    }

    fn invalid_dropout(&self) -> Option<Invalid> {
        let teacher = &self.teacher;
        let shares = [
            ("teacher.dropout", teacher.dropout),
            ("teacher.attention_dropout", teacher.attention_dropout),
        ];
        shares.into_iter().find_map(|(key, share)| {
            require(
                (0.0..1.0).contains(&share),
                key,
                share,
                "0 or more, below 1",
            )
        })
    }

    fn invalid_rates(&self) -> Option<Invalid> {
        let (teacher, tuning) = (&self.teacher_training, &self.fine_tuning);
        let student = &self.distillation;
        let rates = [
            ("teacher_training.learning_rate", teacher.learning_rate),
            ("fine_tuning.learning_rate", tuning.learning_rate),
            ("fine_tuning.lora_learning_rate", tuning.lora_learning_rate),
            ("distillation.learning_rate", student.learning_rate),
        ];
        let rate = |(key, rate)| {
            require(
                rate > 0.0 && rate <= MOST_RATE,
                key,
                rate,
                "above 0, at most 1e30",
            )
        };
        let decays = [
            ("teacher_training.weight_decay", teacher.weight_decay),
            ("distillation.weight_decay", student.weight_decay),
        ];
        let decay = |(key, decay)| require((0.0..=1.0).contains(&decay), key, decay, "0 to 1");
        let rates = rates.into_iter().find_map(rate);
        rates.or_else(|| decays.into_iter().find_map(decay))
    }

    fn invalid_warm_up(&self) -> Option<Invalid> {
        let teacher = match self.teacher_training.lr_schedule {
            LrSchedule::WarmUp(share) => share,
            LrSchedule::Constant => 0.0,
        };
        let shares = [
            ("teacher_training.lr_schedule", teacher),
            ("distillation.warm_up", self.distillation.warm_up),
        ];
        let share = |(key, share)| {
            let expected = "a warm-up of 0 to 1, the share of the steps";
            require((0.0..=1.0).contains(&share), key, share, expected)
        };
        shares.into_iter().find_map(share)
    }
}

fn invalid_lora([rank, alpha]: [&'static str; 2], lora: &LoraConfig) -> Option<Invalid> {
    let ranks = 1..=MOST_RANK;
    require(ranks.contains(&lora.rank), rank, lora.rank, "1 to 1024").or_else(|| {
        let valid = lora.alpha > 0.0 && lora.alpha <= 1e6;
        require(valid, alpha, lora.alpha, "above 0, at most 1000000")
    })
}
