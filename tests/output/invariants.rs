//! Conditions that hold in every run, whatever happened in it.

use anyhow::{Context as _, bail};
use shared::intent::Intent;
use shared::stream::safe_state::SILENCE_MS;
use shared::uart_line::ReportKind;
use virtual_armband::PinLevels;

use super::BoardOutput;

/// Longest time from the last byte to the pin: the silence, the sample's way in, and delays of a busy host.
const SAFE_WITHIN_US: u64 = SILENCE_MS as u64 * 1000 + 25_000;

/// Longest such time where a fault keeps the program from it.
const SAFE_BY_HARDWARE_WITHIN_US: u64 = 250_000;

impl BoardOutput {
    /// Checks the conditions that hold in every run; with `may_restart` the board may have restarted.
    ///
    /// # Errors
    /// Fails when a line is damaged, missing or a label while `valid` is low; when the board restarted; when `valid` fell too
    /// late, or another pin than relax's was high while it was low.
    pub fn check(&self, may_restart: bool) -> anyhow::Result<()> {
        let fault = self.bad_line(may_restart)?;
        let fault = fault.or_else(|| self.bad_pin(may_restart));
        match fault {
            Some(fault) => bail!("{fault}\n{}", self.tails()),
            None => Ok(()),
        }
    }

    fn bad_line(&self, may_restart: bool) -> anyhow::Result<Option<String>> {
        let starts = self.lines_by_start().with_context(|| self.tails())?;
        if starts.len() > 1 && !may_restart {
            return Ok(Some("the board restarted".to_owned()));
        }
        let placed = starts.iter().flat_map(|lines| lines.iter().enumerate());
        for (place, (number, report)) in placed {
            if *number as usize != place {
                return Ok(Some(format!("line {place} is numbered {number}")));
            }
            if let Some(report) = report
                && report.kind == ReportKind::Label
                && !report.status.valid()
            {
                return Ok(Some(format!("a label while not valid: {report}")));
            }
        }
        Ok(None)
    }

    fn bad_pin(&self, may_restart: bool) -> Option<String> {
        let pins = self.pins();
        let high = |pins: &&PinLevels| !pins.valid && pins.high != [Intent::Relax];
        if let Some(high) = pins.iter().find(high) {
            return Some(format!("not valid, and yet not relax: {high:?}"));
        }
        let within = if may_restart {
            SAFE_BY_HARDWARE_WITHIN_US
        } else {
            SAFE_WITHIN_US
        };
        let late = |pair: &&[PinLevels]| {
            pair[0].valid && !pair[1].valid && pair[1].since_last_byte_us() > within
        };
        let late = pins.windows(2).find(late)?;
        Some(format!("valid for too long after the last byte: {late:?}"))
    }
}
