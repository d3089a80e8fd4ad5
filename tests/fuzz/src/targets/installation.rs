//! Receiver of a model: any commands in any order, failing flash, losses of power.

use std::sync::LazyLock;

use shared::installation::{
    BLOCK_BYTES, Block, Installation, InstallationProgress, InstallationStep, PAGE_BYTES, Refused,
    SimulatedFlash, Transfer, journal,
};

use crate::input::Input;

/// Bytes of the model: two pages and some blocks.
const LENGTH: usize = 2 * PAGE_BYTES + 3 * BLOCK_BYTES + 5;
const CAPACITY: usize = 4 * PAGE_BYTES;

/// Byte of which the board's first model consists.
const OLD: u8 = 0x55;

/// Model that is installed; the same each time.
static FILE: LazyLock<Vec<u8>> =
    LazyLock::new(|| (0..LENGTH).map(|place| (place % 251) as u8).collect());

/// Returns true if a whole model lies here: the new one, or the old one unchanged.
fn has_model(flash: &SimulatedFlash) -> bool {
    flash.region.starts_with(&FILE) || flash.region.iter().all(|byte| *byte == OLD)
}

/// Takes events: a byte for the kind, then its arguments.
pub fn run(data: &[u8]) {
    let mut input = Input(data);
    let file = FILE.as_slice();
    let whole = Transfer {
        length: LENGTH as u32,
        checksum: 7,
    };
    let mut flash = SimulatedFlash::new(vec![OLD; CAPACITY]);
    let mut installation = Installation::new(CAPACITY as u32);
    let mut in_use = true;
    while !input.is_empty() {
        let kind = input.byte();
        if kind < 0x10 {
            // Power fails.
            installation = Installation::new(CAPACITY as u32);
            in_use = has_model(&flash);
            continue;
        }
        if kind < 0x30 {
            let transfer = Transfer {
                length: if kind & 1 == 0 {
                    whole.length
                } else {
                    input.word()
                },
                checksum: 7,
            };
            let journal = journal::read(&flash.journal).filter(|_| !in_use);
            match installation.begin(transfer, journal) {
                Ok(InstallationProgress::Next(block)) => assert!(block < transfer.blocks()),
                Ok(InstallationProgress::Installed) => panic!("nothing was sent"),
                Err(refused) => assert_eq!(refused, Refused::Length),
            }
            continue;
        }
        // Most blocks are those that are asked for.
        let number = match installation.progress() {
            InstallationProgress::Next(number) if kind & 7 != 0 => number,
            _ => u32::from(input.byte()),
        };
        let fails_at = if kind & 0x78 == 0x78 {
            input.below(8)
        } else {
            usize::MAX
        };
        let block = Block::of(file, number);
        if installation.take(number, &block, |_| true).is_err() {
            continue;
        }
        let mut steps = 0;
        while let Some(step) = installation.step() {
            let success = steps != fails_at;
            steps += 1;
            assert!(steps < 10, "a block without end");
            match step {
                _ if !success => {}
                InstallationStep::Suspend => in_use = false,
                InstallationStep::Resume => {
                    // After a failure at the first block, the remains of an earlier transfer may be no model.
                    in_use = has_model(&flash);
                    assert!(in_use || number == 0, "in use, and not whole");
                }
                InstallationStep::Verify => {}
                _ => assert!(!in_use, "{step:?} while a model is in use"),
            }
            let outcome = match step {
                InstallationStep::Verify if !flash.region.starts_with(file) => Err(Refused::Model),
                InstallationStep::Resume if !has_model(&flash) => Err(Refused::Model),
                InstallationStep::Suspend | InstallationStep::Resume if !success => {
                    Err(Refused::Busy)
                }
                _ if !success => Err(Refused::Flash),
                _ => Ok(()),
            };
            if outcome.is_ok() {
                flash.carry_out(&installation, step, false);
            }
            if installation.done(outcome).is_err() {
                assert_eq!(installation.step(), None);
            }
        }
    }
}
