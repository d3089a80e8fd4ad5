//! Interrupts in IT blocks: the fault of the emulated core, and that it is avoided.

use std::sync::Arc;

use nrf52::Core;
use rsemu::core::space::{AddressSpace, RamStore, Region};

/// Counts in register 1 how often the instructions of an IT block ran whose condition never holds.
const PROGRAM: [u16; 12] = [
    0x4b07, // ldr r3, 0xe000e100
    0x2401, // movs r4, #1
    0x601c, // str r4, [r3]: interrupt 0 is enabled
    0x2000, // movs r0, #0
    0x2100, // movs r1, #0
    0x2801, // cmp r0, #1
    0xbf01, // itttt eq
    0x3101, // addeq r1, #1
    0x3101, // addeq r1, #1
    0x3101, // addeq r1, #1
    0x3101, // addeq r1, #1
    0xe7f8, // b to the comparison
];
const START: u64 = 0x100;
const INTERRUPT_SET_ENABLE: u32 = 0xe000_e100;
/// A handler that only returns.
const HANDLER: u64 = 0x180;
const RETURN: u16 = 0x4770;

fn core() -> Core {
    let flash = Arc::new(RamStore::new(0x1000));
    let ram = Arc::new(RamStore::new(0x1000));
    let word = |at: u64, value: u32| flash.write_at(at, &value.to_le_bytes()).expect("in flash");
    let half = |at: u64, value: u16| flash.write_at(at, &value.to_le_bytes()).expect("in flash");
    word(0, 0x2000_1000);
    word(4, START as u32 | 1);
    word(4 * 16, HANDLER as u32 | 1);
    for (at, instruction) in (START..).step_by(2).zip(PROGRAM) {
        half(at, instruction);
    }
    word(0x120, INTERRUPT_SET_ENABLE);
    half(HANDLER, RETURN);
    let space = AddressSpace::new("test", 32);
    {
        let mut topology = space.topology();
        let flash = Region::ram("flash", Arc::clone(&flash));
        topology.map(flash, 0).expect("free");
        let ram = Region::ram("RAM", Arc::clone(&ram));
        topology.map(ram, 0x2000_0000).expect("free");
    }
    Core::new(Arc::new(space))
}

/// Returns the values of register 1 after an interrupt at each of the first instructions in turn.
fn counted(new: impl Fn() -> Core) -> Vec<u32> {
    let one = |before: u32| {
        let mut core = new();
        for _ in 0..before {
            core.step();
        }
        core.set_interrupts(1);
        // Until it is taken, at the latest after the block.
        for _ in 0..6 {
            core.step();
        }
        core.set_interrupts(0);
        for _ in 0..40 {
            core.step();
        }
        core.register(1)
    };
    (6..40).map(one).collect()
}

#[test]
fn an_interrupt_anywhere_leaves_the_conditions_of_an_it_block_in_force() {
    assert_eq!(counted(core), vec![0; 34]);
}

#[test]
fn the_library_alone_loses_the_state_of_an_it_block() {
    let lost = counted(|| core().as_released())
        .into_iter()
        .any(|count| count > 0);
    assert!(
        lost,
        "rsemu has been mended: Core::step no longer has to hold interrupts back"
    );
}
