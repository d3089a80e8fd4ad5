//! Flash in which tests install a model.

use alloc::vec::Vec;

use super::journal::{self, JOURNAL_BYTES};
use super::{BLOCK_BYTES, Installation, InstallationStep, PAGE_BYTES};

/// Memory that outlasts a loss of power: erased to ones, programmed to zeros.
#[derive(Clone, Debug)]
pub struct SimulatedFlash {
    /// Region of the model.
    pub region: Vec<u8>,
    /// Page of the journal.
    pub journal: [u8; JOURNAL_BYTES],
}

impl SimulatedFlash {
    /// A region of this content, and an erased journal.
    #[must_use]
    pub const fn new(region: Vec<u8>) -> Self {
        Self {
            region,
            journal: [0xff; JOURNAL_BYTES],
        }
    }

    /// Does what a step of an installation asks of flash; half of it where power fails.
    ///
    /// # Panics
    /// Panics where bytes are written without an erasure before.
    pub fn carry_out(
        &mut self,
        installation: &Installation,
        step: InstallationStep,
        power_fails: bool,
    ) {
        let record = installation.record();
        let (bytes, content): (_, Option<&[u8]>) = match step {
            InstallationStep::EraseJournal | InstallationStep::EndJournal => {
                (&mut self.journal[..], None)
            }
            InstallationStep::WriteJournal => (&mut self.journal[..], Some(&record)),
            InstallationStep::MarkPage(page) => {
                let mark = journal::mark(page) as usize;
                (&mut self.journal[mark..], Some(&[0; 4]))
            }
            InstallationStep::ErasePage(page) => {
                let from = page as usize * PAGE_BYTES;
                (&mut self.region[from..][..PAGE_BYTES], None)
            }
            InstallationStep::WriteBlock(number) => {
                let from = number as usize * BLOCK_BYTES;
                (&mut self.region[from..], Some(&installation.content().0))
            }
            InstallationStep::Suspend | InstallationStep::Verify | InstallationStep::Resume => {
                return;
            }
        };
        let length = content.map_or(bytes.len(), <[u8]>::len);
        let part = if power_fails { length / 2 } else { length };
        let bytes = &mut bytes[..part];
        match content {
            None => bytes.fill(0xff),
            Some(content) => {
                for (byte, content) in bytes.iter_mut().zip(content) {
                    assert_eq!(*byte & content, *content, "written without an erasure");
                    *byte = *content;
                }
            }
        }
    }
}
