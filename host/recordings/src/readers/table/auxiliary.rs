//! Columns beside the channels of a csv: a clock, and from which armband a row came.

use shared::units::Sample;

use crate::examiner::bands::{Devices, is_device};
use crate::examiner::clock::{Clock, column};
use crate::examiner::finding::Finding;
use crate::examiner::rows::Rows;
use crate::readers::table::columns::Columns;
use crate::readers::table::separator::Separator;

/// Column of recordings by `myointent record` that says which samples were filled in.
const FILLED_IN: &str = "bridged";

/// Columns of times and of devices, as rows are read.
#[derive(Default)]
pub(crate) struct AuxiliaryColumns {
    /// The clock by its name, or all candidates where columns have no names.
    clocks: Vec<(usize, Clock)>,
    devices: Option<(usize, Devices)>,
    /// Whether a column marks filled-in samples, which explain repeats.
    filled_in: bool,
}

impl AuxiliaryColumns {
    /// Finds clocks and devices among the columns that are neither channel nor label.
    pub fn find(columns: &Columns) -> Self {
        let taken = |at: &usize| columns.channels.contains(at) || columns.label == Some(*at);
        let others: Vec<usize> = (0..columns.count).filter(|at| !taken(at)).collect();
        let name = |at: usize| columns.names.get(at).map_or("", |name| name.trim());
        let clocks = if columns.names.is_empty() {
            let clock = |at: usize| (at, Clock::of(unnamed(at)));
            others.iter().map(|&at| clock(at)).collect()
        } else {
            let names: Vec<&str> = others.iter().map(|&at| name(at)).collect();
            let clock = column(&names).map(|found| others[found]);
            let named = |at: usize| (at, Clock::of(name(at).to_owned()));
            clock.into_iter().map(named).collect()
        };
        let device = others.iter().copied().find(|&at| is_device(name(at)));
        Self {
            clocks,
            devices: device.map(|at| (at, Devices::of(name(at).to_owned()))),
            filled_in: columns.position(FILLED_IN).is_some(),
        }
    }

    /// The columns with a clock in this column alone, or none.
    pub fn clocked(self, at: Option<usize>, names: &[String]) -> Self {
        let name = |at: usize| names.get(at).cloned().unwrap_or_else(|| unnamed(at));
        Self {
            clocks: at.map(|at| (at, Clock::of(name(at)))).into_iter().collect(),
            ..self
        }
    }

    /// Clock that gives the rate: times take precedence over row numbers.
    pub fn clock(&self) -> Option<&Clock> {
        let clocks = || self.clocks.iter().map(|(_, clock)| clock);
        let times = clocks().find(|clock| !clock.counts());
        times.or_else(|| clocks().next())
    }

    /// Adds the fields of a row.
    pub fn push(&mut self, separator: Separator, fields: &[&str]) {
        for (at, clock) in &mut self.clocks {
            clock.push(&separator.number(fields[*at]));
        }
        if let Some((at, devices)) = &mut self.devices {
            devices.push(fields[*at]);
        }
    }

    /// Judges samples, one per row, by these columns.
    ///
    /// # Errors
    /// When the rows are those of several armbands, or not at 200 Hz.
    pub fn rows(&self, samples: &[Sample]) -> Result<Rows, Finding> {
        if let Some((_, devices)) = &self.devices {
            devices.judge()?;
        }
        Rows::of(samples, self.clock(), self.filled_in)
    }
}

/// Name of a column without one.
pub(crate) fn unnamed(at: usize) -> String {
    format!("number {}", at + 1)
}
