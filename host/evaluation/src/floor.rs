//! Floors: baselines without a model, evaluated beside the models for comparison.

use shared::intent::{Intent, MAX_CLASSES};
use shared::model::LookBackLogits;
use shared::units::{CHANNELS, CleanSample, PATCH};

use super::candidate::Candidate;
use super::evaluated_recording::EvaluatedRecording;
use super::system::System;

/// Samples that the energy is a mean over: 200 ms.
const SPAN: usize = 40;
/// Number of thresholds that are tried: 0.5 to 64 counts in steps of 9 %.
const THRESHOLDS: i32 = 56;

/// Candidate that always says relax.
pub fn constant(recordings: &[EvaluatedRecording]) -> Candidate {
    candidate(System::Constant, recordings, |_| Intent::Relax)
}

/// Energy detector: one active class above a threshold of the amplitude, else relax.
///
/// The amplitude at a patch is the mean over the channels and over the newest 200 ms of the cleaned samples, 0 to 128;
/// at the start of a recording, over the samples so far. Two numbers are fitted, to training people only: the
/// threshold, and the active class.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct EnergyDetector {
    /// Amplitude from which on a patch is active, in counts of the armband.
    pub threshold: f64,
    /// The label of an active patch.
    pub active: Intent,
}

impl Default for EnergyDetector {
    /// Detector fitted to the training people of the shipped model, for evaluations without training people.
    fn default() -> Self {
        Self {
            threshold: threshold(20),
            active: Intent::Close,
        }
    }
}

impl EnergyDetector {
    /// Fits the detector to training people, with their lag-compensated labels: the threshold with the best mean over
    /// people of (recall of relax + recall of active) / 2, the lowest on ties, and the active class that is the
    /// most frequent, the lowest on ties. None without a person who has both relax and a gesture.
    pub fn fit(training: &[EvaluatedRecording]) -> Option<Self> {
        let mut classes = [0_usize; MAX_CLASSES];
        // For each person, patches of relax and of gestures by the number of thresholds that they reach.
        let mut people: Vec<(&str, [Vec<usize>; 2])> = Vec::new();
        for recording in training {
            let place = people.iter().position(|(who, _)| *who == recording.subject);
            let place = place.unwrap_or_else(|| {
                let none = || vec![0; THRESHOLDS as usize + 1];
                people.push((&recording.subject, [none(), none()]));
                people.len() - 1
            });
            for (patch, energy) in energies(&recording.emg).into_iter().enumerate() {
                let label = recording.lag_compensated.get(patch * PATCH + PATCH - 1);
                let Some(label) = label.copied().flatten() else {
                    continue;
                };
                let reached = (0..THRESHOLDS).take_while(|&step| energy >= threshold(step));
                let active = label != Intent::Relax;
                people[place].1[usize::from(active)][reached.count()] += 1;
                classes[label.class()] += usize::from(active);
            }
        }
        let people: Vec<&[Vec<usize>; 2]> = people
            .iter()
            .map(|(_, counts)| counts)
            .filter(|counts| {
                counts
                    .iter()
                    .all(|own| own.iter().any(|&patches| patches > 0))
            })
            .collect();
        if people.is_empty() {
            return None;
        }
        // A patch is active at step k if it reaches more than k thresholds.
        let share = |counts: &[usize]| counts.iter().sum::<usize>() as f64;
        let recalls = |step: i32| {
            let from = step as usize + 1;
            let of = |[rest, active]: &&[Vec<usize>; 2]| {
                share(&rest[..from]) / share(rest) + share(&active[from..]) / share(active)
            };
            people.iter().map(of).sum::<f64>()
        };
        let best = (0..THRESHOLDS).fold(0, |best, step| {
            if recalls(step) > recalls(best) {
                step
            } else {
                best
            }
        });
        let most = classes.iter().max().copied()?;
        let active = classes.iter().position(|&count| count == most)?;
        Some(Self {
            threshold: threshold(best),
            active: Intent::from_class(active)?,
        })
    }

    /// The detector as a candidate, under the device's smoother and without look-ahead.
    pub fn candidate(&self, recordings: &[EvaluatedRecording]) -> Candidate {
        candidate(System::Energy, recordings, |energy| {
            if energy >= self.threshold {
                self.active
            } else {
                Intent::Relax
            }
        })
    }
}

