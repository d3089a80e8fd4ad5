//! Reader of a file that grows, line by line.

use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};

/// Reader of a file's complete lines, each once: for files that are too long to be read repeatedly.
#[derive(Debug)]
pub struct Tail {
    path: PathBuf,
    read: u64,
    /// Beginning of a line that is not complete.
    begun: Vec<u8>,
}

impl Tail {
    /// Creates a reader of a file, which may be created later.
    #[must_use]
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            read: 0,
            begun: Vec::new(),
        }
    }

    /// Returns the lines that were completed since the last call, without their ends.
    ///
    /// # Errors
    /// Fails when the file exists and cannot be read.
    pub fn lines(&mut self) -> std::io::Result<Vec<String>> {
        if !self.path.exists() {
            return Ok(Vec::new());
        }
        let mut file = File::open(&self.path)?;
        file.seek(SeekFrom::Start(self.read))?;
        self.read += file.read_to_end(&mut self.begun)? as u64;
        let Some(end) = self.begun.iter().rposition(|&byte| byte == b'\n') else {
            return Ok(Vec::new());
        };
        let rest = self.begun.split_off(end + 1);
        let complete = std::mem::replace(&mut self.begun, rest);
        let text = String::from_utf8_lossy(&complete);
        Ok(text.lines().map(str::to_owned).collect())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use super::*;

    #[test]
    fn every_complete_line_is_given_once() -> std::io::Result<()> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("lines");
        let mut tail = Tail::new(&path);
        assert_eq!(tail.lines()?, [""; 0]);
        let mut file = File::create(&path)?;
        file.write_all(b"one\r\ntwo\nthr")?;
        assert_eq!(tail.lines()?, ["one", "two"]);
        assert_eq!(tail.lines()?, [""; 0]);
        file.write_all(b"ee\n")?;
        assert_eq!(tail.lines()?, ["three"]);
        Ok(())
    }
}
