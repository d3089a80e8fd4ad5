//! Pseudo-random numbers for tests, benchmarks and random models.

use crate::units::{CHANNELS, Sample};

/// A splitmix64 generator: the same numbers from a seed on every machine.
#[derive(Clone, Debug)]
pub struct Noise(pub u64);

impl Noise {
    /// The next 64 bits.
    pub const fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Uniform in -1..1.
    pub fn signed(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    /// The next sample of EMG, below this amplitude on every electrode.
    pub fn sample(&mut self, amplitude: f32) -> Sample {
        [(); CHANNELS].map(|()| (self.signed() * amplitude) as i8)
    }

    /// EMG of rest and effort in turn, 1.5 s each.
    pub fn efforts(mut self) -> impl Iterator<Item = Sample> {
        (0_usize..).map(move |index| {
            let works = index / 300 % 2 == 1;
            self.sample(if works { 90.0 } else { 3.0 })
        })
    }
}
