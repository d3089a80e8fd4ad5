//! Places where power fails in an installation, and the content of the region after it.

use myointent_tests::simulation::FlashOperation;

/// Operations before the pages after the first: the journal erased and written, the first page erased.
const PAGES: usize = 3;

/// Done part of the operation at which power fails, in percent.
const DONE: [usize; 3] = [0, 50, 100];

/// Address of the model's region, as in `memory.x`.
const MODEL_ADDRESS: u32 = 0x5_8000;

/// Content of the region after a cut.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Content {
    Old,
    Neither,
    New,
}

/// Loss of power at an operation of flash.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    /// Index of the operation in an installation without a cut.
    pub(super) operation: usize,
    /// Done part of the operation, in percent.
    pub(super) done: usize,
}

impl Cut {
    /// Returns the content of the region after the cut.
    pub(super) fn content(self, flash: &[FlashOperation]) -> Content {
        let first = |one: &FlashOperation| one.address == MODEL_ADDRESS;
        // The region holds neither model from the first page's first erasure to its first block.
        let begins = flash.iter().position(first).unwrap();
        let ends = flash.iter().rposition(first).unwrap();
        let Self { operation, done } = self;
        if operation < begins || (operation == begins && done == 0) {
            Content::Old
        } else if operation > ends || (operation == ends && done == 100) {
            Content::New
        } else {
            Content::Neither
        }
    }

    /// Returns the operation at which the installation goes on: the first one of the cut page, unless that page was
    /// marked.
    pub(super) fn goes_on_at(self, flash: &[FlashOperation]) -> usize {
        let is_marked = self.done == 100 && flash[self.operation].address < MODEL_ADDRESS;
        match self.content(flash) {
            Content::Old => 0,
            Content::New => flash.len(),
            Content::Neither if self.operation < PAGES => PAGES,
            Content::Neither if is_marked => self.operation + 1,
            Content::Neither => {
                let erased = |operation: &usize| flash[*operation].is_erasure;
                (0..=self.operation).rfind(erased).unwrap()
            }
        }
    }
}

/// Plans a cut at the operation with this number of each page; before the pages, at one of the first three operations.
pub(super) fn plan(flash: &[FlashOperation], number: usize, seed: u64) -> Vec<Cut> {
    let erased = (PAGES..flash.len())
        .filter(|place| flash[*place].is_erasure && flash[*place].address >= MODEL_ADDRESS);
    let bounds: Vec<_> = erased.chain([flash.len()]).collect();
    let pages = bounds
        .windows(2)
        .filter(|page| page[0] + number < page[1])
        .map(|page| page[0] + number);
    let cuts = (number < PAGES).then_some(number).into_iter().chain(pages);
    let done = |operation| DONE[(operation as u64).wrapping_add(seed) as usize % DONE.len()];
    cuts.map(|operation| Cut {
        operation,
        done: done(operation),
    })
    .collect()
}
