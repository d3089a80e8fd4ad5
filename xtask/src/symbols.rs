//! Functions that must not be in an image: found by their names among its symbols.

use anyhow::{Context as _, Result, ensure};
use object::{Object as _, ObjectSymbol as _};

/// The discovery of nrf-softdevice 0.1. It panics on every event but the one that it waits for, so a device
/// that sends a notification meanwhile restarts the board.
const PANICS_ON_A_NOTIFICATION: [&str; 3] = [
    "discover_service",
    "discover_characteristics",
    "discover_descriptors",
];

/// Fails where an image contains a function that a radio packet can make panic.
pub fn check(elf: &[u8]) -> Result<()> {
    let file = object::File::parse(elf).context("not an ELF image")?;
    let names: Vec<&str> = file
        .symbols()
        .filter_map(|symbol| symbol.name().ok())
        .collect();
    ensure!(
        names.iter().any(|name| name.contains("main")),
        "no symbols: the image cannot be checked"
    );
    match forbidden(&names) {
        Some(name) => anyhow::bail!(
            "the image contains {name}, which a radio packet can make panic: discover attributes with \
             shared::myo::Discovery"
        ),
        None => Ok(()),
    }
}

fn forbidden<'n>(names: &[&'n str]) -> Option<&'n str> {
    let panics = |name: &&&str| {
        PANICS_ON_A_NOTIFICATION
            .iter()
            .any(|one| name.contains(one))
    };
    names.iter().find(panics).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_forbidden_function_is_found_in_mangled_names() {
        let closure = "_RNCNvNtNtCs1_14nrf_softdevice3ble11gatt_client16discover_service0B7_";
        let read = "_RNCNvNtNtCs1_14nrf_softdevice3ble11gatt_client4read0B7_";
        assert_eq!(forbidden(&["main", read, closure]), Some(closure));
        assert_eq!(forbidden(&["main", read]), None);
    }
}
