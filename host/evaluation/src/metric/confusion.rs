//! Confusion matrix: number of samples by true intent and predicted label.

use shared::intent::{Intent, Vocabulary};

use crate::EvaluationError;

/// Confusion matrix in samples.
#[derive(Clone, PartialEq, Eq, Debug, serde::Serialize)]
pub struct Confusion {
    /// Names of the true intents, one per row; columns are these and, last, "none".
    pub intents: Vec<&'static str>,
    /// `counts[truth][prediction]`; the last column holds samples without a label of the
    /// vocabulary.
    pub counts: Vec<Vec<u64>>,
}

impl Confusion {
    /// A matrix of zeros.
    pub fn new(vocabulary: Vocabulary) -> Self {
        let classes = vocabulary.classes();
        Self {
            intents: vocabulary
                .intents()
                .iter()
                .map(|intent| intent.name())
                .collect(),
            counts: vec![vec![0; classes + 1]; classes],
        }
    }

    /// Adds the labelled samples of a recording; a truth outside the vocabulary is not counted.
    ///
    /// # Errors
    /// [`EvaluationError::Length`] if the sequences differ in length.
    pub fn add(
        &mut self,
        truth: &[Option<Intent>],
        prediction: &[Option<Intent>],
    ) -> Result<(), EvaluationError> {
        super::same_length(truth, prediction)?;
        let none = self.intents.len();
        for (truth, prediction) in truth.iter().zip(prediction) {
            let Some(row) = truth.and_then(|t| self.counts.get_mut(t.class())) else {
                continue;
            };
            let column = prediction.map_or(none, |p| p.class().min(none));
            row[column] += 1;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_labelled_sample_lands_in_one_cell() {
        let [r, o, w] = [Intent::Relax, Intent::Open, Intent::WaveIn].map(Some);
        let mut confusion = Confusion::new(Vocabulary::Three);
        let (truth, predicted) = ([r, r, o, o, None, w], [r, o, w, None, r, r]);
        confusion.add(&truth, &predicted).unwrap();
        assert_eq!(confusion.counts, [[1, 1, 0, 0], [0, 0, 0, 2], [0, 0, 0, 0]]);
    }
}
