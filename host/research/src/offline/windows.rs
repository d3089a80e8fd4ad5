//! The outputs of overlapping windows, as many of them as an aggregation can ask for.

use shared::units::WINDOW;

use super::OfflineError;

/// Logits of a recording's windows, which start at samples 0, `stride`, 2 `stride`, ...: of the
/// first window all rows, of the others only the newest, which are all that is ever asked for.
#[derive(Clone, PartialEq, Debug)]
pub struct WindowRows {
    pub(super) classes: usize,
    stride: usize,
    /// Rows kept of every window but the first.
    pub(super) kept: usize,
    count: usize,
    first: Vec<f32>,
    newest: Vec<f32>,
}

impl WindowRows {
    /// No windows yet. Rows have `classes` logits; windows will serve a look-ahead of up to
    /// `look_ahead` samples.
    ///
    /// # Errors
    /// Refuses rows of no logits, a stride of 0 and a look-ahead that no window spans.
    pub fn new(classes: usize, stride: usize, look_ahead: usize) -> Result<Self, OfflineError> {
        if classes == 0 {
            return Err(OfflineError::Classes { most: 0, found: 0 });
        }
        if stride == 0 {
            return Err(OfflineError::Stride);
        }
        if look_ahead >= WINDOW {
            return Err(OfflineError::Rows {
                expected: look_ahead + 1,
                found: WINDOW,
            });
        }
        Ok(Self {
            classes,
            stride,
            kept: look_ahead + 1,
            count: 0,
            first: Vec::new(),
            newest: Vec::new(),
        })
    }

    /// Takes the next window's logits, oldest row first: `[rows][classes]`, all 600 rows for the
    /// first window, at least `look_ahead + 1` newest rows for the others.
    ///
    /// # Errors
    /// Refuses fewer rows, more than 600, and a broken row; then nothing is taken.
    pub fn push(&mut self, logits: &[f32]) -> Result<(), OfflineError> {
        let fewest = if self.count == 0 { WINDOW } else { self.kept };
        let whole = logits.len().is_multiple_of(self.classes);
        if !whole || !(fewest..=WINDOW).contains(&(logits.len() / self.classes)) {
            return Err(OfflineError::Logits {
                fewest: fewest * self.classes,
                most: WINDOW * self.classes,
                classes: self.classes,
                found: logits.len(),
            });
        }
        if self.count == 0 {
            self.first = logits.to_vec();
        }
        self.newest
            .extend_from_slice(&logits[logits.len() - self.kept * self.classes..]);
        self.count += 1;
        Ok(())
    }

    /// Windows so far.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.count
    }

    /// Last sample of a window.
    pub(super) const fn end(&self, window: usize) -> usize {
        window * self.stride + WINDOW - 1
    }

    /// The windows that end with a sample of `at..=at + look_ahead`; before any ends, the first.
    pub(super) fn speaking(&self, at: usize, look_ahead: usize) -> std::ops::Range<usize> {
        // Windows that end before a sample: those whose start lies before sample - 599.
        let before = |sample: usize| {
            (sample + 1)
                .saturating_sub(WINDOW)
                .div_ceil(self.stride)
                .min(self.count)
        };
        let speaking = before(at)..before(at + look_ahead + 1);
        if speaking.is_empty() && at < WINDOW {
            0..self.count.min(1)
        } else {
            speaking
        }
    }

    /// What a window says of a sample: of the first window any of its samples, of the others one
    /// of those kept.
    pub(super) fn row(&self, window: usize, sample: usize) -> &[f32] {
        let (rows, row) = if window == 0 {
            (&self.first, sample)
        } else {
            let back = self.end(window) - sample;
            (&self.newest, (window + 1) * self.kept - 1 - back)
        };
        &rows[row * self.classes..][..self.classes]
    }
}
