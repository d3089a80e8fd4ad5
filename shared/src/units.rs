//! Quantities of the sample stream: samples, window and patch sizes, sample positions, time.

/// Electrodes of the armband, in ring order.
pub const CHANNELS: usize = 8;
/// Samples per second and channel (`EMG data 0..3` together).
pub const SAMPLE_RATE_HZ: u32 = 200;
/// Milliseconds between two samples.
pub const SAMPLE_PERIOD_MS: u32 = 1000 / SAMPLE_RATE_HZ;
/// Samples of the model's window: 3 s.
pub const WINDOW: usize = 600;
/// Samples of a patch, the encoder's input: 50 ms.
pub const PATCH: usize = 10;
/// Patches in a window.
pub const WINDOW_PATCHES: usize = WINDOW / PATCH;
/// Patches that every encoder step gives logits for: the newest, and the five of the look-ahead before it.
pub const LOOK_BACK: usize = 1 + LOOK_AHEAD / PATCH;
/// Default look-ahead of the smoother, in samples (paper: 0.25 s).
pub const LOOK_AHEAD: usize = 50;
/// Default hold of the smoother, in samples (paper: 0.1 s).
pub const HOLD: usize = 20;
/// Longest hold of the smoother, in samples: a label that outlives a change of mind by a second helps nobody.
pub const MAX_HOLD: usize = 200;
/// Largest entry margin of the smoother's confidence gate, as a difference of mean logits: no model is that sure.
pub const MAX_ENTRY_MARGIN: f32 = 50.0;

const _: () = assert!(WINDOW.is_multiple_of(PATCH));
const _: () = assert!(LOOK_AHEAD.is_multiple_of(PATCH) && HOLD.is_multiple_of(PATCH));

/// Raw EMG of one instant as the armband sends it: channel 1 first, -128..=127.
pub type Sample = [i8; CHANNELS];

/// A sample as two words, the first channel in the low byte of the first.
///
/// Byte by byte: `map` over an array is a loop through memory on a Cortex-M4.
pub(crate) const fn words(sample: Sample) -> [u32; 2] {
    const fn word(a: i8, b: i8, c: i8, d: i8) -> u32 {
        u32::from_le_bytes([
            a.cast_unsigned(),
            b.cast_unsigned(),
            c.cast_unsigned(),
            d.cast_unsigned(),
        ])
    }
    let [a, b, c, d, e, f, g, h] = sample;
    [word(a, b, c, d), word(e, f, g, h)]
}

/// The sample of [`words`].
pub(crate) const fn sample_of(words: [u32; 2]) -> Sample {
    const fn bytes(word: u32) -> [i8; 4] {
        let [a, b, c, d] = word.to_le_bytes();
        [
            a.cast_signed(),
            b.cast_signed(),
            c.cast_signed(),
            d.cast_signed(),
        ]
    }
    let [[a, b, c, d], [e, f, g, h]] = [bytes(words[0]), bytes(words[1])];
    [a, b, c, d, e, f, g, h]
}

/// Preprocessed EMG of one instant, 0..=128; the model's input is this over 128.
pub type CleanSample = [u8; CHANNELS];

/// Ten preprocessed samples, the oldest first: 50 ms, the encoder's input.
pub type Patch = [CleanSample; PATCH];

/// Position of a sample in its stream, 0 first; wraps after 248 days.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Default)]
pub struct SampleIndex(pub u32);

impl SampleIndex {
    /// The index `samples` later.
    #[must_use]
    pub const fn plus(self, samples: u32) -> Self {
        Self(self.0.wrapping_add(samples))
    }

    /// Samples from `earlier` to `self`, right across a wrap.
    #[must_use]
    pub const fn since(self, earlier: Self) -> u32 {
        self.0.wrapping_sub(earlier.0)
    }
}

/// Milliseconds of the caller's clock; wraps after 49 days.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub struct Millis(pub u32);

impl Millis {
    /// The instant `milliseconds` later.
    #[must_use]
    pub const fn plus(self, milliseconds: u32) -> Self {
        Self(self.0.wrapping_add(milliseconds))
    }

    /// Milliseconds from `earlier` to `self`, right across a wrap.
    #[must_use]
    pub const fn since(self, earlier: Self) -> u32 {
        self.0.wrapping_sub(earlier.0)
    }

    /// Like [`Millis::since`], but 0 where the clock seems to run backwards, as it does when the time
    /// stamp of an interrupt is handled late.
    #[must_use]
    pub const fn elapsed_since(self, earlier: Self) -> u32 {
        let difference = self.since(earlier);
        if difference > i32::MAX as u32 {
            0
        } else {
            difference
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_survive_the_wrap() {
        assert_eq!(SampleIndex(3).since(SampleIndex(u32::MAX - 1)), 5);
        assert_eq!(SampleIndex(u32::MAX).plus(2), SampleIndex(1));
        assert_eq!(Millis(10).since(Millis(u32::MAX - 9)), 20);
        assert_eq!(Millis(u32::MAX).plus(1), Millis(0));
        assert_eq!(Millis(10).elapsed_since(Millis(u32::MAX - 9)), 20);
        assert_eq!(Millis(10).elapsed_since(Millis(11)), 0);
    }
}
