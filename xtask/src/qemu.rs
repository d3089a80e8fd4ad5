//! QEMU, which emulates the Cortex-M4F of tests and instruction counts.

use std::process::Command;

use anyhow::{Result, bail};

/// The command that installs what is missing.
pub const HINT: &str = "cargo xtask emulator --install";

/// Its program, and the Debian package of it.
pub const QEMU: &str = "qemu-system-arm";

/// Its version line.
pub fn find() -> Result<String> {
    match Command::new(QEMU).arg("--version").output() {
        Ok(output) if output.status.success() => {
            let text = String::from_utf8_lossy(&output.stdout);
            Ok(text.lines().next().unwrap_or(QEMU).to_owned())
        }
        _ => bail!("no {QEMU}: {HINT}"),
    }
}
