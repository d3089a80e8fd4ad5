//! The emulator of a Cortex-M4F that tests and instruction counts run in.

use std::process::Command;

use anyhow::{Result, bail};

use crate::emulator::HINT;

/// Its program, and the package that has it.
pub const QEMU: &str = "qemu-system-arm";

/// What it says that it is.
///
/// # Errors
/// Where there is none: with the command that would help.
pub fn find() -> Result<String> {
    match Command::new(QEMU).arg("--version").output() {
        Ok(output) if output.status.success() => {
            let text = String::from_utf8_lossy(&output.stdout);
            Ok(text.lines().next().unwrap_or(QEMU).to_owned())
        }
        _ => bail!("no {QEMU}: {HINT}"),
    }
}
