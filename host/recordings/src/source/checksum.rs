//! Checksums of downloads, as texts such as `md5:0cc1…`.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::Path;

use md5::Md5;
use sha2::{Digest, Sha256};

/// MD5 of a file, which Zenodo publishes: it shows damage, not malice.
pub(super) fn md5(path: &Path) -> io::Result<String> {
    Ok(format!("md5:{}", digits::<Md5>(path)?))
}

/// SHA-256 of a file, which is printed for every download.
pub(super) fn sha256(path: &Path) -> io::Result<String> {
    Ok(format!("sha256:{}", digits::<Sha256>(path)?))
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
        assert_eq!(md5(&path).unwrap(), "md5:900150983cd24fb0d6963f7d28e17f72");
        let sha = "sha256:ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sha256(&path).unwrap(), sha);
    }
}
