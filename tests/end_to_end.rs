//! Virtual armband -> controller -> HCI -> the firmware on the PC -> label UART.
//!
//! Tests of what the emulated chip cannot show: the firmware's Bluetooth host beside a controller and an armband that are not
//! this project's. All else runs on the emulated chip (docs/emulated-chip.md).
//! Needs the armband's Python: `cargo xtask emulator --install`.

#[path = "end_to_end/bluetooth.rs"]
mod bluetooth;

use std::process::Command;

use myointent::cli::replay;
use myointent_tests::bench::python;
use myointent_tests::found;
use myointent_tests::oracle::{Input, expected_lines};

#[test]
fn the_virtual_armband_passes_its_own_tests() -> anyhow::Result<()> {
    let python = found!(python());
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

#[test]
fn the_oracle_of_misbehaviour_agrees_with_replay_where_nothing_happens() -> anyhow::Result<()> {
    let samples: Vec<_> = (0..2000_i32)
        .map(|n| [(n * n % 251 - 125) as i8; 8])
        .collect();
    let model = myointent_tests::chip::model();
    let lines = expected_lines(&model, &[Input::Samples(&samples)])?;
    assert_eq!(lines.concat(), replay::lines(&model, &samples)?);
    Ok(())
}
