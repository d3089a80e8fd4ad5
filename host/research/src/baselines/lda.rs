//! Linear discriminant analysis: one Gaussian per class and one covariance for all classes, with
//! Ledoit-Wolf shrinkage (2004).
//!
//! Equal to scikit-learn's least-squares solver with automatic shrinkage: the covariance of each class is
//! estimated on standardized features, then weighted by the share of the class.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Fitted classifier.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Lda {
    /// Discriminant of each class; none for a class without training windows.
    discriminants: Vec<Option<Discriminant>>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Discriminant {
    weights: Vec<f64>,
    bias: f64,
}

/// Why no classifier can be fitted.
#[derive(Debug, Error)]
pub(crate) enum LdaError {
    /// Fewer than two classes have examples.
    #[error(
        "{windows} labelled windows of {classes} classes; two classes or more are needed: give more recordings"
    )]
    OneClass {
        /// Number of labelled windows.
        windows: usize,
        /// Number of classes among their labels.
        classes: usize,
    },
    /// The covariance cannot be inverted.
    #[error("the features' covariance cannot be inverted: {reason}; check the features for NaN")]
    Singular {
        /// Message of the solver.
        reason: &'static str,
    },
}

impl Lda {
    /// Fits a classifier to feature vectors with their classes, all below `classes`.
    ///
    /// # Errors
    /// When fewer than two classes occur, or features are not finite.
    pub(crate) fn fit(examples: &[(Vec<f32>, usize)], classes: usize) -> Result<Self, LdaError> {
        let statistics: Vec<Option<ClassStatistics>> = (0..classes)
            .map(|class| {
                let own: Vec<&[f32]> = examples
                    .iter()
                    .filter(|(_, label)| *label == class)
                    .map(|(features, _)| features.as_slice())
                    .collect();
                (!own.is_empty()).then(|| ClassStatistics::of(&own))
            })
            .collect();
        let seen = statistics.iter().flatten().count();
        if seen < 2 {
            return Err(LdaError::OneClass {
                windows: examples.len(),
                classes: seen,
            });
        }
        let share = |class: &ClassStatistics| class.examples as f64 / examples.len() as f64;
        let covariance = statistics
            .iter()
            .flatten()
            .map(|class| &class.covariance * share(class))
            .reduce(|sum, term| sum + term)
            .unwrap_or_default();
        let decomposition = covariance.svd(true, true);
        // Least squares instead of an inverse give a constant feature no weight.
        let negligible = f64::EPSILON * decomposition.singular_values.max();
        let discriminants = statistics
            .iter()
            .map(|class| {
                class
                    .as_ref()
                    .map(|class| {
                        let weights = decomposition.solve(&class.mean, negligible)?;
                        Ok(Discriminant {
                            bias: share(class).ln() - 0.5 * weights.dot(&class.mean),
                            weights: weights.iter().copied().collect(),
                        })
                    })
                    .transpose()
            })
            .collect::<Result<_, _>>()
            .map_err(|reason| LdaError::Singular { reason })?;
        Ok(Self { discriminants })
    }

    /// Logarithm of each class's posterior probability, up to a common constant; [`f32::MIN`] for a class
    /// without training windows.
    pub(crate) fn scores(&self, features: &[f32]) -> Vec<f32> {
        let score = |discriminant: &Discriminant| {
            let terms = discriminant.weights.iter().zip(features);
            let sum: f64 = terms.map(|(weight, &x)| weight * f64::from(x)).sum();
            (sum + discriminant.bias) as f32
        };
        self.discriminants
            .iter()
            .map(|discriminant| discriminant.as_ref().map_or(f32::MIN, score))
            .collect()
    }
}

