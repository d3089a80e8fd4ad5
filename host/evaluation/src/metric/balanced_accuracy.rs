//! Balanced accuracy = mean over the classes in the truth of: samples of the class that are predicted as it /
//! samples of the class.
//!
//! The inner fraction is the recall of a class. A prediction of one label has 1 / classes, however frequent that
//! label is in the truth; raw accuracy would be its frequency. The samples of all recordings of a subject are
//! pooled before the recalls are computed, because single recordings often hold a single class. A truth of one class
//! has no balanced accuracy: a constant would have 1 on it.
//!
//! Raw accuracy = samples whose prediction equals the truth / labelled samples.
//!
//! Source: Brodersen et al., *The balanced accuracy and its posterior distribution*, ICPR 2010.

use shared::intent::{Intent, MAX_CLASSES};

use crate::EvaluationError;

/// Samples of each class, and how many of them are predicted as it.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Recalls {
    samples: [u64; MAX_CLASSES],
    correct: [u64; MAX_CLASSES],
}

impl Recalls {
    /// Counts the labelled samples of a recording. A sample without a prediction is wrong.
    ///
    /// # Errors
    /// [`EvaluationError::Length`] if the sequences differ in length.
    pub fn new(
        truth: &[Option<Intent>],
        prediction: &[Option<Intent>],
    ) -> Result<Self, EvaluationError> {
        super::same_length(truth, prediction)?;
        let mut recalls = Self::default();
        for (truth, prediction) in truth.iter().zip(prediction) {
            if let Some(intent) = truth {
                recalls.samples[intent.class()] += 1;
                recalls.correct[intent.class()] += u64::from(truth == prediction);
            }
        }
        Ok(recalls)
    }

    /// Sum of both counts.
    pub fn plus(mut self, other: &Self) -> Self {
        for class in 0..MAX_CLASSES {
            self.samples[class] += other.samples[class];
            self.correct[class] += other.correct[class];
        }
        self
    }

    /// Recall of a class, 0..=1; none if the truth does not contain it.
    pub fn recall(&self, intent: Intent) -> Option<f64> {
        let samples = self.samples[intent.class()];
        (samples > 0).then(|| self.correct[intent.class()] as f64 / samples as f64)
    }

    /// Balanced accuracy, 0..=1; none if the truth has fewer than two classes.
    pub fn balanced_accuracy(&self) -> Option<f64> {
        let recalls: Vec<f64> = Intent::ALL
            .into_iter()
            .filter_map(|intent| self.recall(intent))
            .collect();
        (recalls.len() > 1).then(|| recalls.iter().sum::<f64>() / recalls.len() as f64)
    }

    /// Raw accuracy, 0..=1; `None` if no sample is labelled.
    pub fn raw_accuracy(&self) -> Option<f64> {
        let [samples, correct] = [self.samples, self.correct].map(|own| own.iter().sum::<u64>());
        (samples > 0).then(|| correct as f64 / samples as f64)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::fixture::{self, C, O, R};

    #[test]
    fn a_constant_prediction_has_the_recall_of_one_class() {
        let truth = fixture::labels(&[(R, 90), (O, 5), (C, 5), (None, 7)]);
        let recalls = Recalls::new(&truth, &vec![R; truth.len()]).unwrap();
        assert_eq!(recalls.balanced_accuracy(), Some(1.0 / 3.0));
        assert_eq!(recalls.recall(Intent::WaveIn), None);
        assert_eq!(recalls.raw_accuracy(), Some(0.9));
        assert_eq!(Recalls::default().raw_accuracy(), None);
        let half = Recalls::new(&[R, R, O, O, None], &[R, O, O, None, None]).unwrap();
        assert_eq!(half.raw_accuracy(), Some(0.5));
        assert_eq!(Recalls::default().balanced_accuracy(), None);
        let relax_alone = Recalls::new(&truth[..90], &truth[..90]).unwrap();
        assert_eq!(relax_alone.balanced_accuracy(), None);
        assert_eq!(relax_alone.recall(Intent::Relax), Some(1.0));
        let refused = Recalls::new(&truth[..1], &[]);
        let EvaluationError::Length { truth, prediction } = refused.unwrap_err() else {
            panic!("expected a refusal of the lengths");
        };
        assert_eq!((truth, prediction), (1, 0));
    }

    proptest! {
        #[test]
        fn it_is_the_mean_of_the_recalls_of_a_list_of_samples(
            recordings in prop::collection::vec(
                prop::collection::vec((0..7_usize, 0..7_usize), 0..40), 0..4),
        ) {
            let intent = |class| if class == 6 { None } else { Intent::from_class(class) };
            let labels = |recording: &Vec<(usize, usize)>| {
                let pairs = recording.iter().map(|&(t, p)| (intent(t), intent(p)));
                pairs.unzip::<_, _, Vec<_>, Vec<_>>()
            };
            let mut pooled = Recalls::default();
            let mut samples = Vec::new();
            for recording in &recordings {
                let (truth, prediction) = labels(recording);
                pooled = pooled.plus(&Recalls::new(&truth, &prediction).unwrap());
                samples.extend(truth.into_iter().zip(prediction));
            }
            // Naive: one class after the other, over all samples in one list.
            let mut recalls = Vec::new();
            for class in 0..6 {
                let own: Vec<_> = samples.iter().filter(|(t, _)| *t == intent(class)).collect();
                if !own.is_empty() {
                    let right = own.iter().filter(|(t, p)| t == p).count();
                    recalls.push(right as f64 / own.len() as f64);
                }
            }
            let naive = if recalls.len() < 2 { None } else {
                Some(recalls.iter().sum::<f64>() / recalls.len() as f64)
            };
            prop_assert_eq!(pooled.balanced_accuracy(), naive);
        }
    }
}
