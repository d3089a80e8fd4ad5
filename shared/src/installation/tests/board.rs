//! A board with simulated flash, whose power may fail.

use super::*;

/// Power has failed.
#[derive(Debug, PartialEq)]
pub(super) struct PowerFailed;

/// Flash whose region holds this file.
pub(super) fn flash(file: &[u8]) -> SimulatedFlash {
    let mut region = file.to_vec();
    region.resize(CAPACITY, 0xff);
    SimulatedFlash::new(region)
}

/// A board: its flash, and what a loss of power takes.
pub(super) struct Board {
    pub(super) flash: SimulatedFlash,
    /// Operations of flash until power fails, in the middle of one.
    pub(super) left: usize,
    pub(super) installation: Installation,
    /// The model that is in use, by its first byte.
    pub(super) in_use: Option<u8>,
    pub(super) is_safe: bool,
    /// Step that fails next, once.
    pub(super) failing: Option<(InstallationStep, Refused)>,
    /// Files that count as models.
    models: Vec<Vec<u8>>,
}

impl Board {
    /// A start; these are the files that count as models.
    pub(super) fn start(flash: SimulatedFlash, models: &[&[u8]]) -> Self {
        let whole = models.iter().find(|model| flash.region.starts_with(model));
        Self {
            left: usize::MAX,
            in_use: whole.map(|model| model[0]),
            is_safe: whole.is_none(),
            failing: None,
            models: models.iter().map(|model| model.to_vec()).collect(),
            installation: Installation::new(CAPACITY as u32),
            flash,
        }
    }

    fn journal(&self) -> Option<Journal> {
        journal::read(&self.flash.journal).filter(|_| self.in_use.is_none())
    }

    pub(super) fn begin(&mut self, transfer: Transfer) -> Result<InstallationProgress, Refused> {
        let journal = self.journal();
        self.installation.begin(transfer, journal)
    }

    pub(super) fn take(
        &mut self,
        file: &[u8],
        number: u32,
    ) -> Result<Result<InstallationProgress, Refused>, PowerFailed> {
        let taken = self
            .installation
            .take(number, &Block::of(file, number), |block| block.0[0] < 0x80);
        if let Err(refused) = taken {
            return Ok(Err(refused));
        }
        while let Some(step) = self.installation.step() {
            let outcome = self.carry_out(step, file)?;
            if let Err(refused) = self.installation.done(outcome) {
                return Ok(Err(refused));
            }
        }
        Ok(Ok(self.installation.progress()))
    }

    fn carry_out(
        &mut self,
        step: InstallationStep,
        file: &[u8],
    ) -> Result<Result<(), Refused>, PowerFailed> {
        if let Some((_, refused)) = self.failing.take_if(|(failing, _)| *failing == step) {
            return Ok(Err(refused));
        }
        let region = &self.flash.region;
        match step {
            InstallationStep::Suspend => {
                self.is_safe = true;
                self.in_use = None;
                Ok(Ok(()))
            }
            InstallationStep::Verify => {
                let is_whole = region.starts_with(file);
                Ok(is_whole.then_some(()).ok_or(Refused::Model))
            }
            InstallationStep::Resume => {
                let whole = self.models.iter().find(|model| region.starts_with(model));
                self.in_use = whole.map(|model| model[0]);
                self.is_safe = whole.is_none();
                Ok(whole.map(|_| ()).ok_or(Refused::Model))
            }
            _ => {
                assert!(
                    self.is_safe && self.in_use.is_none(),
                    "{step:?} while a model is in use"
                );
                self.left -= 1;
                let power_fails = self.left == 0;
                self.flash.carry_out(&self.installation, step, power_fails);
                if power_fails {
                    Err(PowerFailed)
                } else {
                    Ok(Ok(()))
                }
            }
        }
    }
}

/// Sends a file until it is in use or power fails; returns the number of blocks sent.
pub(super) fn send(board: &mut Board, file: &[u8]) -> Result<usize, PowerFailed> {
    let mut sent = 0;
    let mut progress = board.begin(transfer(file)).unwrap();
    while let InstallationProgress::Next(number) = progress {
        progress = board.take(file, number)?.unwrap();
        sent += 1;
    }
    Ok(sent)
}
