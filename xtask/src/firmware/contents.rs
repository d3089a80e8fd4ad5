//! Content that an image must have, and must not: a handler of each of its interrupts, and no function that a radio packet can
//! make panic.

use anyhow::{Context as _, Result, bail, ensure};
use object::{File, Object as _, ObjectSection as _, ObjectSymbol as _};

/// Vectors of the core itself, before the first interrupt.
const CORE_VECTORS: usize = 16;

/// The discovery of nrf-softdevice 0.1. It panics on every event but the one that it waits for, so a device
/// that sends a notification meanwhile restarts the board.
const PANICS_ON_A_NOTIFICATION: [&str; 3] = [
    "discover_service",
    "discover_characteristics",
    "discover_descriptors",
];

/// Fails where one of the interrupts, given by number, leads to no handler or the default one, or a function is in the image
/// that must not be.
///
/// A handler under a name that the vector table does not contain links without a warning and is never
/// called. So the table of the linked image is read.
pub fn check(elf: &[u8], interrupts: &[usize]) -> Result<()> {
    let file = File::parse(elf).context("not an ELF image")?;
    let table = file
        .section_by_name(".vector_table")
        .context("no section .vector_table")?
        .data()?;
    let default = file
        .symbols()
        .find(|symbol| symbol.name() == Ok("DefaultHandler_"))
        .context("no symbol DefaultHandler_")?
        .address();
    for &interrupt in interrupts {
        let vector = handler(table, interrupt);
        ensure!(
            vector.is_some_and(|vector| vector != 0 && vector != default),
            "interrupt {interrupt} has no handler: it is bound under a name that the vector table \
             does not contain"
        );
    }
    let names = file.symbols().filter_map(|symbol| symbol.name().ok());
    if let Some(name) = forbidden(names) {
        bail!(
            "the image contains {name}, which a radio packet can make panic: discover attributes with \
             shared::myo::Discovery"
        );
    }
    Ok(())
}

/// The address of an interrupt's handler, the Thumb bit set as a symbol has it.
fn handler(table: &[u8], interrupt: usize) -> Option<u64> {
    let (vectors, _) = table.as_chunks::<4>();
    let vector = vectors.get(CORE_VECTORS + interrupt)?;
    Some(u32::from_le_bytes(*vector).into())
}

fn forbidden<'n>(mut names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    let panics = |name: &&str| {
        PANICS_ON_A_NOTIFICATION
            .iter()
            .any(|one| name.contains(one))
    };
    names.find(panics)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interrupts_follow_the_cores_own_vectors() {
        let table: Vec<u8> = (0..20_u32).flat_map(u32::to_le_bytes).collect();
        assert_eq!(handler(&table, 0), Some(16));
        assert_eq!(handler(&table, 3), Some(19));
        assert_eq!(handler(&table, 4), None);
    }

    #[test]
    fn a_forbidden_function_is_found_in_mangled_names() {
        let closure = "_RNCNvNtNtCs1_14nrf_softdevice3ble11gatt_client16discover_service0B7_";
        let read = "_RNCNvNtNtCs1_14nrf_softdevice3ble11gatt_client4read0B7_";
        assert_eq!(
            forbidden(["main", read, closure].into_iter()),
            Some(closure)
        );
        assert_eq!(forbidden(["main", read].into_iter()), None);
    }
}
