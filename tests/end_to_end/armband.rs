//! Unit tests of the virtual armband, which all other tests here rely on.

use std::process::Command;

use myointent_tests::emulator::python;

#[test]
fn the_virtual_armband_passes_its_own_tests() -> anyhow::Result<()> {
    let test = "the_virtual_armband_passes_its_own_tests";
    let Some(python) = python(test) else {
        return Ok(());
    };
    let tests = Command::new(&python.path)
        .args(["-m", "unittest", "discover", "-s"])
        .arg(xtask::emulator::armband())
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()?;
    let output = String::from_utf8_lossy(&tests.stderr);
    assert!(tests.status.success(), "{output}");
    // Without any test found, unittest succeeds as well.
    assert!(!output.contains("Ran 0 tests"), "{output}");
    Ok(())
}