fn threshold(step: i32) -> f64 {
    0.5 * 2.0_f64.powf(f64::from(step) / 8.0)
}

/// Mean over channels and over the newest 40 samples, at every whole patch.
fn energies(emg: &[CleanSample]) -> Vec<f64> {
    (1..=emg.len() / PATCH)
        .map(|patch| {
            let end = patch * PATCH;
            let samples = &emg[end.saturating_sub(SPAN)..end];
            let sum: u32 = samples.as_flattened().iter().map(|&v| u32::from(v)).sum();
            f64::from(sum) / (samples.len() * CHANNELS) as f64
        })
        .collect()
}

/// A candidate whose newest row of logits is 1 for the label and 0 for all others.
fn candidate(
    floor: System,
    recordings: &[EvaluatedRecording],
    label: impl Fn(f64) -> Intent,
) -> Candidate {
    let logits = |recording: &EvaluatedRecording| {
        let labels = energies(&recording.emg).into_iter().map(&label);
        labels
            .map(|label| {
                let mut rows = LookBackLogits::default();
                rows[0][label.class()] = 1.0;
                rows
            })
            .collect()
    };
    Candidate::without_margins(floor, false, recordings.iter().map(logits).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(subject: &str, patches: &[(u8, Option<Intent>)]) -> EvaluatedRecording {
        let samples = |value: u8| std::iter::repeat_n([value; CHANNELS], PATCH);
        let labels = |label: Option<Intent>| std::iter::repeat_n(label, PATCH);
        EvaluatedRecording {
            emg: patches.iter().flat_map(|&(v, _)| samples(v)).collect(),
            lag_compensated: patches.iter().flat_map(|&(_, l)| labels(l)).collect(),
            ..EvaluatedRecording::made_up(subject, &[])
        }
    }

    fn steady(level: u8, label: Intent) -> Vec<(u8, Option<Intent>)> {
        vec![(level, Some(label)); 40]
    }

    #[test]
    fn the_detector_separates_rest_from_gestures_and_says_the_most_frequent_one() {
        let close = steady(20, Intent::Close);
        let training = [
            recording(
                "a",
                &[steady(2, Intent::Relax), steady(30, Intent::Open)].concat(),
            ),
            recording("b", &[steady(4, Intent::Relax), close.clone()].concat()),
            recording("b", &close),
        ];
        let detector = EnergyDetector::fit(&training).unwrap();
        assert_eq!(detector.active, Intent::Close);
        assert!((4.0..=20.0).contains(&detector.threshold), "{detector:?}");
        let candidate = detector.candidate(&training[..1]);
        let label = |rows: &LookBackLogits| rows[0].iter().position(|&logit| logit == 1.0);
        let labels: Vec<usize> = candidate.logits[0].iter().filter_map(label).collect();
        assert_eq!(labels[..40], [0; 40]);
        assert_eq!(labels[44..], [2; 36]);
        assert_eq!(EnergyDetector::fit(&training[2..]), None);
    }

    #[test]
    fn the_constant_says_relax_in_every_patch() {
        let recordings = [recording("a", &steady(50, Intent::Close))];
        let constant = constant(&recordings);
        assert!(!constant.looks_back);
        assert_eq!(constant.logits[0].len(), 40);
        let relax = |rows: &LookBackLogits| rows[0][0] == 1.0 && rows[0][1..] == [0.0; 6];
        assert!(constant.logits[0].iter().all(relax));
    }

    #[test]
    fn the_threshold_is_the_best_over_people_each_of_whom_counts_once() {
        let person = |name, rest, gesture, times: usize| {
            let both = [steady(rest, Intent::Relax), steady(gesture, Intent::Open)].concat();
            recording(name, &both.repeat(times))
        };
        let people = [
            person("a", 2, 30, 1),
            person("b", 10, 12, 1),
            person("c", 10, 12, 1),
            // However long the recording is, their threshold is not everybody's.
            person("d", 15, 20, 9),
        ];
        let threshold = |people: &[_]| EnergyDetector::fit(people).unwrap().threshold;
        assert!((10.0..=12.0).contains(&threshold(&people)));
        assert!((15.0..=20.0).contains(&threshold(&people[3..])));
    }
}
