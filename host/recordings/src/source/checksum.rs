//! Checksums of downloads.

use std::fmt;
use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use md5::Md5;
use sha2::{Digest, Sha256};

/// A checksum of a file, in lower-case hexadecimal digits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Checksum {
    /// MD5, which Zenodo publishes: it shows damage, not malice.
    Md5(String),
    /// SHA-256, which is printed for every download.
    Sha256(String),
}

impl fmt::Display for Checksum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Md5(digits) => write!(f, "md5:{digits}"),
            Self::Sha256(digits) => write!(f, "sha256:{digits}"),
        }
    }
}

impl Checksum {
    /// The checksum that a text states, such as `md5:0cc1…`; none of another kind.
    pub fn parse(text: &str) -> Option<Self> {
        let (kind, digits) = text.split_once(':')?;
        let digits = digits.to_ascii_lowercase();
        let is_hex = digits.chars().all(|digit| digit.is_ascii_hexdigit());
        match (kind, digits.len()) {
            ("md5", 32) if is_hex => Some(Self::Md5(digits)),
            ("sha256", 64) if is_hex => Some(Self::Sha256(digits)),
            _ => None,
        }
    }

    /// The checksum of a file, of the same kind as this one.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub(super) fn same_of(&self, path: &Path) -> io::Result<Self> {
        match self {
            Self::Md5(_) => Ok(Self::Md5(digits::<Md5>(path)?)),
            Self::Sha256(_) => Self::sha256(path),
        }
    }

    /// SHA-256 of a file.
    ///
    /// # Errors
    /// When the file cannot be read.
    pub(super) fn sha256(path: &Path) -> io::Result<Self> {
        Ok(Self::Sha256(digits::<Sha256>(path)?))
    }
}

fn digits<D: Digest>(path: &Path) -> io::Result<String> {
    let mut file = File::open(path)?;
    let mut digest = D::new();
    let mut piece = vec![0; 1 << 16];
    loop {
        match file.read(&mut piece)? {
            0 => break,
            read => digest.update(&piece[..read]),
        }
    }
    let bytes = digest.finalize();
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksums_are_those_of_their_standards() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("abc");
        std::fs::write(&path, "abc").unwrap();
        // RFC 1321, A.5; FIPS 180-2, B.1.
        let md5 = Checksum::parse("md5:900150983CD24FB0D6963F7D28E17F72").unwrap();
        let sha = "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(md5.same_of(&path).unwrap(), md5);
        assert_eq!(Checksum::sha256(&path).unwrap().to_string(), sha);
        for other in ["md5:1", "crc:900150983cd24fb0d6963f7d28e17f72", "", "md5"] {
            assert_eq!(Checksum::parse(other), None, "{other}");
        }
    }
}
