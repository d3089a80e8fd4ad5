//! Template of an open hand: a normal density of profiles, and the placement that fits it best.

use super::placement::Alignment;
use super::profile::{OCTAVE, Profile};
use crate::units::CHANNELS;

/// Numbers on and above the diagonal of a symmetric matrix of 8 x 8.
const TRIANGLE: usize = CHANNELS * (CHANNELS + 1) / 2;

/// Bytes of a template in a model file.
pub const TEMPLATE_BYTES: usize = 2 * (CHANNELS + TRIANGLE);

/// A precision of one nat per square octave.
pub const PRECISION_ONE: i16 = 64;

/// Largest magnitude of a mean: 8 octaves, more than any profile has.
const LARGEST_MEAN: i16 = 8 * OCTAVE;

/// A nat in the unit of distances.
///
/// Far finer than what is told of them, hundredths: of two placements that are equal in this unit, it would depend on how the
/// armband sits which one is taken.
pub const NAT: u32 = 1 << 16;

/// Unit of the sum for half a squared distance: deviations in 1/256 octaves, squared, times 1/64 nats, twice.
const SUM_UNIT: i64 = 2 * OCTAVE as i64 * OCTAVE as i64 * PRECISION_ONE as i64 / NAT as i64;

/// Mean and precision (inverse covariance) of the profiles of an open hand, placed as in training.
///
/// The mean is in 1/256 octaves, the precision in 1/64 nats per square octave.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Template {
    mean: [i16; CHANNELS],
    /// Row by row from the diagonal on.
    precision: [i16; TRIANGLE],
}

/// The placement on one arm that a template fits best.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Fit {
    /// The placement.
    pub alignment: Alignment,
    /// Distance of the profile from the template's mean: half the squared Mahalanobis distance, in the unit of [`NAT`].
    pub distance: u32,
    /// Additional distance of the best placement on the same arm that lies more than one place away, in the same unit.
    pub margin: u32,
}

/// The best placement of a profile, and the best of those on the other arm.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Fits {
    /// The nearest of the 16 placements.
    pub nearest: Fit,
    /// The nearest on the other arm than that.
    pub other_arm: Fit,
}

impl Fits {
    /// Additional distance of the best placement on the other arm, in the unit of [`NAT`].
    #[must_use]
    pub const fn lead(&self) -> u32 {
        self.other_arm.distance - self.nearest.distance
    }
}

/// Why numbers are no template.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum TemplateError {
    #[error("{found} bytes, a template has {TEMPLATE_BYTES}: make it again")]
    Length { found: usize },
    #[error(
        "mean {found} of electrode {electrode}, at most {LARGEST_MEAN} expected: make it again"
    )]
    Mean { electrode: usize, found: i16 },
    #[error("precision {found} of electrode {electrode}, more than 0 expected: make it again")]
    Precision { electrode: usize, found: i16 },
}

impl Template {
    /// A template of the mean and of the precision matrix's rows from the diagonal on.
    ///
    /// # Errors
    /// If a mean is above 8 octaves, or a number on the diagonal is not positive.
    pub fn new(mean: [i16; CHANNELS], precision: [i16; TRIANGLE]) -> Result<Self, TemplateError> {
        let template = Self { mean, precision };
        for (electrode, found) in mean.into_iter().enumerate() {
            if found.unsigned_abs() > LARGEST_MEAN.unsigned_abs() {
                return Err(TemplateError::Mean { electrode, found });
            }
            let found = template.precision(electrode, electrode);
            if found <= 0 {
                return Err(TemplateError::Precision { electrode, found });
            }
        }
        Ok(template)
    }

    /// A template of equal width in all directions about a mean, of this many nats per square octave.
    ///
    /// # Errors
    /// As [`Template::new`].
    pub fn round(mean: [i16; CHANNELS], nats: i16) -> Result<Self, TemplateError> {
        let mut precision = [0; TRIANGLE];
        let mut diagonal = 0;
        for row in 0..CHANNELS {
            precision[diagonal] = nats.saturating_mul(PRECISION_ONE);
            diagonal += CHANNELS - row;
        }
        Self::new(mean, precision)
    }

