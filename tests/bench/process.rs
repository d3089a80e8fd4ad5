//! A process that ends with its test.

use std::fs::File;
use std::path::Path;
use std::process::{Child, ChildStdin, Command, ExitStatus};

use anyhow::Context as _;

/// A process that is killed when this is dropped.
pub struct KillOnDrop {
    name: &'static str,
    child: Child,
}

impl KillOnDrop {
    /// Starts it; its output goes to `NAME.out` in the folder.
    pub fn start(name: &'static str, mut command: Command, folder: &Path) -> anyhow::Result<Self> {
        let out = File::create(folder.join(format!("{name}.out")))?;
        let child = command
            .stderr(out.try_clone()?)
            .stdout(out)
            .spawn()
            .with_context(|| format!("{name} cannot be started"))?;
        Ok(Self { name, child })
    }

    pub fn input(&mut self) -> anyhow::Result<&mut ChildStdin> {
        let input = self.child.stdin.as_mut();
        input.with_context(|| format!("{} takes no input", self.name))
    }

    /// Its name and exit status, if it has ended.
    pub fn ended(&mut self) -> Option<(&'static str, ExitStatus)> {
        let status = self.child.try_wait().ok().flatten()?;
        Some((self.name, status))
    }
}

impl Drop for KillOnDrop {
    fn drop(&mut self) {
        // Fails if it has ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
