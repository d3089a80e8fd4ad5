//! Columns beside the channels of a table: a clock, and from which armband a row came.

use shared::units::Sample;

use crate::examiner::bands::{is_device, of_devices};
use crate::examiner::clock::{Clock, seconds_of};
use crate::examiner::finding::Finding;
use crate::examiner::rows::JudgedRows;
use crate::readers::table::columns::Columns;

/// Column of recordings by `myointent record` that says which samples were filled in.
const FILLED_IN: &str = "bridged";

/// Findings in the columns beside the channels: clock, devices, marks of filled-in samples.
#[derive(Default)]
pub(crate) struct Auxiliary {
    /// Clock that gives the rate.
    pub clock: Option<Clock>,
    /// Finding on rows of several armbands.
    devices: Option<Finding>,
    /// Whether a column marks filled-in samples, which explain repeats.
    filled_in: bool,
}

impl Auxiliary {
    /// Judges the columns of a text; the only clock is column `time`, if that is described.
    pub fn of_table(text: &str, columns: &Columns, time: Option<usize>) -> Self {
        let device = columns.others().find(|&at| is_device(&columns.name(at)));
        let devices =
            device.and_then(|at| of_devices(&columns.name(at), columns.texts(text, at)).err());
        let second = |text: &str| seconds_of(&columns.separator.number(text)).unwrap_or(f64::NAN);
        let times = |at| columns.texts(text, at).map(second);
        Self {
            devices,
            filled_in: columns.position(FILLED_IN).is_some(),
            ..Self::of_times(columns, time, times)
        }
    }

    /// Finds the clock; `times` gives the times of a column.
    pub fn of_times<T: Iterator<Item = f64>>(
        columns: &Columns,
        time: Option<usize>,
        times: impl Fn(usize) -> T,
    ) -> Self {
        let candidates = time.map_or_else(|| columns.others().collect(), |at| vec![at]);
        let ranked = candidates.into_iter().filter_map(|at| {
            let clock = Clock::of(columns.name(at), time.is_some(), times(at))?;
            Some((clock.precedence()?, clock))
        });
        let first = ranked.min_by_key(|(rank, _)| *rank);
        Self {
            clock: first.map(|(_, clock)| clock),
            ..Self::default()
        }
    }

    /// Judges samples, one per row, by these columns.
    ///
    /// # Errors
    /// When the rows are those of several armbands, or not at 200 Hz.
    pub fn rows(self, samples: &[Sample]) -> Result<JudgedRows, Finding> {
        match self.devices {
            Some(finding) => Err(finding),
            None => JudgedRows::of(samples, self.clock.as_ref(), self.filled_in),
        }
    }
}
