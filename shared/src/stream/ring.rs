//! Ring buffer of the last 3 s of preprocessed samples, stored as whole patches.

use super::alignment::Alignment;
use crate::units::{CHANNELS, CleanSample, PATCH, Patch, WINDOW, WINDOW_PATCHES};

/// The model's window: the newest 600 samples, in patches counted from the last reset.
///
/// A patch is contiguous in memory: the window is a whole number of patches, and a reset starts at the
/// first one.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SampleRing {
    patches: [Patch; WINDOW_PATCHES],
    /// Index of the incomplete patch, 0..60.
    current: usize,
    /// Samples of the open patch, 0..10.
    filled: usize,
    /// Saturates, after 248 days.
    contiguous: u32,
    /// Bridged samples of each patch, 0..=10.
    bridged_in: [u8; WINDOW_PATCHES],
    /// Their sum.
    bridged: u32,
}

/// Whether a sample was received.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Origin {
    /// The sample came from the armband.
    Received,
    /// The sample replaces a lost one.
    Bridged,
}

impl SampleRing {
    /// Takes a sample; returns whether it completes a patch, as every tenth sample since the last reset does.
    pub fn push(&mut self, sample: CleanSample, origin: Origin) -> bool {
        if self.filled == 0 {
            // The oldest patch goes.
            self.bridged -= u32::from(self.bridged_in[self.current]);
            self.bridged_in[self.current] = 0;
        }
        if origin == Origin::Bridged {
            self.bridged_in[self.current] += 1;
            self.bridged += 1;
        }
        self.patches[self.current][self.filled] = sample;
        self.contiguous = self.contiguous.saturating_add(1);
        self.filled += 1;
        if self.filled < PATCH {
            return false;
        }
        self.filled = 0;
        self.current = (self.current + 1) % WINDOW_PATCHES;
        true
    }

    /// Empties the ring, as after a gap.
    pub fn reset(&mut self) {
        self.current = 0;
        self.filled = 0;
        self.contiguous = 0;
        self.bridged_in = [0; WINDOW_PATCHES];
        self.bridged = 0;
    }

    /// Samples since the last reset.
    #[must_use]
    pub const fn contiguous(&self) -> u32 {
        self.contiguous
    }

    /// Bridged samples among those that the ring holds.
    #[must_use]
    pub(crate) const fn bridged(&self) -> u32 {
        self.bridged
    }

    /// Whether the window is full of contiguous samples.
    #[must_use]
    pub const fn is_full(&self) -> bool {
        self.contiguous >= WINDOW as u32
    }

    /// Electrodes of all samples in another order, as if they had come in it.
    pub(crate) fn rearrange(&mut self, alignment: Alignment) {
        alignment.apply_to_all(self.patches.as_flattened_mut());
    }

    /// Number of complete patches, in a full ring 60 directly after a patch has completed, 59 while the next one overwrites
    /// the oldest.
    pub(crate) fn complete(&self) -> usize {
        if self.is_full() {
            WINDOW_PATCHES - usize::from(self.filled > 0)
        } else {
            self.current
        }
    }

    /// The complete patch that is `back` patches older than the newest; below [`SampleRing::complete`].
    pub(crate) fn before_newest(&self, back: usize) -> &Patch {
        let place = self.current + 2 * WINDOW_PATCHES - 1 - back % WINDOW_PATCHES;
        &self.patches[place % WINDOW_PATCHES]
    }
}

impl Default for SampleRing {
    /// An empty ring.
    fn default() -> Self {
        Self {
            patches: [[[0; CHANNELS]; PATCH]; WINDOW_PATCHES],
            current: 0,
            filled: 0,
            contiguous: 0,
            bridged_in: [0; WINDOW_PATCHES],
            bridged: 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    fn numbered(number: usize) -> CleanSample {
        [(number % 129) as u8; CHANNELS]
    }

    #[test]
    fn a_window_stays_full_for_ever() {
        let mut ring = SampleRing::default();
        for number in 0..WINDOW {
            ring.push(numbered(number), Origin::Received);
        }
        ring.contiguous = u32::MAX - 5;
        for number in 0..20 {
            let completed = ring.push(numbered(number), Origin::Received);
            assert_eq!(completed, number % PATCH == PATCH - 1);
            assert!(ring.is_full());
        }
        assert_eq!(ring.contiguous(), u32::MAX);
        assert_eq!(ring.complete(), WINDOW_PATCHES);
    }

    #[test]
    fn complete_patches_are_those_of_a_list() {
        let mut ring = SampleRing::default();
        let mut list = Vec::new();
        for reset_after in [7, 600, 605, 1_291] {
            ring.reset();
            list.clear();
            for number in 0..reset_after {
                list.push(numbered(number));
                // Some pattern that no period of the ring hides.
                let origin = |number: usize| {
                    if number % 7 < 2 || number % 11 == 3 {
                        Origin::Bridged
                    } else {
                        Origin::Received
                    }
                };
                let completed = ring.push(numbered(number), origin(number));
                assert_eq!(completed, list.len().is_multiple_of(PATCH));

                let whole: Vec<_> = list.as_chunks::<PATCH>().0.iter().collect();
                let incomplete = usize::from(!list.len().is_multiple_of(PATCH));
                let kept = if list.len() > WINDOW {
                    WINDOW_PATCHES - incomplete
                } else {
                    whole.len()
                };
                let expected = &whole[whole.len() - kept..];
                assert_eq!(ring.complete(), kept);
                let newest_first: Vec<_> = (0..kept).map(|back| ring.before_newest(back)).collect();
                assert!(newest_first.into_iter().rev().eq(expected.iter().copied()));
                assert_eq!(ring.contiguous() as usize, list.len());
                assert_eq!(ring.is_full(), list.len() >= WINDOW);
                // The newest 600 samples less those whose patch the incomplete one overwrites.
                let held = if list.len() > WINDOW {
                    WINDOW - (PATCH - list.len() % PATCH) % PATCH
                } else {
                    list.len()
                };
                let bridged = (list.len() - held..list.len())
                    .filter(|&number| origin(number) == Origin::Bridged)
                    .count();
                assert_eq!(ring.bridged() as usize, bridged);
            }
        }
    }
}
