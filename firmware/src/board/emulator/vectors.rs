//! The vector table of the board's interrupts.

use super::{clock, command_port, dead_man, hci, irq::Irq};

/// An entry of the table.
pub union Vector {
    handler: extern "C" fn(),
    unused: usize,
}

/// The table that `cortex-m-rt` places behind the core's own vectors.
#[expect(
    unsafe_code,
    reason = "the linker has to find it by name and to place it"
)]
// SAFETY: link.x of cortex-m-rt places this section behind the 16 vectors of the core and reads it
// as one word per interrupt, which is what the array holds: a function that keeps to the C calling
// convention, or 0. Only interrupts that have a handler are ever unmasked.
#[unsafe(link_section = ".vector_table.interrupts")]
// SAFETY: cortex-m-rt, with its feature `device`, expects exactly this symbol and declares it
// nowhere else; no other crate of the image defines it.
#[unsafe(no_mangle)]
pub static __INTERRUPTS: [Vector; 32] = {
    let mut vectors = [const { Vector { unused: 0 } }; 32];
    vectors[Irq::CommandReceive as usize] = Vector {
        handler: command_receive,
    };
    vectors[Irq::HciReceive as usize] = Vector {
        handler: hci_receive,
    };
    vectors[Irq::Alarm as usize] = Vector { handler: alarm };
    vectors[Irq::DeadMan as usize] = Vector {
        handler: dead_man_expired,
    };
    vectors
};

extern "C" fn command_receive() {
    command_port::on_receive();
}

extern "C" fn hci_receive() {
    hci::on_receive();
}

extern "C" fn alarm() {
    clock::on_alarm();
}

extern "C" fn dead_man_expired() {
    dead_man::on_expired();
}
