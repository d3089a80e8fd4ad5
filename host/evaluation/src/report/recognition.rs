//! Picture of the share of gestures recognised, by the time since their onset.

use recordings::statistics::MeanSd;

use super::MOST_ENTRIES;
use super::entry::Entry;
use super::pictures::charts::{self, Panel};
use super::pictures::stand_alone;
use super::row::over_all;
use crate::{ENERGY, Score};

/// Time after the onset up to which recognition is drawn, in ms, and the time between two points.
const SOON_MS: u32 = 600;
const STEP_MS: usize = 10;

/// Name of a system and the points of its curve: milliseconds, and the share of gestures recognised within them.
pub type Curve = (String, Vec<(f64, f64)>);

/// Curve of a system, from its share of gestures recognised within a number of milliseconds; `None` without a share.
pub fn curve(name: impl Into<String>, share: impl Fn(u32) -> Option<f64>) -> Option<Curve> {
    let at = |ms: u32| Some((f64::from(ms), share(ms)?));
    let points: Vec<_> = (0..=SOON_MS).step_by(STEP_MS).filter_map(at).collect();
    (!points.is_empty()).then(|| (name.into(), points))
}

/// SVG file of the curves of systems, the first ones if there are more than colours, and of a floor; none without a curve.
pub fn svg(systems: impl Iterator<Item = Curve>, floor: Option<Curve>) -> Option<String> {
    Some(stand_alone(&charts::curves(&panel(systems, floor)?)))
}

/// Panel of each entry and of the energy detector: the mean over people who have all classes, if there are any.
pub(super) fn of_entries(entries: &[Entry<'_>]) -> Option<Panel> {
    let people = over_all(&entries.first()?.scores).next()?.people;
    let of = |name: &str, score: &Score| {
        curve(name, |ms| {
            let shares = score.recognised_within(ms).into_iter();
            let shares: Vec<f64> = shares.map(|(_, share)| share).collect();
            Some(MeanSd::of(&shares)?.mean)
        })
    };
    let systems = entries.iter().filter_map(|entry| {
        let own = over_all(&entry.scores).find(|score| score.people == people)?;
        of(&entry.name, own)
    });
    let mut energy = entries.first()?.energy();
    let energy = energy.find(|floor| floor.people == people);
    panel(systems, energy.and_then(|floor| of(ENERGY, floor)))
}

fn panel(systems: impl Iterator<Item = Curve>, floor: Option<Curve>) -> Option<Panel> {
    let curves: Vec<Curve> = systems.take(MOST_ENTRIES - 1).chain(floor).collect();
    (!curves.is_empty()).then(|| Panel {
        title: "Share of gestures recognised so soon after their onset".to_owned(),
        axis: "emitted label after onset, ms",
        curves,
    })
}
