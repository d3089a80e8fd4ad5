//! Picture of the share of gestures recognised, by the time since their onset.

use super::MOST_ENTRIES;
use super::pictures::charts::{self, Panel};
use super::pictures::stand_alone;

/// Time after the onset up to which recognition is drawn, in ms, and the time between two points.
const SOON_MS: u32 = 600;
const STEP_MS: usize = 10;

/// Name of a system and the points of its curve: milliseconds, and the share of gestures recognised within them.
pub type Curve = (String, Vec<(f64, f64)>);

/// Curve of a system, from its share of gestures recognised within so many milliseconds; none without a share.
pub fn curve(name: impl Into<String>, share: impl Fn(u32) -> Option<f64>) -> Option<Curve> {
    let at = |ms: u32| Some((f64::from(ms), share(ms)?));
    let points: Vec<_> = (0..=SOON_MS).step_by(STEP_MS).filter_map(at).collect();
    (!points.is_empty()).then(|| (name.into(), points))
}

/// SVG file of the first [`MOST_ENTRIES`] curves; none without a curve.
#[must_use]
pub fn svg(curves: Vec<Curve>) -> Option<String> {
    Some(stand_alone(&charts::curves(&panel(curves)?)))
}

/// Panel of the first [`MOST_ENTRIES`] curves; none without a curve.
pub(super) fn panel(mut curves: Vec<Curve>) -> Option<Panel> {
    curves.truncate(MOST_ENTRIES);
    (!curves.is_empty()).then(|| Panel {
        title: "Share of gestures recognised so soon after their onset".to_owned(),
        axis: "emitted label after onset, ms",
        curves,
    })
}
