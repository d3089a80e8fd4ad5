//! The template of a model: mean and covariance of people's profiles of an open hand.

use shared::stream::alignment::{OCTAVE, PRECISION_ONE, Template};
use shared::units::CHANNELS;

/// Minimum number of people who open the hand; fewer make no template.
pub const FEWEST_PEOPLE: usize = 3;

/// Minimum weight of the identity in the shrunk covariance.
const SHRINKAGE: f64 = 0.2;
/// Minimum variance of an electrode, in square octaves: a tenth of an octave.
const LEAST_VARIANCE: f64 = 0.01;

/// Row-major matrix with one row and one column for each electrode.
type Matrix = [[f64; CHANNELS]; CHANNELS];

/// The inverse of a symmetric positive definite matrix, by Gauss-Jordan elimination, which needs no pivoting there.
fn inverse(mut matrix: Matrix) -> Matrix {
    let mut inverse = Matrix::default();
    for (row, values) in inverse.iter_mut().enumerate() {
        values[row] = 1.0;
    }
    for pivot in 0..CHANNELS {
        let scale = 1.0 / matrix[pivot][pivot];
        for column in 0..CHANNELS {
            matrix[pivot][column] *= scale;
            inverse[pivot][column] *= scale;
        }
        let (left, right) = (matrix[pivot], inverse[pivot]);
        for row in (0..CHANNELS).filter(|&row| row != pivot) {
            let factor = matrix[row][pivot];
            for column in 0..CHANNELS {
                matrix[row][column] -= factor * left[column];
                inverse[row][column] -= factor * right[column];
            }
        }
    }
    inverse
}

/// Template from people's [profiles](super::open_hand()), with the armband as worn in training: a normal density of
/// octaves, in the device's units. None from fewer than [`FEWEST_PEOPLE`], or if the template is invalid.
///
/// The covariance is shrunk to a multiple of the identity. Rotating people until they agree would make a sharper
/// template, but would turn the model's input away from its training: measured in docs/alignment.md.
pub fn template(people: &[[f64; CHANNELS]]) -> Option<Template> {
    if people.len() < FEWEST_PEOPLE {
        return None;
    }
    let count = people.len() as f64;
    let mean: [f64; CHANNELS] = std::array::from_fn(|electrode| {
        people.iter().map(|values| values[electrode]).sum::<f64>() / count
    });
    let mut covariance = Matrix::default();
    for values in people {
        for row in 0..CHANNELS {
            for column in 0..CHANNELS {
                let product = (values[row] - mean[row]) * (values[column] - mean[column]);
                covariance[row][column] += product / (count - 1.0);
            }
        }
    }
    let variance = (0..CHANNELS).map(|at| covariance[at][at]).sum::<f64>() / CHANNELS as f64;
    let variance = variance.max(LEAST_VARIANCE);
    // The covariance of few people is uncertain.
    let shrinkage = (CHANNELS as f64 / count).clamp(SHRINKAGE, 1.0);
    for (row, values) in covariance.iter_mut().enumerate() {
        for value in &mut *values {
            *value *= 1.0 - shrinkage;
        }
        values[row] += shrinkage * variance;
    }
    let precision = inverse(covariance);
    // A conversion to an integer saturates.
    let rounded = |value: f64, unit: i16| (value * f64::from(unit)).round() as i16;
    let mut upper = (0..CHANNELS).flat_map(|row| (row..CHANNELS).map(move |column| (row, column)));
    let precision = std::array::from_fn(|_| {
        let (row, column) = upper.next().unwrap_or_default();
        rounded(precision[row][column], PRECISION_ONE)
    });
    Template::new(mean.map(|mean| rounded(mean, OCTAVE)), precision).ok()
}

#[cfg(test)]
mod tests {
    use std::array::from_fn;

    use super::*;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;
    use shared::stream::alignment::{Alignment, Profile};

    /// Mean activity of an open hand, in 1/64 counts.
    const OPEN: [f64; CHANNELS] = [2400.0, 1900.0, 1500.0, 1000.0, 700.0, 400.0, 300.0, 200.0];

    fn person(random: &mut ChaCha8Rng, worn: Alignment) -> [f64; CHANNELS] {
        let varied = OPEN.map(|mean| (mean * random.random_range(0.75..1.33)) as u32);
        let values = Profile::new(varied).values();
        worn.inverse()
            .apply(values.map(|value| f64::from(value) / 256.0))
    }

    fn people() -> Vec<[f64; CHANNELS]> {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        (0..40)
            .map(|_| person(&mut random, Alignment::NONE))
            .collect()
    }

    #[test]
    fn a_matrix_times_its_inverse_is_the_identity() {
        // Diagonally dominant, therefore positive definite.
        let value = |row: usize, column| match row.abs_diff(column) {
            0 => 5.0,
            apart => 1.0 / (1.0 + apart as f64),
        };
        let matrix: Matrix = from_fn(|row| from_fn(|column| value(row, column)));
        let inverse = inverse(matrix);
        let product = |row: usize, column: usize| -> f64 {
            let products = matrix[row].iter().zip(&inverse);
            products.map(|(value, other)| value * other[column]).sum()
        };
        for (row, column) in (0..CHANNELS * CHANNELS).map(|at| (at / CHANNELS, at % CHANNELS)) {
            let expected = if row == column { 1.0 } else { 0.0 };
            let found = product(row, column);
            assert!((found - expected).abs() < 1e-9, "{row} {column}: {found}");
        }
    }

    #[test]
    fn strangers_are_placed_by_it() {
        let template = template(&people()).unwrap();
        let mut random = ChaCha8Rng::seed_from_u64(11);
        for worn in Alignment::all() {
            let open = person(&mut random, worn);
            let counts = open.map(|octaves| (640.0 * octaves.exp2()) as u32);
            let fits = template.fit(Profile::new(counts));
            assert_eq!(fits.nearest.alignment, worn);
        }
    }

    #[test]
    fn too_few_people_make_none_and_equal_ones_have_a_width() {
        assert_eq!(template(&people()[..2]), None);
        assert!(template(&[people()[1]; 5]).is_some());
    }
}
