//! Linear discriminant analysis: one Gaussian a class, one covariance for all, shrunk towards a
//! multiple of the identity as far as the data ask for (Ledoit and Wolf, 2004).
//!
//! The least-squares variant with automatic shrinkage of scikit-learn, number for number: each
//! class's covariance is estimated on standardized features, then weighted by the class's share.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A fitted classifier.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lda {
    /// One a class; none for a class that training never saw.
    discriminants: Vec<Option<Discriminant>>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Discriminant {
    weights: Vec<f64>,
    bias: f64,
}

/// Why no classifier can be fitted.
#[derive(Debug, Error)]
pub enum LdaError {
    /// There is nothing to tell apart.
    #[error(
        "{windows} labelled windows of {classes} classes; two classes or more are needed: give more recordings"
    )]
    OneClass {
        /// Windows.
        windows: usize,
        /// Classes among them.
        classes: usize,
    },
    /// The covariance could not be inverted.
    #[error("the features' covariance has no inverse: {reason}; are there NaN among the features?")]
    Singular {
        /// What the solver says.
        reason: &'static str,
    },
}

impl Lda {
    /// Fits to feature vectors, each with its class below `classes`.
    ///
    /// # Errors
    /// When fewer than two classes occur, or features are not finite.
    pub fn fit(examples: &[(Vec<f32>, usize)], classes: usize) -> Result<Self, LdaError> {
        let groups: Vec<Option<Group>> = (0..classes)
            .map(|class| {
                let own: Vec<&[f32]> = examples
                    .iter()
                    .filter(|(_, label)| *label == class)
                    .map(|(features, _)| features.as_slice())
                    .collect();
                (!own.is_empty()).then(|| Group::of(&own))
            })
            .collect();
        let seen = groups.iter().flatten().count();
        if seen < 2 {
            return Err(LdaError::OneClass {
                windows: examples.len(),
                classes: seen,
            });
        }
        let share = |group: &Group| group.examples as f64 / examples.len() as f64;
        let covariance = groups
            .iter()
            .flatten()
            .map(|group| &group.covariance * share(group))
            .reduce(|sum, term| sum + term)
            .unwrap_or_default();
        let decomposition = covariance.svd(true, true);
        // Least squares rather than an inverse: a feature without any spread then has no say.
        let negligible = f64::EPSILON * decomposition.singular_values.max();
        let discriminants = groups
            .iter()
            .map(|group| {
                group
                    .as_ref()
                    .map(|group| {
                        let weights = decomposition.solve(&group.mean, negligible)?;
                        Ok(Discriminant {
                            bias: share(group).ln() - 0.5 * weights.dot(&group.mean),
                            weights: weights.iter().copied().collect(),
                        })
                    })
                    .transpose()
            })
            .collect::<Result<_, _>>()
            .map_err(|reason| LdaError::Singular { reason })?;
        Ok(Self { discriminants })
    }

    /// Logarithm of each class's probability, up to a common constant; the lowest number there is for a
    /// class never seen.
    #[must_use]
    pub fn scores(&self, features: &[f32]) -> Vec<f32> {
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

/// What the examples of one class tell.
struct Group {
    examples: usize,
    mean: DVector<f64>,
    covariance: DMatrix<f64>,
}

impl Group {
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

/// Covariance of centred rows, moved towards its mean variance times the identity by the share that
/// Ledoit and Wolf derive: the error of the sample covariance over its distance from that target.
fn shrunk_covariance(x: &DMatrix<f64>) -> DMatrix<f64> {
    let (n, p) = (x.nrows() as f64, x.ncols() as f64);
    let sample = x.tr_mul(x) / n;
    let mean_variance = sample.trace() / p;
    let squares = sample.norm_squared();
    let distance = (squares - p * mean_variance.powi(2)) / p;
    let fourth: f64 = x.row_iter().map(|row| row.norm_squared().powi(2)).sum();
    let error = (fourth / n - squares) / (p * n);
    let share = if error.min(distance) > 0.0 {
        error.min(distance) / distance
    } else {
        0.0
    };
    let target = DMatrix::identity(x.ncols(), x.ncols()) * (share * mean_variance);
    sample * (1.0 - share) + target
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
            .filter(|(x, class)| myointent::training::tensor::best_class(&lda.scores(x)) == *class)
            .count();
        assert_eq!(right, 79, "0.8778 of 90, as scikit-learn says");
    }

    #[test]
    fn a_class_never_seen_is_never_named_and_a_constant_feature_has_no_say() {
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