    /// Reads mean and precision, little endian.
    ///
    /// # Errors
    /// If there are not [`TEMPLATE_BYTES`], or as [`Template::new`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TemplateError> {
        let (numbers, rest) = bytes.as_chunks::<2>();
        if bytes.len() != TEMPLATE_BYTES || !rest.is_empty() {
            return Err(TemplateError::Length { found: bytes.len() });
        }
        let number = |index: usize| i16::from_le_bytes(numbers[index]);
        Self::new(
            core::array::from_fn(number),
            core::array::from_fn(|index| number(CHANNELS + index)),
        )
    }

    /// The bytes that [`Template::from_bytes`] reads.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; TEMPLATE_BYTES] {
        let mut bytes = [0; TEMPLATE_BYTES];
        let numbers = self.mean.iter().chain(&self.precision);
        for (two, number) in bytes.as_chunks_mut::<2>().0.iter_mut().zip(numbers) {
            *two = number.to_le_bytes();
        }
        bytes
    }

    /// Half the squared Mahalanobis distance of a profile, at least 0, in the unit of [`NAT`].
    ///
    /// Cost: 36 products of 32 bits with a sum of 64.
    pub(super) fn distance(&self, profile: [i16; CHANNELS]) -> u32 {
        // At most 1794 + 2048, below 2^12.
        let deviation: [i32; CHANNELS] =
            core::array::from_fn(|at| i32::from(profile[at]) - i32::from(self.mean[at]));
        // One loop over the triangle: two would be unrolled, to 36 times the same code.
        let (mut sum, mut row, mut column) = (0, 0, 0);
        for &precision in &self.precision {
            // Both halves of the matrix; half of the diagonal is that of the square.
            let weight = if row == column { 1 } else { 2 };
            let square = weight * deviation[row] * deviation[column];
            // At most 64 x 2^12 x 2^12 x 2^15: 2^45.
            sum += i64::from(square) * i64::from(precision);
            column += 1;
            if column == CHANNELS {
                row += 1;
                column = row;
            }
        }
        u32::try_from(sum.max(0) / SUM_UNIT).unwrap_or(u32::MAX)
    }

    /// The best of the 16 placements of a profile, and the best on the other arm. Of two equal ones the lower turn,
    /// unmirrored before mirrored.
    #[must_use]
    pub fn fit(&self, profile: Profile) -> Fits {
        let [as_in_training, mirrored] = [false, true].map(|arm| self.fit_on(arm, profile));
        let (nearest, other_arm) = if mirrored.distance < as_in_training.distance {
            (mirrored, as_in_training)
        } else {
            (as_in_training, mirrored)
        };
        Fits { nearest, other_arm }
    }

    /// The best of the 8 placements on an arm; of two equal ones the lower turn. Not inlined: once for each arm, it takes
    /// twice the flash.
    #[inline(never)]
    pub(super) fn fit_on(&self, mirrored: bool, profile: Profile) -> Fit {
        let place = |turn: usize| Alignment::new(turn as u8, mirrored);
        let mut distances = [0; CHANNELS];
        let mut best = 0;
        for turn in 0..CHANNELS {
            distances[turn] = self.distance(place(turn).apply(profile.0));
            if distances[turn] < distances[best] {
                best = turn;
            }
        }
        let is_elsewhere = |turn: usize| place(turn).places_from(place(best)) > Some(1);
        let elsewhere = (0..CHANNELS).filter(|&turn| is_elsewhere(turn));
        let elsewhere = elsewhere.map(|turn| distances[turn]).min();
        let nearest = distances[best];
        Fit {
            alignment: place(best),
            distance: nearest,
            margin: elsewhere.unwrap_or(nearest) - nearest,
        }
    }

    /// The template that is as near to any profile as this one is to the profile so aligned.
    #[must_use]
    pub fn seen_through(&self, alignment: Alignment) -> Self {
        let to = alignment.inverse().apply(core::array::from_fn(|at| at));
        let mut precision = [0; TRIANGLE];
        let mut next = precision.iter_mut();
        for row in 0..CHANNELS {
            for (column, precision) in (row..CHANNELS).zip(&mut next) {
                let (row, column) = (to[row], to[column]);
                *precision = self.precision(row.min(column), row.max(column));
            }
        }
        Self {
            mean: alignment.inverse().apply(self.mean),
            precision,
        }
    }

    fn precision(&self, row: usize, column: usize) -> i16 {
        // Rows before have 8, 7, ... numbers.
        let start = row * (2 * CHANNELS + 1 - row) / 2;
        self.precision[start + column - row]
    }
}

#[cfg(test)]
pub(crate) mod tests;
