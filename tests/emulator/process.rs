//! A process that does not outlive its test.

use std::fs::File;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};

use anyhow::Context as _;

/// Killed when dropped.
pub struct Guarded {
    name: &'static str,
    child: Child,
}

impl Guarded {
    /// Starts it, its output in `NAME.out` of the folder.
    pub fn start(name: &'static str, mut command: Command, folder: &Path) -> anyhow::Result<Self> {
        let out = File::create(folder.join(format!("{name}.out")))?;
        let child = command
            .stdin(Stdio::null())
            .stderr(out.try_clone()?)
            .stdout(out)
            .spawn()
            .with_context(|| format!("{name} cannot be started"))?;
        Ok(Self { name, child })
    }

    /// How it ended, if it did.
    pub fn ended(&mut self) -> Option<(&'static str, ExitStatus)> {
        let status = self.child.try_wait().ok().flatten()?;
        Some((self.name, status))
    }
}

impl Drop for Guarded {
    fn drop(&mut self) {
        // It may have ended by itself; then there is nothing to kill.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
