//! Address space of the core: flash, RAM, and windows to the chip.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use rsemu::core::BusError;
use rsemu::core::space::{
    AddressSpace, Mapping, MemAttrs, MemOps, MemResult, Perms, RamStore, Region,
};

use crate::chip::Chip;
use crate::memory::{Memory, RAM};
use crate::refusal::What;
use crate::softdevice::{SoftDevice, boot};

/// Base address of peripherals, GPIO's ports included.
const PERIPHERALS: u32 = 0x4000_0000;
const PERIPHERALS_BYTES: u64 = 0x2000_0000;
/// Base address of the range of FICR and UICR.
const INFORMATION: u32 = 0x1000_0000;
const INFORMATION_BYTES: u64 = 0x2000;

/// Base address of flash.
const FLASH: u32 = 0;

/// Address of an instruction that returns, which is in no chip: functions that the emulation answers end there.
pub const RETURN: u32 = 0x6000_1000;

/// State that core and chip share without a lock.
#[derive(Debug, Default)]
pub struct Shared {
    /// Ticks since power came.
    pub now: AtomicU64,
    /// True if something has changed that the core has to know.
    pub attention: AtomicBool,
    /// Address of the stacked registers that a supervisor call wrote, or 0.
    pub call: AtomicU64,
    /// True if a hard fault has begun.
    pub hard_fault: AtomicBool,
}

/// Window through which the core reaches the chip at some addresses.
#[derive(Debug)]
struct Window {
    chip: Arc<Mutex<Chip>>,
    shared: Arc<Shared>,
    base: u32,
}

impl Window {
    /// The chip, at this moment.
    fn chip(&self) -> MutexGuard<'_, Chip> {
        let mut chip = lock(&self.chip);
        chip.advance(self.shared.now.load(Ordering::Relaxed));
        chip
    }
}

impl MemOps for Window {
    fn read(&self, offset: u64, into: &mut [u8], _: MemAttrs) -> MemResult {
        let mut chip = self.chip();
        let address = self.base.wrapping_add(offset as u32);
        let value = if self.base == RAM {
            chip.bus.refuse(address, What::SoftDevices);
            0
        } else {
            chip.read(address, into.len())
        };
        for (byte, value) in into.iter_mut().zip(value.to_le_bytes()) {
            *byte = value;
        }
        if chip.bus.attention {
            self.shared.attention.store(true, Ordering::Relaxed);
        }
        Ok(())
    }

    fn write(&self, offset: u64, bytes: &[u8], _: MemAttrs) -> MemResult {
        let address = self.base.wrapping_add(offset as u32);
        let mut value = 0;
        for (place, byte) in bytes.iter().take(4).enumerate() {
            value |= u32::from(*byte) << (8 * place);
        }
        match (self.base, address) {
            (boot::GATE, boot::CALL) => self.shared.call.store(value.into(), Ordering::Relaxed),
            (boot::GATE, _) => self.shared.hard_fault.store(true, Ordering::Relaxed),
            (FLASH, _) => {
                if !self.chip().write_flash(address, bytes.len(), value) {
                    return Err(BusError::Protected);
                }
            }
            (RAM, _) => self.chip().bus.refuse(address, What::SoftDevices),
            _ => self.chip().write(address, bytes.len(), value),
        }
        self.shared.attention.store(true, Ordering::Relaxed);
        Ok(())
    }
}

pub fn lock(chip: &Mutex<Chip>) -> MutexGuard<'_, Chip> {
    // Nobody panics while holding it but in a test that fails anyway.
    chip.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Creates the address space of the core: flash, RAM, and windows to the chip.
pub fn address_space(
    memory: &Memory,
    chip: &Arc<Mutex<Chip>>,
    shared: &Arc<Shared>,
    softdevice: Option<&SoftDevice>,
) -> AddressSpace {
    let space = AddressSpace::new("nRF52", 32);
    let window = |base| {
        Arc::new(Window {
            chip: Arc::clone(chip),
            shared: Arc::clone(shared),
            base,
        })
    };
    let ram = |store: &Arc<RamStore>, name| Region::ram(name, Arc::clone(store));
    let windows = [
        ("peripherals", PERIPHERALS, PERIPHERALS_BYTES),
        ("information", INFORMATION, INFORMATION_BYTES),
        ("gate", boot::GATE, boot::GATE_BYTES),
    ];
    let taken = softdevice.map(|softdevice| {
        let bytes = u64::from(softdevice.ram_end() - RAM);
        ("the SoftDevice's RAM", RAM, bytes)
    });
    let back = Arc::new(RamStore::new(4));
    // bx lr; b to itself.
    back.write_at(0, &[0x70, 0x47, 0xfe, 0xe7])
        .expect("it is that long");
    {
        let mut topology = space.topology();
        // Reads and instructions: who writes to flash without leave of its controller gets a bus fault.
        let flash = Mapping::new(ram(&memory.flash, "flash"), 0).with_perms(Perms::RX);
        let bytes = memory.flash.len();
        let writes = Mapping::new(Region::io("writes to flash", bytes, window(FLASH)), 0);
        let writes = writes.with_priority(1).with_perms(Perms::WRITE);
        let mappings = [
            flash,
            writes,
            Mapping::new(ram(&memory.ram, "RAM"), RAM.into()),
            Mapping::new(ram(&back, "return"), RETURN.into()),
        ]
        .into_iter()
        .chain(windows.into_iter().chain(taken).map(|(name, base, bytes)| {
            let region = Region::io(name, bytes, window(base));
            Mapping::new(region, base.into()).with_priority(1)
        }));
        for mapping in mappings {
            topology
                .map_with(mapping)
                .expect("they overlap by priority alone");
        }
    }
    space
}
