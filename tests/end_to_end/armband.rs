//! The virtual armband by itself: a fake that is not what it claims to be proves nothing.

use std::process::Command;

use myointent_tests::emulator::python;

#[test]
fn the_virtual_armband_keeps_its_own_promises() -> anyhow::Result<()> {
    let test = "the_virtual_armband_keeps_its_own_promises";
    let Some(python) = python(test) else {
        return Ok(());
    };
    let tests = Command::new(&python.path)
        .args(["-m", "unittest", "discover", "-s"])
        .arg(xtask::emulator::armband())
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()?;
    let told = String::from_utf8_lossy(&tests.stderr);
    assert!(tests.status.success(), "{told}");
    // None found is a success too.
    assert!(!told.contains("Ran 0 tests"), "{told}");
    Ok(())
}
