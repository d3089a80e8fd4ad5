//! Where power fails in an installation, and what the region holds then.

use myointent_tests::simulation::FlashOperation;

/// Operations before the pages after the first: the journal erased and written, the first page erased.
const PAGES: usize = 3;

/// How much of the operation at which power fails is done, in percent.
const DONE: [usize; 3] = [0, 50, 100];

/// Where the model's region begins, as in `memory.x`.
const MODEL_ADDRESS: u32 = 0x5_8000;

/// What the region holds after a cut.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Content {
    Old,
    Neither,
    New,
}

/// Power fails at an operation of flash.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    /// Which, of an installation without a cut.
    pub(super) operation: usize,
    /// How much of it is done, in percent.
    pub(super) done: usize,
}

impl Cut {
    /// What the region holds then.
    pub(super) fn content(self, flash: &[FlashOperation]) -> Content {
        let first = |one: &FlashOperation| one.address == MODEL_ADDRESS;
        // From the first page's first erasure to its first block.
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

    /// The operation that comes first after it: the first one of its page, unless that was marked.
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

/// At each page of an installation power fails at the operation with this number; before the pages at one of the first three.
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