/// Mean and covariance of the examples of one class.
struct ClassStatistics {
    examples: usize,
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl ClassStatistics {
    fn of(examples: &[&[f32]]) -> Self {
        let (n, p) = (examples.len(), examples[0].len());
        let mut x = DMatrix::from_fn(n, p, |row, column| f64::from(examples[row][column]));
        let mean = x.row_mean().transpose();
        let mut deviation = DVector::zeros(p);
        for (column, mut values) in x.column_iter_mut().enumerate() {
            values.add_scalar_mut(-mean[column]);
            let spread = (values.norm_squared() / n as f64).sqrt();
            deviation[column] = if spread > 0.0 { spread } else { 1.0 };
            values /= deviation[column];
        }
        let standardized = shrunk_covariance(&x);
        let covariance = standardized.component_mul(&(&deviation * deviation.transpose()));
        Self {
            examples: n,
            mean,
            covariance,
        }
    }
}

/// Covariance of centred rows, shrunk towards its mean variance times the identity. The shrinkage is
/// Ledoit and Wolf's: the squared error of the sample covariance over its squared distance from that
/// target.
fn shrunk_covariance(x: &DMatrix<f64>) -> DMatrix<f64> {
    let (n, p) = (x.nrows() as f64, x.ncols() as f64);
    let sample = x.tr_mul(x) / n;
    let mean_variance = sample.trace() / p;
    let squares = sample.norm_squared();
    let distance = (squares - p * mean_variance.powi(2)) / p;
    let fourth: f64 = x.row_iter().map(|row| row.norm_squared().powi(2)).sum();
    let error = (fourth / n - squares) / (p * n);
    let shrinkage = if error.min(distance) > 0.0 {
        error.min(distance) / distance
    } else {
        0.0
    };
    let target = DMatrix::identity(x.ncols(), x.ncols()) * (shrinkage * mean_variance);
    sample * (1.0 - shrinkage) + target
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ninety synthetic examples of four features and three classes of unequal size.
    fn examples() -> Vec<(Vec<f32>, usize)> {
        (0..90_i32)
            .map(|n| {
                let class = match n % 9 {
                    0..5 => 0,
                    5..7 => 1,
                    _ => 2,
                };
                let mut r = [0, 1, 2, 3]
                    .map(|f| f64::from((n * n * 7 + n * (13 + 6 * f) + f * 29) % 101) / 50.0 - 1.0);
                r[1] += 0.5 * r[0];
                let k = f64::from(class);
                let r = [
                    r[0] * (1.0 + 0.5 * k) + 0.8 * k,
                    r[1] - 0.6 * k,
                    r[2] * 3.0,
                    0.2 * r[3] + if class == 2 { 0.3 } else { 0.0 },
                ];
                (r.map(|x| x as f32).to_vec(), class as usize)
            })
            .collect()
    }

    #[test]
    fn fits_as_scikit_learn_does() {
        // scikit-learn 1.9.1: LinearDiscriminantAnalysis(solver="lsqr", shrinkage="auto").fit on these
        // examples in double precision; coef_ and intercept_.
        let expected = [
            (
                [-0.217_278_12, -0.367_315_56, 0.035_938_88, -0.243_822_14],
                -0.637_134_12,
            ),
            (
                [2.036_939_34, -1.285_381_45, 0.115_660_97, -3.067_250_47],
                -2.880_081_78,
            ),
            (
                [3.224_804_97, -3.425_558_71, 0.032_241_77, 24.355_778_28],
                -10.073_048_12,
            ),
        ];
        let lda = Lda::fit(&examples(), 3).unwrap();
        for (found, (weights, bias)) in lda.discriminants.iter().zip(expected) {
            let found = found.as_ref().unwrap();
            assert!((found.bias - bias).abs() < 1e-5, "{found:?}");
            for (found, expected) in found.weights.iter().zip(weights) {
                assert!(
                    (found - expected).abs() < 1e-5,
                    "{found} against {expected}"
                );
            }
        }
        let right = examples()
            .iter()
            .filter(|(x, class)| training::optimization::best_class(&lda.scores(x)) == *class)
            .count();
        assert_eq!(right, 79, "an accuracy of 0.8778 on 90, as in scikit-learn");
    }

    #[test]
    fn an_unseen_class_is_never_predicted_and_a_constant_feature_has_no_weight() {
        let mut examples = examples();
        examples.retain(|(_, class)| *class != 1);
        for (features, _) in &mut examples {
            features.push(7.0);
        }
        let lda = Lda::fit(&examples, 3).unwrap();
        let mut x = vec![9.0, 9.0, 9.0, -9.0, 7.0];
        assert!(lda.scores(&x)[1] <= f32::MIN);
        let lead = |x: &[f32]| lda.scores(x)[0] - lda.scores(x)[2];
        let before = lead(&x);
        x[4] = -7.0;
        let after = lead(&x);
        assert!((before - after).abs() < 1e-3, "{before} against {after}");
    }

    #[test]
    fn one_class_is_refused() {
        let examples: Vec<_> = examples().into_iter().filter(|(_, c)| *c == 0).collect();
        let error = Lda::fit(&examples, 3).unwrap_err();
        assert!(
            matches!(
                error,
                LdaError::OneClass {
                    windows: 50,
                    classes: 1
                }
            ),
            "{error}"
        );
    }
}
