//! Logits of overlapping windows, as far as an aggregation needs them.

use shared::units::WINDOW;

use super::error::OfflineError;

/// Logits of a recording's windows, which start at samples 0, `stride`, 2 `stride`, ...
///
/// All rows of the first window are kept, and of the others only the newest, which are all that an
/// aggregation reads.
#[derive(Clone, PartialEq, Debug)]
pub struct WindowLogits {
    /// Logits per row.
    pub(super) classes: usize,
    stride: usize,
    /// Rows kept of every window but the first.
    pub(super) kept: usize,
    count: usize,
    first: Vec<f32>,
    newest: Vec<f32>,
}

impl WindowLogits {
    /// No windows yet. Rows have `classes` logits, and look-aheads of up to `look_ahead` samples will be
    /// possible.
    ///
    /// # Errors
    /// For 0 classes, a stride of 0 and a look-ahead of a window or more.
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

    /// Appends the next window's logits `[rows][classes]`, oldest row first: all 600 rows of the first
    /// window, at least the `look_ahead + 1` newest rows of the others.
    ///
    /// # Errors
    /// For fewer rows, more than 600, and an incomplete row; then nothing is appended.
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

    /// Number of windows.
    pub(super) const fn count(&self) -> usize {
        self.count
    }

    /// The last sample of a window.
    pub(super) const fn end(&self, window: usize) -> usize {
        window * self.stride + WINDOW - 1
    }

    /// The windows that end with a sample of `at..=at + look_ahead`; the first window while none has ended.
    pub(super) fn contributing(&self, at: usize, look_ahead: usize) -> std::ops::Range<usize> {
        // Number of windows that end before a sample: their start is before sample - 599.
        let before = |sample: usize| {
            (sample + 1)
                .saturating_sub(WINDOW)
                .div_ceil(self.stride)
                .min(self.count)
        };
        let contributing = before(at)..before(at + look_ahead + 1);
        if contributing.is_empty() && at < WINDOW {
            0..self.count.min(1)
        } else {
            contributing
        }
    }

    /// A window's logits at a sample: any sample of the first window, one of the kept rows of the
    /// others.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stride_of_0_and_incomplete_rows_are_refused() {
        assert_eq!(WindowLogits::new(3, 0, 0), Err(OfflineError::Stride));
        let mut windows = WindowLogits::new(3, 1, 1).unwrap();
        windows.push(&[0.0; 3 * WINDOW]).unwrap();
        let refused = OfflineError::Logits {
            fewest: 6,
            most: 1800,
            classes: 3,
            found: 5,
        };
        assert_eq!(windows.push(&[0.0; 5]), Err(refused));
        assert_eq!(windows.count(), 1);
    }
}
