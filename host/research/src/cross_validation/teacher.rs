//! The teachers of the paper's tables: that of a preset, with other windows, and with other recordings to learn from.

use presets::Preset;
use presets::config::ResolvedConfig;
use recordings::{DataSet, Library};

/// The data set that pre-training on all others is judged by.
pub(crate) const TARGET: DataSet = DataSet::Roshambo;

/// A teacher of the paper's tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PaperTeacher {
    /// The preset's.
    Whole,
    /// The preset's with a window of 100 samples.
    Window100,
    /// The preset's with a window of 300 samples.
    Window300,
    /// Trained on [`TARGET`] alone.
    Scratch,
    /// Trained on all other data sets.
    PreTrained,
    /// [`PaperTeacher::PreTrained`] of the same fold, fine-tuned on [`TARGET`].
    FineTuned,
    /// [`PaperTeacher::PreTrained`] of the same fold, fine-tuned with LoRA.
    Lora,
}

impl PaperTeacher {
    /// All, each behind the one that it starts from.
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

    /// Whether it is judged on the people of [`TARGET`] alone.
    pub(crate) const fn is_on_target(self) -> bool {
        !matches!(self, Self::Whole | Self::Window100 | Self::Window300)
    }

    /// The teacher that training starts from; none for random weights.
    pub(crate) const fn start(self) -> Option<Self> {
        match self {
            Self::FineTuned | Self::Lora => Some(Self::PreTrained),
            _ => None,
        }
    }

    /// The preset that it is trained by.
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
                let others = DataSet::ALL.into_iter().filter(|set| *set != TARGET);
                preset.data.data_sets = others.filter(is_wanted).collect();
            }
            Self::FineTuned | Self::Lora => {
                preset.data.data_sets = vec![TARGET];
                preset = preset.fine_tuned(self == Self::Lora);
            }
        }
        preset
    }

    /// The teachers whose recordings are at hand: without [`TARGET`], or with nothing else, there is no pre-training.
    pub(crate) fn possible(base: &Preset, library: &Library) -> Vec<Self> {
        let has_its_sets = |teacher: Self| {
            let preset = teacher.preset(base);
            // A preset whose sets are not there takes all others.
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
        assert!(!sets.contains(&DataSet::UciGestures));
        let mut two = base;
        two.data.data_sets = vec![TARGET, DataSet::SsStm];
        let sets = PaperTeacher::PreTrained.preset(&two).data.data_sets;
        assert_eq!(sets, [DataSet::SsStm]);
    }
}
