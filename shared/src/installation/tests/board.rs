//! A board with simulated flash, whose power may fail.

use super::*;

/// Power has failed.
#[derive(Debug, PartialEq)]
pub(super) struct PowerFailed;

/// Memory that outlasts a loss of power: erased to ones, programmed to zeros.
#[derive(Clone)]
pub(super) struct Flash {
    pub(super) region: Vec<u8>,
    pub(super) journal: [u8; JOURNAL_BYTES],
    /// Operations until power fails, in the middle of one.
    pub(super) left: usize,
}

impl Flash {
    pub(super) fn of(file: &[u8]) -> Self {
        let mut region = file.to_vec();
        region.resize(CAPACITY, 0xff);
        Self {
            region,
            journal: [0xff; JOURNAL_BYTES],
            left: usize::MAX,
        }
    }

    /// Part of an operation that is done.
    fn part(&mut self, of: usize) -> usize {
        self.left -= 1;
        if self.left == 0 { of / 2 } else { of }
    }

    fn power(&self) -> Result<(), PowerFailed> {
        if self.left == 0 {
            Err(PowerFailed)
        } else {
            Ok(())
        }
    }

    pub(super) fn holds(&self, file: &[u8]) -> bool {
        self.region.starts_with(file)
    }

    fn program(bytes: &mut [u8], content: &[u8]) {
        for (byte, content) in bytes.iter_mut().zip(content) {
            assert_eq!(*byte & content, *content, "written without an erasure");
            *byte &= content;
        }
    }
}

/// A board: its flash, and what a loss of power takes.
pub(super) struct Board {
    pub(super) flash: Flash,
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
    pub(super) fn start(flash: Flash, models: &[&[u8]]) -> Self {
        let whole = models.iter().find(|model| flash.holds(model));
        Self {
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
        match step {
            InstallationStep::Suspend => {
                self.is_safe = true;
                self.in_use = None;
                return Ok(Ok(()));
            }
            InstallationStep::Verify => {
                return Ok(self.flash.holds(file).then_some(()).ok_or(Refused::Model));
            }
            InstallationStep::Resume => {
                let whole = self.models.iter().find(|model| self.flash.holds(model));
                self.in_use = whole.map(|model| model[0]);
                self.is_safe = whole.is_none();
                return Ok(whole.map(|_| ()).ok_or(Refused::Model));
            }
            _ => assert!(
                self.is_safe && self.in_use.is_none(),
                "{step:?} while a model is in use"
            ),
        }
        let flash = &mut self.flash;
        match step {
            InstallationStep::EraseJournal | InstallationStep::EndJournal => {
                let part = flash.part(JOURNAL_BYTES);
                flash.journal[..part].fill(0xff);
            }
            InstallationStep::WriteJournal => {
                let record = self.installation.record();
                let part = flash.part(record.len());
                Flash::program(&mut flash.journal[..part], &record);
            }
            InstallationStep::ErasePage(page) => {
                let part = flash.part(PAGE_BYTES);
                flash.region[page as usize * PAGE_BYTES..][..part].fill(0xff);
            }
            InstallationStep::WriteBlock(number) => {
                let part = flash.part(BLOCK_BYTES);
                let place = number as usize * BLOCK_BYTES;
                let content = self.installation.content().0;
                Flash::program(&mut flash.region[place..][..part], &content);
            }
            InstallationStep::MarkPage(page) => {
                let part = flash.part(4);
                Flash::program(
                    &mut flash.journal[journal::mark(page) as usize..][..part],
                    &[0; 4],
                );
            }
            InstallationStep::Suspend | InstallationStep::Verify | InstallationStep::Resume => {}
        }
        flash.power().map(Ok)
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
