//! The first openings of the hand in a person's recordings, as a stream that an armband would send.

use std::ops::Range;

use shared::intent::Intent;
use shared::stream::alignment::{Aligner, AlignmentOutcome, AlignmentProgress, Arm, Template};
use shared::stream::preprocess::{Median, clean};
use shared::units::{PATCH, Sample};

use crate::labels::runs::{Run, runs};

/// Maximum number of openings that are tried: a wearer repeats a gesture that was not noticed.
const MOST: usize = 4;
/// Shortest run of a label that counts as a gesture, in samples: 0.3 s.
const SHORTEST: usize = 60;
/// Samples taken on either side of a gesture, 0.5 s: people move earlier or later than their labels.
const AROUND: usize = 100;
/// Samples of rest before, between and after the gestures: 1 s. The rest in published recordings varies.
const REST: usize = 200;

/// A person's openings of the hand, and their places in the recordings.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Openings {
    /// Samples of rest that separate the gestures.
    rest: Vec<Sample>,
    /// Samples of each gesture, with those on either side of it.
    gestures: Vec<Vec<Sample>>,
    /// Recording and range of samples of each gesture.
    places: Vec<(usize, Range<usize>)>,
}

/// The first openings of one person, by lag-compensated labels; none if the recordings hold fewer than two, or no
/// second of rest.
pub fn openings(recordings: &[(&[Sample], &[Option<Intent>])]) -> Option<Openings> {
    let labelled = |wanted: Intent, shortest: usize| {
        let recordings = recordings.iter().enumerate();
        let all = recordings.flat_map(|(at, (_, labels))| {
            let runs = runs(labels).into_iter();
            runs.map(move |run| (at, run))
        });
        all.filter(move |(_, run)| run.label == Some(wanted) && run.samples() >= shortest)
    };
    let (at, Run { start, .. }) = labelled(Intent::Relax, REST).next()?;
    let rest = recordings[at].0[start..start + REST].to_vec();
    let places: Vec<(usize, Range<usize>)> = labelled(Intent::Open, SHORTEST)
        .take(MOST)
        .map(|(at, run)| {
            let end = (run.end + AROUND).min(recordings[at].0.len());
            (at, run.start.saturating_sub(AROUND)..end)
        })
        .collect();
    let gesture = |(at, range): &(usize, Range<usize>)| recordings[*at].0[range.clone()].to_vec();
    let gestures: Vec<Vec<Sample>> = places.iter().map(gesture).collect();
    (gestures.len() >= usize::from(shared::stream::alignment::GESTURES)).then_some(Openings {
        rest,
        gestures,
        places,
    })
}

impl Openings {
    /// The samples that the armband would send: rest, each gesture with rest behind it, and rest until the last one is
    /// decided.
    pub fn stream(&self) -> Vec<Sample> {
        let mut stream = self.rest.clone();
        for gesture in &self.gestures {
            stream.extend(gesture);
            stream.extend(&self.rest);
        }
        stream.extend(&self.rest);
        stream
    }

    /// Number of openings that begin within the first `samples` of the stream.
    pub fn within(&self, samples: usize) -> usize {
        let mut begins = self.rest.len();
        let begun = self.gestures.iter().take_while(|gesture| {
            let has_begun = begins < samples;
            begins += gesture.len() + self.rest.len();
            has_begun
        });
        begun.count()
    }

    /// Outcome of these openings with a template and no model: where both arms fit nearly equally well, the nearest fit
    /// is taken. A timeout if there are too few openings.
    pub fn outcome(&self, template: &Template) -> AlignmentOutcome {
        let emg: Vec<_> = clean(self.stream(), Median::Three).collect();
        let mut aligner = Aligner::new(Arm::Unknown);
        for patch in emg.as_chunks::<PATCH>().0 {
            match aligner.push(patch, template) {
                AlignmentProgress::Waiting | AlignmentProgress::Gesture => {}
                AlignmentProgress::Undecided(decision) => {
                    return AlignmentOutcome::Aligned(decision.fits().nearest);
                }
                AlignmentProgress::Done(outcome) => return outcome,
            }
        }
        AlignmentOutcome::Timeout
    }

    /// The samples of a recording that are part of the first `count` openings.
    pub fn used(&self, recording: usize, count: usize) -> impl Iterator<Item = Range<usize>> {
        self.places
            .iter()
            .take(count)
            .filter(move |(at, _)| *at == recording)
            .map(|(_, range)| range.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{O, R, labels};
    use shared::stream::alignment::Alignment;

    /// Rest and gestures in turn, 300 samples each; the sign changes so that the mean is 0.
    fn recording(gestures: usize, open: Sample) -> (Vec<Sample>, Vec<Option<Intent>>) {
        let all = [[([2; 8], R), (open, O)].repeat(gestures), vec![([2; 8], R)]].concat();
        let runs: Vec<_> = all.into_iter().map(|own| (own, 300)).collect();
        labels(&runs).into_iter().unzip()
    }

    #[test]
    fn openings_are_found_and_align() {
        // The diagonal, 2 nats per square octave.
        let diagonal = [0, 8, 15, 21, 26, 30, 33, 35];
        let precision = std::array::from_fn(|at| 128 * i16::from(diagonal.contains(&at)));
        let means = [400, 290, 170, 60, -60, -170, -290, -400];
        let template = Template::new(means, precision).unwrap();
        let worn = Alignment::new(3, true);
        let (samples, labels) = recording(6, worn.inverse().apply([58, 43, 31, 22, 16, 12, 8, 6]));
        let own = openings(&[(&samples, &labels)]).unwrap();
        match own.outcome(&template) {
            AlignmentOutcome::Aligned(fit) => assert_eq!(fit.alignment, worn),
            other => panic!("{other:?}"),
        }
        // A second of rest, then gestures of 500 samples with a second behind each.
        assert_eq!(own.stream().len(), 200 + 4 * 700 + 200);
        let within = [200, 201, 900, 901, 9999].map(|end| own.within(end));
        assert_eq!(within, [0, 1, 1, 2, 4]);
        let used: Vec<_> = own.used(0, 3).collect();
        assert_eq!(used, [200..700, 800..1300, 1400..1900]);
        assert_eq!(own.used(1, 3).count(), 0);
    }

    #[test]
    fn one_opening_or_no_rest_is_too_little() {
        let (samples, labels) = recording(1, [50; 8]);
        assert_eq!(openings(&[(&samples, &labels)]), None);
        let (samples, labels) = recording(3, [50; 8]);
        let restless = labels.iter().map(|&label| label.filter(|_| label == O));
        let restless: Vec<_> = restless.collect();
        assert_eq!(openings(&[(&samples, &restless)]), None);
    }
}
