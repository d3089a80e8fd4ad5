//! Window of a pipeline: the samples that the encoder takes, their positions, and what was lost of them.

use crate::stream::alignment::Alignment;
use crate::stream::preprocess::{Preprocessing, Preprocessor};
use crate::stream::ring::{Origin, SampleRing};
use crate::stream::safe_state::Cause;
use crate::uart_line::Counters;
use crate::units::{PATCH, Patch, Sample, SampleIndex, WINDOW_PATCHES};

/// Most consecutive lost samples that are filled in, by repeating the last sample before them.
const MAX_BRIDGED: u32 = 5;

/// Most samples of a window of 600 that are filled in: 10 %. What that costs was measured: docs/decisions.md.
const MAX_BRIDGED_OF_WINDOW: u32 = 60;

/// Samples since the last reset, preprocessed, and their positions.
#[derive(Debug)]
pub(super) struct Window {
    pub(super) preprocessing: Preprocessing,
    preprocessor: Preprocessor,
    pub(super) ring: SampleRing,
    /// Complete patches in the ring that the encoder has yet to take, the newest ones.
    behind: usize,
    /// The newest sample of the ring's newest complete patch.
    pub(super) newest_end: SampleIndex,
    /// Position of the next sample.
    next: SampleIndex,
    /// Position of the newest sample, lost ones included; 0 before the first.
    pub(super) newest: SampleIndex,
    /// The last sample, aligned, which fills gaps; `None` where no gap may be filled.
    last: Option<Sample>,
    pub(super) counters: Counters,
}

/// Patch that the encoder takes next.
pub(super) struct Next<'w> {
    pub(super) patch: &'w Patch,
    /// Newest sample of the patch.
    pub(super) end: SampleIndex,
    /// Patches that the encoder has yet to take after it.
    pub(super) behind: usize,
    /// Whether the window that ends with it is full.
    pub(super) is_full: bool,
}

/// Consequence of lost samples.
pub(super) enum Loss {
    /// This sample fills them in.
    Bridged(Sample),
    /// The window ends: the gap is longer than may be filled in, or else its window has lost too many.
    Ended(Cause),
    /// The window is empty.
    None,
}

impl Window {
    /// An empty window for a model of the default preprocessing.
    // Constructed in place: a device's stack has no room for a second one.
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            preprocessing: Preprocessing::default(),
            preprocessor: Preprocessor::default(),
            ring: SampleRing::default(),
            behind: 0,
            newest_end: SampleIndex(0),
            next: SampleIndex(0),
            newest: SampleIndex(0),
            last: None,
            counters: Counters::default(),
        }
    }

    /// Sets the preprocessing; samples so far stay as they are.
    pub(super) const fn preprocess(&mut self, preprocessing: Preprocessing) {
        self.preprocessing = preprocessing;
        self.preprocessor = Preprocessor::new(preprocessing.median);
    }

    /// Takes one sample, aligned, received or filled in; returns whether it completes a patch.
    pub(super) fn push(&mut self, sample: Sample, origin: Origin) -> bool {
        self.newest = self.next;
        self.next = self.newest.plus(1);
        self.last = Some(sample);
        let Some(clean) = self.preprocessor.push(sample) else {
            return false;
        };
        let is_complete = self.ring.push(clean, origin);
        if is_complete {
            // The preprocessor lags one sample.
            self.newest_end = SampleIndex(self.newest.0.wrapping_sub(1));
            self.behind += 1;
        }
        is_complete
    }

    /// Whether the encoder has yet to take a patch.
    pub(super) const fn is_behind(&self) -> bool {
        self.behind > 0
    }

    /// The next patch for the encoder. To be called if it [has one to take](Self::is_behind).
    pub(super) fn take(&mut self) -> Next<'_> {
        let behind = self.behind.min(self.ring.complete()).saturating_sub(1);
        self.behind = behind;
        let after = (behind * PATCH) as u32;
        Next {
            patch: self.ring.before_newest(behind),
            end: SampleIndex(self.newest_end.0.wrapping_sub(after)),
            behind,
            is_full: self.ring.contiguous() as usize / PATCH >= WINDOW_PATCHES + behind,
        }
    }

    /// Has the encoder take all patches again.
    pub(super) fn rewind(&mut self) {
        self.behind = self.ring.complete();
    }

    /// Rearranges the electrodes of all samples so far.
    pub(super) fn rearrange(&mut self, change: Alignment) {
        self.preprocessor.rearrange(change);
        self.ring.rearrange(change);
        self.last = self.last.map(|sample| change.apply(sample));
    }

    /// Counts samples that are missing before the next one, and passes over their positions unless they are filled in.
    pub(super) fn lose(&mut self, missing: u32) -> Loss {
        self.counters.lost = self.counters.lost.saturating_add(missing);
        let is_long = missing > MAX_BRIDGED;
        if let Some(last) = self.last
            && !is_long
            && self.ring.bridged() + missing <= MAX_BRIDGED_OF_WINDOW
        {
            self.counters.bridged = self.counters.bridged.saturating_add(missing);
            return Loss::Bridged(last);
        }
        if missing > 0 {
            self.newest = self.next.plus(missing - 1);
            self.next = self.newest.plus(1);
        }
        match self.last {
            Some(_) if is_long => Loss::Ended(Cause::Gap),
            Some(_) => Loss::Ended(Cause::Losses),
            None => Loss::None,
        }
    }

    /// Empties the window: the next sample does not follow the previous one. Returns whether there was a sample.
    pub(super) fn reset(&mut self) -> bool {
        if self.last.take().is_none() {
            return false;
        }
        self.counters.resets = self.counters.resets.saturating_add(1);
        self.preprocessor = Preprocessor::new(self.preprocessing.median);
        self.ring.reset();
        self.behind = 0;
        true
    }
}
