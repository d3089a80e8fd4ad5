//! Raw accuracy = samples whose prediction equals the truth / labelled samples.

use shared::intent::Intent;

use crate::EvaluationError;

/// Fraction of labelled samples that are predicted correctly, 0..=1; none if no sample is labelled.
///
/// A sample without a prediction counts as wrong.
///
/// # Errors
/// [`EvaluationError::Length`] if the sequences differ in length.
pub fn raw_accuracy(
    truth: &[Option<Intent>],
    prediction: &[Option<Intent>],
) -> Result<Option<f64>, EvaluationError> {
    super::same_length(truth, prediction)?;
    let labelled = truth.iter().flatten().count();
    let correct = truth
        .iter()
        .zip(prediction)
        .filter(|(t, p)| t.is_some() && t == p)
        .count();
    Ok((labelled > 0).then(|| correct as f64 / labelled as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_labelled_samples_count_and_no_prediction_is_wrong() {
        let (r, o) = (Some(Intent::Relax), Some(Intent::Open));
        let accuracy = raw_accuracy(&[r, r, o, o, None], &[r, o, o, None, None]);
        assert_eq!(accuracy.unwrap(), Some(0.5));
        assert_eq!(raw_accuracy(&[None], &[r]).unwrap(), None);
        let error = raw_accuracy(&[r], &[]).unwrap_err();
        assert!(
            matches!(
                error,
                EvaluationError::Length {
                    truth: 1,
                    prediction: 0
                }
            ),
            "{error}"
        );
    }
}
