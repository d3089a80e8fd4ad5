//! Detection of two armbands in one file by its rows: alternating, or with a column that names devices.

use std::collections::BTreeMap;

use shared::units::CHANNELS;

use super::signal::{Signal, mean};
use crate::examiner::finding::Finding;

/// Names of columns that say from which armband a row came.
#[rustfmt::skip]
const DEVICES: [&str; 10] = [
    "device", "device_id", "deviceid", "dev", "armband", "band", "myo", "myo_id", "mac", "address",
];
/// Names of columns that say it only if they change from row to row.
const SIDES: [&str; 4] = ["arm", "side", "hand", "source"];
/// Minimum number of samples for the detection of alternating rows.
const ENOUGH: usize = 1200;
/// Ratio of a channel's amplitude in every second row to that in the others, which shows two armbands; one armband has
/// at most 1.15.
const UNLIKE: f64 = 1.3;
/// Minimum amplitude of a channel that is compared.
const LOUD: f64 = 1.5;
/// Mean correlation over channels below which samples are 5 ms apart. `UNRELATED` is the limit of each channel.
const RELATED: f64 = -0.17;
const UNRELATED: f64 = -0.11;
/// Minimum number of channels that must agree.
const FEWEST: usize = 3;

/// Kind of the findings of two armbands in a file.
pub(super) const TWO_ARMBANDS: &str = "two-armbands";

/// Whether a column says from which armband a row came, by its name.
pub(crate) fn is_device(name: &str) -> bool {
    let name = plain(name);
    DEVICES.contains(&&*name) || SIDES.contains(&&*name)
}

fn plain(name: &str) -> String {
    name.trim().trim_matches('"').to_lowercase()
}

/// Maximum number of devices whose names are kept: a column of other numbers has any number of values.
const MOST_DEVICES: usize = 9;

/// Refuses rows of several armbands, by the texts of a column of this name.
pub(crate) fn of_devices<'t>(
    name: &str,
    texts: impl Iterator<Item = &'t str>,
) -> Result<(), Finding> {
    let mut rows: BTreeMap<&str, usize> = BTreeMap::new();
    let (mut last, mut changes) = ("", 0);
    for text in texts {
        let text = text.trim().trim_matches('"');
        changes += usize::from(text != std::mem::replace(&mut last, text));
        if rows.contains_key(text) || rows.len() < MOST_DEVICES {
            *rows.entry(text).or_default() += 1;
        }
    }
    let in_turn = 10 * changes > rows.values().sum::<usize>();
    if rows.len() < 2 || !in_turn && SIDES.contains(&&*plain(name)) {
        return Ok(());
    }
    let devices: Vec<&str> = rows.into_keys().collect();
    Err(Finding::warning(
        TWO_ARMBANDS,
        format!(
            "expected the rows of one armband, found those of {} in column \"{name}\": {}",
            devices.len(),
            devices.join(", ")
        ),
        "keep the rows of one armband in a file",
    ))
}

/// Refuses alternating samples of two armbands: one or two of each in turn.
pub(super) fn in_turn(signal: &Signal<'_>) -> Result<(), Finding> {
    let samples = signal.samples;
    if samples.len() < ENOUGH {
        return Ok(());
    }
    let found = |rows: usize| {
        Err(Finding::warning(
            TWO_ARMBANDS,
            format!("expected the samples of one armband, found two in turn, {rows} of each"),
            "write each armband's rows into a file of its own",
        ))
    };
    for channel in (0..CHANNELS).filter(|&channel| signal.levels[channel] > LOUD) {
        let level = |first: usize| {
            let rows = samples.iter().skip(first).step_by(2);
            let off = rows.map(|sample| (f64::from(sample[channel]) - signal.means[channel]).abs());
            off.sum::<f64>() / (samples.len() / 2) as f64
        };
        let (even, odd) = (level(0), level(1));
        if even.max(odd) > UNLIKE * even.min(odd) {
            return found(1);
        }
    }
    // All loud channels must agree: a single one may follow the arm's movement.
    let related = |all: &[f64]| {
        all.len() >= FEWEST && all.iter().all(|&own| own < UNRELATED) && mean(all) < RELATED
    };
    let unrelated = |all: &[f64]| all.iter().all(|&own| own > UNRELATED);
    if related(&signal.autocorrelations(2, 0, 1)) && unrelated(&signal.autocorrelations(1, 0, 1)) {
        return found(1);
    }
    let phases = [0, 1].map(|phase| signal.autocorrelations(1, phase, 2));
    for (one, other) in [(0, 1), (1, 0)] {
        if related(&phases[one]) && unrelated(&phases[other]) {
            return found(2);
        }
    }
    Ok(())
}
