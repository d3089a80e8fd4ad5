//! Columns beside the channels of a csv: a clock, and from which armband a row came.

use shared::units::Sample;

use crate::dataset::examiner::bands::{Devices, device_column};
use crate::dataset::examiner::clock::{Clock, column};
use crate::dataset::examiner::rows::Rows;
use crate::dataset::finding::Finding;

/// Column of recordings by `myointent record` that says which samples were filled in.
const FILLED_IN: &str = "bridged";

/// Columns of times and of devices, as rows are read.
#[derive(Default)]
pub(crate) struct Beside {
    clock: Option<(usize, Clock)>,
    devices: Option<(usize, Devices)>,
    /// Repeats are filled-in samples, and said to be.
    filled_in: bool,
}

impl Beside {
    /// Finds them by the names of a header.
    pub fn find(names: &[String]) -> Self {
        let name = |at: usize| names[at].trim().to_owned();
        Self {
            clock: column(names).map(|at| (at, Clock::of(name(at)))),
            devices: device_column(names).map(|at| (at, Devices::of(name(at)))),
            filled_in: names.iter().any(|name| name == FILLED_IN),
        }
    }

    /// Takes the fields of a row.
    pub fn push(&mut self, fields: &[&str]) {
        if let Some((at, clock)) = &mut self.clock {
            clock.push(fields[*at]);
        }
        if let Some((at, devices)) = &mut self.devices {
            devices.push(fields[*at]);
        }
    }

    /// What they say of samples, one a row.
    ///
    /// # Errors
    /// When the rows are those of several armbands, or not at 200 Hz.
    pub fn rows(&self, samples: &[Sample]) -> Result<Rows, Finding> {
        if let Some((_, devices)) = &self.devices {
            devices.judge()?;
        }
        let clock = self.clock.as_ref().map(|(_, clock)| clock);
        Rows::of(samples, clock, self.filled_in)
    }
}
