//! One process at a time writes into a run folder.
//!
//! The lock is the operating system's, on a file: it ends with the process, however that ends. The file stays, and
//! says who held the lock last.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read as _, Seek as _, Write as _};
use std::path::Path;
use std::time::SystemTime;

use super::RunError;
use crate::utc::utc;

const LOCK: &str = "run.lock";
/// Maximum size of an entry in bytes, read or written.
const LONGEST: usize = 400;

/// Lock of a run folder, held as long as it lives.
#[derive(Debug)]
pub(super) struct Lock(File);

impl Lock {
    pub(super) fn of(folder: &Path) -> Result<Self, RunError> {
        let path = folder.join(LOCK);
        let io = |source| RunError::io(&path, source);
        let mut file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(&path)
            .map_err(io)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let mut entry = Vec::new();
                // The lock holds even if its text cannot be read.
                let _ = file.take(LONGEST as u64).read_to_end(&mut entry);
                let holder = String::from_utf8_lossy(&entry).trim().to_owned();
                return Err(RunError::Locked {
                    path: folder.to_owned(),
                    holder,
                });
            }
            // Some network file systems have no locks; a run there is as safe as its user is careful.
            Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {}
            Err(TryLockError::Error(error)) => return Err(io(error)),
        }
        describe(&mut file).map_err(io)?;
        Ok(Self(file))
    }
}

impl Drop for Lock {
    /// Releases the lock. Closing the file is not enough: a process that is being started in another thread has a copy
    /// of it for a moment.
    fn drop(&mut self) {
        let _ = self.0.unlock();
    }
}

/// Writes who holds the lock.
fn describe(file: &mut File) -> io::Result<()> {
    let command: Vec<String> = std::env::args().collect();
    let mut entry = format!(
        "process {} on {}, since {}: {}",
        std::process::id(),
        host(),
        utc(SystemTime::now()),
        command.join(" ")
    );
    while entry.len() >= LONGEST {
        entry.pop();
    }
    entry.push('\n');
    file.set_len(0)?;
    file.rewind()?;
    file.write_all(entry.as_bytes())
}

/// The machine's name, which matters where several share a file system.
fn host() -> String {
    let known = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    known
        .or_else(|| std::env::var("COMPUTERNAME").ok())
        .or_else(|| std::env::var("HOSTNAME").ok())
        .map(|name| name.trim().to_owned())
        .filter(|name| !name.is_empty())
        .unwrap_or_else(|| "this machine".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_second_holder_is_told_of_the_first_until_it_is_gone() {
        let folder = tempfile::tempdir().unwrap();
        let first = Lock::of(folder.path()).unwrap();
        let refused = Lock::of(folder.path()).unwrap_err().to_string();
        let pid = format!("process {} on ", std::process::id());
        assert!(refused.contains(&pid), "{refused}");
        assert!(refused.contains(", since 20"), "{refused}");
        drop(first);
        Lock::of(folder.path()).unwrap();
    }
}
