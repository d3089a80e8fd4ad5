//! Teachers of the paper's tables: the preset's own, with other windows, and trained on other recordings.

use presets::Preset;
use presets::config::ResolvedConfig;
use recordings::{DataSet, Library};

/// Data set on which pre-training on all others is evaluated.
pub(crate) const TARGET: DataSet = DataSet::named("roshambo");

/// Teacher of the paper's tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PaperTeacher {
    /// Teacher of the preset.
    Whole,
    /// Teacher of the preset with a window of 100 samples.
    Window100,
    /// Teacher of the preset with a window of 300 samples.
    Window300,
    /// Teacher trained on [`TARGET`] alone.
    Scratch,
    /// Teacher trained on all other data sets.
    PreTrained,
    /// Teacher [`PaperTeacher::PreTrained`] of the same fold, fine-tuned on [`TARGET`].
    FineTuned,
    /// Teacher [`PaperTeacher::PreTrained`] of the same fold, fine-tuned with LoRA.
    Lora,
}

impl PaperTeacher {
    /// All teachers, each after the teacher that it starts from.
    pub(crate) const ALL: [Self; 7] = [
        Self::Whole,
        Self::Window100,
        Self::Window300,
        Self::Scratch,
        Self::PreTrained,
        Self::FineTuned,
        Self::Lora,
    ];

    /// Name in tables and on the command line.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Whole => "teacher",
            Self::Window100 => "teacher-window-100",
            Self::Window300 => "teacher-window-300",
            Self::Scratch => "teacher-scratch",
            Self::PreTrained => "teacher-pre-trained",
            Self::FineTuned => "teacher-fine-tuned",
            Self::Lora => "teacher-lora",
        }
    }

    /// Whether it is evaluated only on the people of [`TARGET`].
    pub(crate) const fn is_on_target(self) -> bool {
        !matches!(self, Self::Whole | Self::Window100 | Self::Window300)
    }

    /// Teacher that training starts from; none for random weights.
    pub(crate) const fn start(self) -> Option<Self> {
        match self {
            Self::FineTuned | Self::Lora => Some(Self::PreTrained),
            _ => None,
        }
    }

    /// Preset that it is trained by.
    pub(crate) fn preset(self, base: &Preset) -> Preset {
        let mut preset = base.clone();
        match self {
            Self::Whole => {}
            Self::Window100 => preset.teacher.window = 100,
            Self::Window300 => preset.teacher.window = 300,
            Self::Scratch => preset.data.data_sets = vec![TARGET],
            Self::PreTrained => {
                let wanted = &base.data.data_sets;
                let is_wanted = |set: &DataSet| {
                    wanted.contains(set) || wanted.is_empty() && set.trained_by_default()
                };
                let others = DataSet::all().filter(|set| *set != TARGET);
                preset.data.data_sets = others.filter(is_wanted).collect();
            }
            Self::FineTuned | Self::Lora => {
                preset.data.data_sets = vec![TARGET];
                preset = preset.fine_tuned(self == Self::Lora);
            }
        }
        preset
    }

    /// Teachers whose recordings are available: pre-training needs [`TARGET`] and another data set.
    pub(crate) fn possible(base: &Preset, library: &Library) -> Vec<Self> {
        let has_its_sets = |teacher: Self| {
            let preset = teacher.preset(base);
            // A preset without any of its sets takes all others.
            let labelled = ResolvedConfig::labelled(&preset, library).unwrap_or_default();
            let mut sets = labelled.iter().map(|recording| recording.data_set);
            !labelled.is_empty() && sets.all(|set| preset.data.data_sets.contains(&set))
        };
        let pre_training = has_its_sets(Self::Scratch) && has_its_sets(Self::PreTrained);
        let all = Self::ALL.into_iter();
        all.filter(|teacher| pre_training || !teacher.is_on_target())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baselines::settings::find_preset;

    #[test]
    fn every_teacher_has_a_valid_preset() {
        let (base, _) = find_preset("comparison").unwrap();
        for teacher in PaperTeacher::ALL {
            let text = teacher.preset(&base).to_toml();
            Preset::parse(teacher.name(), &text).unwrap();
        }
    }

    #[test]
    fn nobody_of_the_target_is_in_the_pre_training() {
        let (base, _) = find_preset("comparison").unwrap();
        let sets = PaperTeacher::PreTrained.preset(&base).data.data_sets;
        assert!(sets.len() > 5 && !sets.contains(&TARGET));
        assert!(!sets.contains(&DataSet::named("uci-gestures")));
        let mut two = base;
        two.data.data_sets = vec![TARGET, DataSet::named("ss-stm")];
        let sets = PaperTeacher::PreTrained.preset(&two).data.data_sets;
        assert_eq!(sets, [DataSet::named("ss-stm")]);
    }
}
