//! Columns beside the channels of a csv: a clock, and from which armband a row came.

use shared::units::Sample;

use crate::examiner::bands::{Devices, is_device};
use crate::examiner::clock::Clock;
use crate::examiner::finding::Finding;
use crate::examiner::rows::JudgedRows;
use crate::readers::table::columns::Columns;
use crate::readers::table::separator::Separator;

/// Column of recordings by `myointent record` that says which samples were filled in.
const FILLED_IN: &str = "bridged";

/// Columns of times and of devices, as rows are read.
#[derive(Default)]
pub(crate) struct AuxiliaryColumns {
    /// Columns that may be clocks.
    clocks: Vec<(usize, Clock)>,
    devices: Option<(usize, Devices)>,
    /// Whether a column marks filled-in samples, which explain repeats.
    filled_in: bool,
}

impl AuxiliaryColumns {
    /// Finds clocks and devices among the columns that are neither channel nor label; the only clock is in column `time`,
    /// if that is described.
    pub fn find(columns: &Columns, time: Option<usize>) -> Self {
        let taken = |at: &usize| columns.channels.contains(at) || columns.label == Some(*at);
        let others: Vec<usize> = (0..columns.count).filter(|at| !taken(at)).collect();
        let name = |at: usize| {
            let name = columns.names.get(at).map(|name| name.trim().to_owned());
            name.unwrap_or_else(|| unnamed(at))
        };
        let device = others.iter().copied().find(|&at| is_device(&name(at)));
        let clock = |at: usize| (at, Clock::of(name(at)));
        Self {
            clocks: match time {
                Some(at) => vec![(at, Clock::described(name(at)))],
                None => others.into_iter().map(clock).collect(),
            },
            devices: device.map(|at| (at, Devices::of(name(at)))),
            filled_in: columns.position(FILLED_IN).is_some(),
        }
    }

    /// Clock that gives the rate.
    pub fn clock(&self) -> Option<&Clock> {
        let clocks = self.clocks.iter().map(|(_, clock)| clock);
        let ranked = clocks.filter_map(|clock| Some((clock.precedence()?, clock)));
        ranked.min_by_key(|(rank, _)| *rank).map(|(_, clock)| clock)
    }

    /// Times of the rows; empty without a clock.
    pub fn times(&self) -> &[f64] {
        self.clocks.first().map_or(&[], |(_, clock)| &clock.times)
    }

    /// Adds the values of a row of an array.
    pub fn push_values(&mut self, values: &[f64]) {
        for (at, clock) in &mut self.clocks {
            clock.push_time(values[*at]);
        }
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
    pub fn rows(&self, samples: &[Sample]) -> Result<JudgedRows, Finding> {
        if let Some((_, devices)) = &self.devices {
            devices.judge()?;
        }
        JudgedRows::of(samples, self.clock(), self.filled_in)
    }
}

/// Name of a column without one.
pub(crate) fn unnamed(at: usize) -> String {
    format!("number {}", at + 1)
}
