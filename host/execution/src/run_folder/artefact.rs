//! A binary file of a run: one or more parts behind a header that says what they were made from.
//!
//! The file has two lines of text, then the parts, one after the other:
//!
//! ```text
//! myointent artefact 1
//! {"made_from":"…","checksum":"…","about":…,"parts":[["weights",193848]]}
//! ```

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::{RunError, RunFolder, write_whole};
use crate::fingerprint::Fingerprint;

const MAGIC: &[u8] = b"myointent artefact 1\n";

/// Description of a model in its artefact.
#[derive(Serialize, Deserialize)]
pub struct ModelInfo {
    /// Fingerprint of the model's weights.
    pub weights: Fingerprint,
}

#[derive(Debug, Serialize, Deserialize)]
struct ArtefactHeader {
    made_from: Fingerprint,
    /// Checksum of all parts.
    checksum: Fingerprint,
    about: serde_json::Value,
    /// Name and length in bytes of each part.
    parts: Vec<(String, usize)>,
}

/// A binary file of a run, with its content.
#[derive(Debug)]
pub struct Artefact {
    path: PathBuf,
    /// Fingerprint of what it was made from.
    pub made_from: Fingerprint,
    /// Description of the content, as JSON.
    about: serde_json::Value,
    parts: Vec<(String, Vec<u8>)>,
}

impl Artefact {
    /// An artefact without parts.
    pub fn new(
        path: PathBuf,
        made_from: Fingerprint,
        about: &impl Serialize,
    ) -> Result<Self, RunError> {
        let about = serde_json::to_value(about);
        Ok(Self {
            about: about.map_err(|error| RunError::content(&path, error))?,
            path,
            made_from,
            parts: Vec::new(),
        })
    }

    /// Adds a part.
    pub fn with(mut self, name: &str, bytes: Vec<u8>) -> Self {
        self.parts.push((name.to_owned(), bytes));
        self
    }

    /// Description of the content.
    pub fn about<T: DeserializeOwned>(&self) -> Result<T, RunError> {
        T::deserialize(&self.about).map_err(|error| RunError::content(&self.path, error))
    }

    /// Takes a part out.
    pub fn take(&mut self, name: &str) -> Result<Vec<u8>, RunError> {
        match self.parts.iter().position(|(known, _)| known == name) {
            Some(at) => Ok(self.parts.swap_remove(at).1),
            None => {
                let reason = format!("it has no part {name}");
                Err(RunError::content(&self.path, reason))
            }
        }
    }

    /// Writes the file.
    pub fn save(&self) -> Result<(), RunError> {
        let bytes = self.encode();
        let bytes = bytes.map_err(|error| RunError::content(&self.path, error))?;
        write_whole(&self.path, &bytes)
    }

    /// Bytes of the file: magic, a line of JSON, the parts.
    fn encode(&self) -> Result<Vec<u8>, serde_json::Error> {
        let content: Vec<u8> = self
            .parts
            .iter()
            .flat_map(|(_, part)| part)
            .copied()
            .collect();
        let parts = self.parts.iter();
        let header = ArtefactHeader {
            made_from: self.made_from,
            checksum: Fingerprint::of_bytes(&content),
            about: self.about.clone(),
            parts: parts
                .map(|(name, part)| (name.clone(), part.len()))
                .collect(),
        };
        let mut bytes = MAGIC.to_vec();
        bytes.extend(serde_json::to_vec(&header)?);
        bytes.push(b'\n');
        bytes.extend(content);
        Ok(bytes)
    }

    fn decode(path: &Path, bytes: &[u8]) -> Result<Self, String> {
        let text = bytes.strip_prefix(MAGIC).ok_or("it has another format")?;
        let end = text.iter().position(|&byte| byte == b'\n');
        let (header, content) = text.split_at(end.ok_or("its header is cut off")?);
        let header: ArtefactHeader =
            serde_json::from_slice(header).map_err(|error| error.to_string())?;
        let mut rest = &content[1..];
        if Fingerprint::of_bytes(rest) != header.checksum {
            return Err("its checksum is wrong".to_owned());
        }
        let mut parts = Vec::new();
        for (name, length) in header.parts {
            let (part, behind) = rest.split_at_checked(length).ok_or("it is cut off")?;
            parts.push((name, part.to_vec()));
            rest = behind;
        }
        Ok(Self {
            path: path.to_owned(),
            made_from: header.made_from,
            about: header.about,
            parts,
        })
    }
}

impl RunFolder {
    /// Reads a binary file, whatever it was made from.
    pub fn load_artefact(&self, path: &Path) -> Result<Artefact, RunError> {
        let bytes = fs::read(path).map_err(|source| match source.kind() {
            ErrorKind::NotFound => RunError::NotTrained { path: path.into() },
            _ => RunError::io(path, source),
        })?;
        Artefact::decode(path, &bytes).map_err(|reason| RunError::content(path, reason))
    }

    /// Reads a binary file that was made from `made_from`.
    ///
    /// # Errors
    /// [`RunError::NotOfThisRun`] if it was made from something else; when it is missing or damaged.
    pub fn artefact_of(&self, path: &Path, made_from: Fingerprint) -> Result<Artefact, RunError> {
        let artefact = self.load_artefact(path)?;
        if artefact.made_from == made_from {
            Ok(artefact)
        } else {
            let path = path.to_owned();
            Err(RunError::NotOfThisRun { path })
        }
    }

    /// Fingerprint of a model's weights that were made from `made_from`.
    pub fn weights_fingerprint(
        &self,
        name: &str,
        made_from: Fingerprint,
    ) -> Result<Fingerprint, RunError> {
        let artefact = self.artefact_of(&self.weights_path(name), made_from)?;
        Ok(artefact.about::<ModelInfo>()?.weights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_damage_is_refused() {
        let made_from = Fingerprint::of_bytes(b"a");
        let decode = |bytes: &[u8]| Artefact::decode(Path::new("a"), bytes);
        let artefact = Artefact::new("a".into(), made_from, &vec![0.1, 2.0]).unwrap();
        let bytes = artefact
            .with("one", vec![1, 10, 3])
            .with("two", Vec::new())
            .encode()
            .unwrap();
        let mut read = decode(&bytes).unwrap();
        assert_eq!(read.made_from, made_from);
        assert_eq!(read.about::<Vec<f64>>().unwrap(), [0.1, 2.0]);
        assert_eq!(read.take("one").unwrap(), [1, 10, 3]);
        assert!(read.take("two").unwrap().is_empty());
        assert!(read.take("one").is_err());
        for length in 0..bytes.len() {
            assert!(decode(&bytes[..length]).is_err(), "{length} bytes");
        }
        let mut damaged = bytes;
        *damaged.last_mut().unwrap() ^= 1;
        assert!(decode(&damaged).is_err());
    }
}
