//! Examiner: judges every recording once, for all commands, and reports findings.
//!
//! | module | question |
//! | --- | --- |
//! | `scale` | are the values counts of the armband? |
//! | `clock` | what does a column of times say: the rate, gaps? |
//! | `repeats` | do rows come twice? |
//! | `rows` | which rows are samples, and where does the recording break? |
//! | `bands` | are the rows those of two armbands? |
//! | `wide` | does a row hold two armbands, or several samples? |
//! | [`electrodes`] | is a channel dead, saturated or a copy of another? |
//! | `hum` | is there mains hum? |
//! | `copies` | are the samples those of another recording? |
//!
//! A recording without meaning is refused, with a finding as the error. A doubt is a finding beside the recording.
//! Thresholds were set on 8 790 public recordings, of which none is refused.

pub(crate) mod bands;
pub(crate) mod clock;
pub(crate) mod copies;
pub mod electrodes;
pub(crate) mod finding;
mod hum;
pub(crate) mod repeats;
pub(crate) mod rows;
pub(crate) mod scale;
mod signal;
pub(crate) mod wide;

use shared::units::WINDOW;

use self::finding::Finding;
use super::catalogue::DataSet;
use super::recording::Recording;
use signal::Signal;

/// Samples below which a recording is not judged: one second.
const FEWEST: usize = 200;

/// Examines the samples of a recording.
pub(crate) fn examine(recording: &Recording) -> Result<Vec<Finding>, Finding> {
    let mut findings = Vec::new();
    let samples = &recording.samples;
    if samples.len() < WINDOW {
        let what = format!(
            "{} samples: a label needs {WINDOW} and the model's look-ahead",
            samples.len()
        );
        findings.push(Finding::warning("short", what, "record longer"));
    }
    if samples.len() < FEWEST {
        return Ok(findings);
    }
    let signal = Signal::of(samples);
    let hum = hum::find(samples);
    findings.extend(electrodes::examine(&signal, hum.as_ref())?);
    // Half of that set's samples were filled in, so its neighbours cannot be judged.
    if recording.data_set != DataSet::named("uci-gestures") && hum.is_none() {
        bands::in_turn(&signal)?;
        findings.extend(rows::neighbours(&signal));
    }
    findings.extend(hum.map(|hum| hum.finding()));
    Ok(findings)
}

#[cfg(test)]
mod tests;
