//! Frequency-domain features of one channel.

use std::f64::consts::TAU;
use std::sync::Arc;

use realfft::num_complex::Complex;
use realfft::{RealFftPlanner, RealToComplex};

/// Amplitude spectrum of Hamming-windowed signals of one length.
pub(super) struct Spectrum {
    transform: Arc<dyn RealToComplex<f64>>,
    hamming: Vec<f64>,
}

impl Spectrum {
    /// Plans the transform of `length` samples.
    pub(super) fn new(length: usize) -> Self {
        let phase = |t: usize| TAU * t as f64 / length as f64;
        Self {
            transform: RealFftPlanner::new().plan_fft_forward(length),
            hamming: (0..length).map(|t| 0.54 - 0.46 * phase(t).cos()).collect(),
        }
    }

    /// Median amplitude over the frequencies from 0 to half the sample rate.
    ///
    /// # Panics
    /// When the signal does not have the planned length.
    pub(super) fn median_amplitude(&self, x: &[i32]) -> f64 {
        assert_eq!(x.len(), self.hamming.len(), "a transform has one length");
        let mut signal: Vec<f64> = x
            .iter()
            .zip(&self.hamming)
            .map(|(&x, weight)| f64::from(x) * weight)
            .collect();
        let mut spectrum = self.transform.make_output_vec();
        self.transform
            .process(&mut signal, &mut spectrum)
            .expect("input and output have the planned lengths");
        let mut amplitudes: Vec<f64> = spectrum.into_iter().map(Complex::norm).collect();
        amplitudes.sort_by(f64::total_cmp);
        let middle = amplitudes.len() / 2;
        if amplitudes.len() % 2 == 1 {
            amplitudes[middle]
        } else {
            f64::midpoint(amplitudes[middle - 1], amplitudes[middle])
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixture::{close, signal};
    use super::*;

    #[test]
    fn the_spectrum_is_the_discrete_fourier_transform() {
        for length in [24, 30] {
            let x = &signal()[100..100 + length];
            let mut amplitudes: Vec<f64> = (0..=length / 2)
                .map(|frequency| {
                    let (mut real, mut imaginary) = (0.0, 0.0);
                    for (t, &x) in x.iter().enumerate() {
                        let turn = t as f64 / length as f64;
                        let weighted = f64::from(x) * (0.54 - 0.46 * (TAU * turn).cos());
                        real += weighted * (TAU * turn * frequency as f64).cos();
                        imaginary += weighted * (TAU * turn * frequency as f64).sin();
                    }
                    real.hypot(imaginary)
                })
                .collect();
            amplitudes.sort_by(f64::total_cmp);
            // 24 samples have 13 frequencies, one in the middle; 30 have 16, two in the middle.
            let expected = match length {
                24 => amplitudes[6],
                _ => (amplitudes[7] + amplitudes[8]) / 2.0,
            };
            close(Spectrum::new(length).median_amplitude(x), expected);
        }
    }

    #[test]
    fn the_median_amplitude_is_that_of_scipy() {
        // scipy 1.17.1, numpy 2.4.6: median(abs(rfft(x * get_window("hamming", 600)))) of this x / 128.
        let x: Vec<i32> = (0..600).map(|t| (37 * t * t + 11 * t) % 129).collect();
        close(
            Spectrum::new(600).median_amplitude(&x) / 128.0,
            1.275_763_646_246_561,
        );
    }
}
