//! Layout of the picture, from top to bottom, and its time axis.

use shared::units::CHANNELS;

use crate::report::canvas::SCALE;

/// Width of the picture, and of its margins, in pixels.
pub(super) const WIDTH: i32 = 1100;
pub(super) const LEFT: i32 = 78;
pub(super) const RIGHT: i32 = 14;
/// Head line: recording and legend.
pub(super) const HEAD: i32 = 34;
/// Height of the strip of a channel.
pub(super) const STRIP: i32 = 30;
/// Upper edges of the two bands of labels, and their height.
pub(super) const TRUTH: i32 = HEAD + STRIP * CHANNELS as i32 + 12;
pub(super) const BAND: i32 = 24;
pub(super) const EMITTED: i32 = TRUTH + BAND + 5;
/// Bars from the reference time of a new label to its emission.
pub(super) const DELAY: i32 = EMITTED + BAND + 3;
pub(super) const AXIS: i32 = DELAY + 10;
pub(super) const HEIGHT: i32 = AXIS + 36;

/// Time axis: converts samples to units of the drawing.
pub(super) struct Axis {
    /// Samples over the whole width, at least 1.
    pub samples: usize,
}

impl Axis {
    /// Position of a time between samples.
    pub fn x(&self, sample: f64) -> i32 {
        let width = f64::from((WIDTH - LEFT - RIGHT) * SCALE);
        LEFT * SCALE
            + (width * sample.min(self.samples as f64) / self.samples as f64).round() as i32
    }

    /// Position of the start of a sample.
    pub fn at(&self, sample: usize) -> i32 {
        self.x(sample as f64)
    }
}
