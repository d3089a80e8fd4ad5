//! Butterworth low-pass filters, applied forwards and backwards for zero phase delay.

use std::f64::consts::PI;

/// Second-order section: (b0 + b1/z + b2/z²) / (1 + a1/z + a2/z²).
#[derive(Clone, Copy, Debug)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

/// Low-pass filter as a cascade of sections, each with unit gain at 0 Hz.
#[derive(Clone, Debug)]
pub(super) struct LowPass {
    order: usize,
    sections: Vec<Section>,
}

impl LowPass {
    /// Designs a filter with gain 1/√2 at `cutoff`, which is below half the sample `rate`; both in the same unit.
    ///
    /// The poles of the analogue prototype are spaced evenly on the left half of a circle. The bilinear
    /// transform maps them to the z-plane, with the cutoff prewarped.
    pub(super) fn new(order: usize, cutoff: f64, rate: f64) -> Self {
        let radius = (PI * cutoff / rate).tan();
        let mut sections: Vec<Section> = (0..order / 2)
            .map(|pair| {
                let angle = PI * (2 * pair + 1) as f64 / (2 * order) as f64;
                let damping = 2.0 * angle.sin() * radius;
                let square = radius * radius;
                let scale = 1.0 / (1.0 + damping + square);
                Section {
                    b: [1.0, 2.0, 1.0].map(|b| b * square * scale),
                    a: [
                        2.0 * (square - 1.0) * scale,
                        (1.0 - damping + square) * scale,
                    ],
                }
            })
            .collect();
        if order % 2 == 1 {
            let scale = 1.0 / (1.0 + radius);
            sections.push(Section {
                b: [radius * scale, radius * scale, 0.0],
                a: [(radius - 1.0) * scale, 0.0],
            });
        }
        Self { order, sections }
    }

    /// Filters a signal forwards, then backwards.
    ///
    /// Each end is padded with its odd reflection, three filter lengths long (or as long as the signal
    /// allows), and the filter starts in its steady state for the first value: the conventions of
    /// SciPy's `filtfilt`.
    pub(super) fn zero_phase(&self, x: &[f64]) -> Vec<f64> {
        let edge = (3 * (self.order + 1)).min(x.len().saturating_sub(1));
        let (Some(&first), Some(&last)) = (x.first(), x.last()) else {
            return Vec::new();
        };
        let before = x[1..=edge].iter().rev().map(|&x| 2.0 * first - x);
        let after = x[x.len() - 1 - edge..x.len() - 1]
            .iter()
            .rev()
            .map(|&x| 2.0 * last - x);
        let mut y: Vec<f64> = before.chain(x.iter().copied()).chain(after).collect();
        for _ in 0..2 {
            self.run(&mut y);
            y.reverse();
        }
        y[edge..edge + x.len()].to_vec()
    }

    fn run(&self, x: &mut [f64]) {
        let first = x.first().copied().unwrap_or_default();
        for Section { b, a } in &self.sections {
            // The steady state for a constant input of the first value. Later sections get the same
            // constant, since each has unit gain at 0 Hz.
            let mut memory = [first * (1.0 - b[0]), first * (b[2] - a[1])];
            for x in &mut *x {
                let y = b[0] * *x + memory[0];
                memory = [b[1] * *x - a[0] * y + memory[1], b[2] * *x - a[1] * y];
                *x = y;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_as_scipy_does() {
        // scipy 1.17.1: filtfilt(*butter(order, 90, fs=200), x), samples 0, 1, 2, 19, 20, 38, 39.
        const AT: [usize; 7] = [0, 1, 2, 19, 20, 38, 39];
        let expected = [
            (
                1,
                [
                    -1.012_808_674_104_593_4,
                    -0.585_875_764_331_632_1,
                    0.273_534_161_583_458_34,
                    0.995_469_919_980_571_7,
                    0.319_215_218_881_612_1,
                    -0.327_382_821_224_200_3,
                    0.007_993_328_745_990_937,
                ],
            ),
            (
                3,
                [
                    -0.995_433_315_384_547_9,
                    -0.616_633_018_636_326_8,
                    0.307_651_427_364_968,
                    1.054_988_830_017_609_3,
                    0.275_024_873_036_742_5,
                    -0.305_081_950_542_644_75,
                    -0.001_818_606_809_405_938_5,
                ],
            ),
            (
                5,
                [
                    -1.006_776_401_317_674_8,
                    -0.609_027_402_196_488_7,
                    0.303_559_406_210_222_2,
                    1.059_407_148_058_751_2,
                    0.271_268_563_352_521_03,
                    -0.302_954_139_947_436,
                    0.002_678_535_096_883_103_6,
                ],
            ),
        ];
        let x: Vec<f64> = (0..40)
            .map(|t| f64::from((37 * t * t + 11 * t) % 256 - 128) / 128.0)
            .collect();
        for (order, expected) in expected {
            let y = LowPass::new(order, 90.0, 200.0).zero_phase(&x);
            for (at, expected) in AT.into_iter().zip(expected) {
                assert!(
                    (y[at] - expected).abs() < 1e-9,
                    "order {order}, sample {at}: {} against {expected}",
                    y[at]
                );
            }
        }
    }

    #[test]
    fn each_pass_halves_the_power_at_the_cutoff() {
        for order in [1, 3, 5] {
            let wave: Vec<f64> = (0..4000).map(|t| (f64::from(t) * 0.2 * PI).cos()).collect();
            let y = LowPass::new(order, 20.0, 200.0).zero_phase(&wave);
            // Far from the ends, at a peak of the wave: a gain of 1/√2 for each pass.
            assert!((y[2000] - 0.5).abs() < 1e-9, "order {order}: {}", y[2000]);
        }
    }

    #[test]
    fn a_signal_shorter_than_the_padding_is_filtered() {
        let y = LowPass::new(5, 90.0, 200.0).zero_phase(&[0.5; 3]);
        assert!(y.len() == 3 && y.iter().all(|y| (y - 0.5).abs() < 1e-12));
        assert!(LowPass::new(1, 90.0, 200.0).zero_phase(&[]).is_empty());
    }
}
