//! Lag compensation of one data set's labels: the way for each recording, and the people on whom a constant was
//! estimated.

use std::collections::BTreeMap;
use std::collections::BTreeSet;
use std::fmt;

use serde::{Deserialize, Serialize};
use shared::intent::Intent;
use shared::units::SAMPLE_PERIOD_MS;

use super::compensation::Compensation;
use super::lag::{LabelLag, LagEstimate, estimate};
use crate::catalogue::DataSet;
use crate::recording::{Recording, Timing};
use crate::split::predefined::PredefinedSplit;

/// People on whose recordings a constant lag was estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// The training people of the published recordings: the set's [nominal lag](DataSet::label_lag).
    #[default]
    Published,
    /// Number of training people.
    TrainingPeople(usize),
    /// Number of people at hand, for a user's own set without training people.
    PeopleAtHand(usize),
}

/// Numbers of recordings with movement, by way of compensation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CompensationCounts {
    /// Recordings compensated by each cue's own lag.
    pub each_cue: usize,
    /// Recordings compensated by the constant.
    pub constant: usize,
    /// Recordings that stay as they are, because their labels are the muscle's.
    pub muscle: usize,
}

/// Lag compensation of a data set's labels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lag {
    /// Compensation of labels that are cues with rest around them.
    pub compensation: Compensation,
    /// Lag of other cues, in samples, if those with rest are compensated by each cue's own lag; else 0.
    #[serde(default)]
    pub otherwise: usize,
    /// People on whose recordings the constant was estimated.
    #[serde(default)]
    pub basis: Basis,
    /// The measurement that gave the constant, if there is one.
    pub estimate: Option<LagEstimate>,
    /// Numbers of recordings, by way of compensation.
    #[serde(default)]
    pub recordings: CompensationCounts,
}

impl Lag {
    /// Lag compensation of a data set's labels. A constant is estimated on training people alone. Where there are none,
    /// a published set has its nominal one, and another set that of everybody at hand.
    pub fn of(
        data_set: DataSet,
        recordings: &[&Recording],
        label_lag: LabelLag,
        is_training: &dyn Fn(&str) -> bool,
    ) -> Self {
        // A recording without movement has nothing to compensate.
        let moving = recordings.iter().filter(|own| moves(own));
        let timed = |timing: Timing| moving.clone().filter(move |own| own.timing == timing);
        let rested = timed(Timing::RestAroundCues).count();
        let each_cue = label_lag == LabelLag::EachCue && rested > 0;
        let by_constant: Vec<&Recording> = timed(Timing::Cues)
            .chain(timed(Timing::RestAroundCues).filter(|_| !each_cue))
            .copied()
            .collect();
        let (mut basis, mut estimate, mut constant) = (Basis::default(), None, 0);
        if label_lag != LabelLag::None {
            (basis, estimate) = measured(data_set, &by_constant, is_training);
            constant = estimate.map_or(data_set.label_lag(), |found| found.lag_samples);
        }
        let (compensation, otherwise) = if each_cue {
            (Compensation::EachCue, constant)
        } else {
            (Compensation::Constant(constant), 0)
        };
        Self {
            compensation,
            otherwise,
            basis,
            estimate,
            recordings: CompensationCounts {
                each_cue: if each_cue { rested } else { 0 },
                constant: by_constant.len(),
                muscle: timed(Timing::Muscle).count(),
            },
        }
    }

    /// Compensation of one recording of the set.
    pub const fn of_recording(&self, recording: &Recording) -> Compensation {
        match (recording.timing, self.compensation) {
            (Timing::Muscle, _) => Compensation::NONE,
            (Timing::Cues, Compensation::EachCue) => Compensation::Constant(self.otherwise),
            (_, compensation) => compensation,
        }
    }

    /// Constant lag in samples, of labels that are not moved cue by cue.
    pub const fn constant(&self) -> usize {
        match self.compensation {
            Compensation::Constant(samples) => samples,
            Compensation::EachCue => self.otherwise,
        }
    }
}

/// Whether a recording has labels other than rest, or other movement.
fn moves(recording: &Recording) -> bool {
    let mut labels = recording.labels.iter().flatten();
    !recording.other_movement.is_empty() || labels.any(|&intent| intent != Intent::Relax)
}

/// People on whose recordings a constant was estimated, and the measurement if it is not the nominal one.
fn measured(
    data_set: DataSet,
    recordings: &[&Recording],
    is_training: &dyn Fn(&str) -> bool,
) -> (Basis, Option<LagEstimate>) {
    let of = |wanted: &dyn Fn(&str) -> bool| {
        let own = recordings.iter().filter(|own| wanted(&own.subject));
        own.copied().collect::<Vec<&Recording>>()
    };
    let people = |own: &[&Recording]| {
        let people: BTreeSet<&str> = own.iter().map(|own| own.subject.as_str()).collect();
        people.len()
    };
    let training = of(is_training);
    if let Some(found) = estimate(&training) {
        return (Basis::TrainingPeople(people(&training)), Some(found));
    }
    // Nobody in a user's own recordings has a role.
    if training.is_empty()
        && PredefinedSplit::of(data_set).is_none()
        && let Some(found) = estimate(recordings)
    {
        return (Basis::PeopleAtHand(people(recordings)), Some(found));
    }
    (Basis::Published, None)
}

