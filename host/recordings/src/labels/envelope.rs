//! The envelope of muscle activity: e(t) = mean over channels of ln(1 + moving average of |x|).
//!
//! The logarithm puts rest and hold of weak and strong channels on one scale; |x| is averaged and not x,
//! because neighbouring samples of the armband are correlated negatively.

use shared::units::{CHANNELS, Sample};

/// Running sums of a recording, from which the envelope of any width follows.
pub(super) struct Envelope {
    /// Sums of |x| before each sample: below 2^32 up to 33 million samples, more than any file that is read.
    sums: Vec<[u32; CHANNELS]>,
}

impl Envelope {
    pub fn new(samples: &[Sample]) -> Self {
        let mut sums = Vec::with_capacity(samples.len() + 1);
        let mut sum = [0u32; CHANNELS];
        sums.push(sum);
        for sample in samples {
            for (sum, value) in sum.iter_mut().zip(sample) {
                *sum = sum.wrapping_add(u32::from(value.unsigned_abs()));
            }
            sums.push(sum);
        }
        Self { sums }
    }

    /// The envelope at a sample, averaged over `width` samples around it (fewer at the ends).
    pub fn at(&self, sample: usize, width: usize) -> f64 {
        let from = sample.saturating_sub(width / 2);
        let to = (sample + width / 2).min(self.sums.len() - 1);
        let count = (to - from) as f64;
        (0..CHANNELS)
            .map(|c| (f64::from(self.sums[to][c].wrapping_sub(self.sums[from][c])) / count).ln_1p())
            .sum::<f64>()
            / CHANNELS as f64
    }

    /// The envelope at every sample.
    pub fn all(&self, width: usize) -> Vec<f64> {
        (0..self.sums.len() - 1)
            .map(|sample| self.at(sample, width))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    proptest::proptest! {
        #[test]
        fn running_sums_give_what_the_formula_says(samples: Vec<Sample>, half in 1_usize..30) {
            let found = Envelope::new(&samples).all(2 * half);
            for (at, found) in found.into_iter().enumerate() {
                let around = &samples[at.saturating_sub(half)..(at + half).min(samples.len())];
                let channel = |c: usize| {
                    let sum: f64 = around.iter().map(|s| f64::from(s[c]).abs()).sum();
                    (1.0 + sum / around.len() as f64).ln()
                };
                let naive = (0..CHANNELS).map(channel).sum::<f64>() / 8.0;
                assert!((found - naive).abs() < 1e-12, "{at}: {found} {naive}");
            }
        }
    }
}
