//! Dropout with masks from a generator of the caller's.
//!
//! Burn's own dropout draws from one generator a device, so two threads that train side by side
//! would not draw the same twice.

use burn::tensor::{Tensor, TensorData};
use rand::Rng as _;
use rand_chacha::ChaCha8Rng;

/// Drops values while training, and nothing otherwise.
pub struct Dropout(Option<ChaCha8Rng>);

impl From<ChaCha8Rng> for Dropout {
    fn from(rng: ChaCha8Rng) -> Self {
        Self(Some(rng))
    }
}

impl Dropout {
    /// Drops nothing.
    #[must_use]
    pub const fn off() -> Self {
        Self(None)
    }

    /// Sets about a share of the values to 0 and scales the others, so that the mean stays.
    ///
    /// The share is rounded to 1/256: a byte a value is drawn.
    #[must_use]
    pub fn drop<const D: usize>(&mut self, x: Tensor<D>, share: f64) -> Tensor<D> {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a share of 256"
        )]
        let below = (share * 256.0).round() as u16;
        let Some(rng) = self.0.as_mut().filter(|_| below > 0) else {
            return x;
        };
        let shape = x.dims();
        let mut bytes = vec![0_u8; shape.iter().product()];
        rng.fill_bytes(&mut bytes);
        let scale = 256.0 / f32::from(256 - below);
        let kept: Vec<f32> = bytes
            .iter()
            .map(|&byte| if u16::from(byte) < below { 0.0 } else { scale })
            .collect();
        let device = x.device();
        x * Tensor::from_data(TensorData::new(kept, shape), &device)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use burn::tensor::Device;
    use rand::SeedableRng;

    #[test]
    fn keeps_the_mean_and_repeats_with_its_seed() {
        let x = Tensor::<1>::ones([20_000], &Device::default());
        let drop = || Dropout::from(ChaCha8Rng::seed_from_u64(1)).drop(x.clone(), 0.15);
        let once = crate::estimate::numbers(drop());
        assert_eq!(once, crate::estimate::numbers(drop()));
        let mean = once.iter().sum::<f32>() / 20_000.0;
        // Four standard errors of a mean of 20 000: 0.012.
        assert!((mean - 1.0).abs() < 0.012, "{mean}");
        assert!(once.contains(&0.0));
    }

    #[test]
    fn off_leaves_everything_as_it_is() {
        let x = Tensor::<1>::ones([8], &Device::default());
        assert_eq!(
            crate::estimate::numbers(Dropout::off().drop(x, 0.9)),
            [1.0; 8]
        );
    }
}