impl fmt::Display for Lag {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ms = self.constant() * SAMPLE_PERIOD_MS as usize;
        let constant = match self.basis {
            Basis::Published if ms == 0 => "as recorded".to_owned(),
            Basis::Published => {
                format!("constant lag {ms} ms, of the training people of the published recordings")
            }
            Basis::TrainingPeople(people) => {
                let people = counted(people, "training person", "training people");
                format!("constant lag {ms} ms, estimated on {people}")
            }
            Basis::PeopleAtHand(people) => {
                let people = counted(people, "person", "people");
                format!(
                    "constant lag {ms} ms, estimated on {people} at hand, for want of training people"
                )
            }
        };
        let CompensationCounts {
            each_cue,
            constant: by_constant,
            muscle,
        } = self.recordings;
        let ways = [
            (each_cue, "each cue's own lag"),
            (by_constant, &constant),
            (muscle, "as recorded, where the muscle acts"),
        ];
        let used = ways.iter().filter(|(recordings, _)| *recordings > 0);
        let used: Vec<_> = used.collect();
        match (&used[..], self.compensation) {
            // No recording with movement, or a file of a version that did not count.
            ([], Compensation::EachCue) => formatter.write_str(ways[0].1),
            ([], Compensation::Constant(_)) => formatter.write_str(&constant),
            ([(_, way)], _) => formatter.write_str(way),
            (several, _) => {
                let each = several
                    .iter()
                    .map(|(recordings, way)| format!("{way} ({recordings} recordings)"));
                formatter.write_str(&each.collect::<Vec<_>>().join("; "))
            }
        }
    }
}

fn counted(count: usize, one: &str, several: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { several })
}

/// Lag compensation of each data set's labels; a constant is estimated on training people.
pub fn lags(
    recordings: &[&Recording],
    label_lag: LabelLag,
    is_training: &dyn Fn(&str) -> bool,
) -> BTreeMap<DataSet, Lag> {
    crate::by_data_set(recordings.iter().copied())
        .into_iter()
        .map(|(data_set, own)| (data_set, Lag::of(data_set, &own, label_lag, is_training)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Recording of a person whose muscle follows each cue `late` samples later.
    fn recording(data_set: DataSet, person: &str, late: usize, timing: Timing) -> Recording {
        Recording {
            data_set,
            subject: format!("{}/{person}", data_set.name()),
            timing,
            ..crate::labels::lag::tests::recording(late)
        }
    }

    fn lag(
        recordings: &[Recording],
        label_lag: LabelLag,
        is_training: &dyn Fn(&str) -> bool,
    ) -> Lag {
        let all: Vec<&Recording> = recordings.iter().collect();
        Lag::of(recordings[0].data_set, &all, label_lag, is_training)
    }

    #[test]
    fn a_constant_is_estimated_on_training_people_alone() {
        let people = [("01", 40), ("06", 100), ("03", 100)];
        let recordings = people
            .map(|(who, late)| recording(DataSet::named("roshambo"), who, late, Timing::Cues));
        let is_training = |subject: &str| subject == "roshambo/01";
        let found = lag(&recordings, LabelLag::Estimated, &is_training);
        assert!(found.constant().abs_diff(40) <= 5, "{found:?}");
        assert_eq!(found.basis, Basis::TrainingPeople(1));
        let told = found.to_string();
        assert!(told.ends_with("estimated on 1 training person"), "{told}");
        // Without training people: the nominal lag of the published set.
        let nobody = lag(&recordings[1..], LabelLag::Estimated, &is_training);
        assert_eq!(nobody.constant(), DataSet::named("roshambo").label_lag());
        assert_eq!((nobody.basis, nobody.estimate), (Basis::Published, None));
    }

    #[test]
    fn own_recordings_without_training_people_are_estimated_on_who_is_there_and_say_so() {
        let recordings = [recording(DataSet::OWN, "anna", 40, Timing::Cues)];
        let found = lag(&recordings, LabelLag::EachCue, &|_| false);
        assert_eq!(found.basis, Basis::PeopleAtHand(1));
        assert!(found.to_string().contains("1 person at hand"), "{found}");
        // In a run, held-out people do not enter the estimate.
        let late = recording(DataSet::OWN, "ben", 100, Timing::Cues);
        let both = [recordings[0].clone(), late];
        let run = lag(&both, LabelLag::EachCue, &|subject| subject == "own/anna");
        let training = Basis::TrainingPeople(1);
        assert_eq!((run.basis, run.constant()), (training, found.constant()));
    }

    #[test]
    fn every_recording_is_compensated_as_its_labels_ask_for() {
        let recordings = [Timing::RestAroundCues, Timing::Cues, Timing::Muscle]
            .map(|timing| recording(DataSet::OWN, "anna", 40, timing));
        let found = lag(&recordings, LabelLag::EachCue, &|_| false);
        let [rested, cues, muscle] = recordings.each_ref().map(|own| found.of_recording(own));
        let expected = (Compensation::EachCue, Compensation::NONE);
        assert_eq!((rested, muscle), expected);
        assert!(matches!(cues, Compensation::Constant(35..=45)));
        let told = found.to_string();
        let words = "each cue's own lag (1 recordings); constant lag";
        assert!(told.starts_with(words), "{told}");
        let none = lag(&recordings, LabelLag::None, &|_| false);
        let ways = recordings.map(|own| none.of_recording(&own));
        assert_eq!(ways, [Compensation::NONE; 3]);
        assert!(none.to_string().starts_with("as recorded"), "{none}");
    }
}
