//! MPSL's start, and its clocks (mpsl.h, mpsl_clock.h).

use super::{CLOCK, Controller, HIGH, answer, needs, take, wrong};
use crate::chip::{Chip, Owner};
use crate::core::Core;
use crate::refusal::What;
use crate::time::us;

/// Least accuracy of the low-frequency clock, ppm (`MPSL_WORST_CLOCK_ACCURACY_PPM`).
pub const WORST_ACCURACY: u16 = 500;
/// Ticks that the crystal takes to start (product specification, 5.4.7), and a little for the library.
const CRYSTAL: u64 = us(400);

#[derive(Default, Debug)]
pub struct Mpsl {
    /// The interrupt that asks for `mpsl_low_priority_process`, once it is initialized.
    low_interrupt: Option<u16>,
    /// Accuracy of the low-frequency clock, ppm.
    pub accuracy: u16,
    /// The crystal runs from then on, and this is called.
    crystal: Option<(u64, u32)>,
    /// True if the program has asked for the high-frequency crystal between radio events too.
    pub keeps_crystal: bool,
}

impl Mpsl {
    pub(super) const fn is_initialized(&self) -> bool {
        self.low_interrupt.is_some()
    }

    pub(super) fn low_interrupt(&self) -> u16 {
        self.low_interrupt.unwrap_or_default()
    }

    pub(super) fn next(&self) -> Option<u64> {
        self.crystal.map(|(at, _)| at)
    }

    /// Takes the function to call, once, if the crystal has started.
    pub(super) fn crystal_callback(&mut self, now: u64) -> Option<u32> {
        let due = self.crystal.take_if(|(at, _)| *at <= now);
        due.map(|(_, callback)| callback).filter(|one| *one != 0)
    }
}

impl Controller {
    /// Returns true if the program has asked for the high-frequency crystal between radio events too.
    pub const fn keeps_crystal(&self) -> bool {
        self.mpsl.keeps_crystal
    }

    pub(super) fn init(
        &mut self,
        [clock, interrupt, handler, _]: [u32; 4],
        chip: &mut Chip,
        core: &mut Core,
    ) -> Result<i32, What> {
        needs(!self.mpsl.is_initialized(), "for the second time")?;
        // `mpsl_clock_lfclk_cfg_t`.
        let clock = take(&chip.bus.memory, clock, 7)?;
        let (source, interval, skipped) = (clock[0], clock[1], clock[2]);
        let is_calibrated = interval != 0 || skipped != 0;
        needs(handler != 0, "without a handler of faults")?;
        needs(
            match source {
                0 => interval != 0 && skipped <= 33,
                source => source <= 2 && !is_calibrated,
            },
            "for another clock than the crystal, the synthesized one or the RC clock with calibration",
        )?;
        let running = chip.low_frequency_source();
        let running = running.ok_or_else(|| wrong("before the low-frequency clock runs"))?;
        needs(
            running == source.into(),
            &format!("for source {source} of the low-frequency clock, which runs from {running}"),
        )?;
        self.mpsl.accuracy = u16::from_le_bytes([clock[4], clock[5]]);
        let low = interrupt as u16;
        self.mpsl.low_interrupt = Some(low);
        // The program's bindings enable none of them: the library does.
        for interrupt in HIGH.into_iter().chain([CLOCK, low]) {
            core.enable(interrupt);
        }
        chip.owner = Owner::Controller;
        Ok(answer::SUCCESS)
    }

    pub(super) fn request_crystal(
        &mut self,
        [source, callback, ..]: [u32; 4],
        chip: &mut Chip,
    ) -> Result<i32, What> {
        needs(source == 0, "for an unknown source")?;
        chip.start_crystal();
        self.mpsl.keeps_crystal = true;
        self.mpsl.crystal = Some((chip.bus.now + CRYSTAL, callback));
        Ok(answer::SUCCESS)
    }
}
