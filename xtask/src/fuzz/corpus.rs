//! Inputs to start from: seeds, what runs on this machine have learned, and what was kept of it in the repository.
//!
//! The kept ones of a target are one file, for they are hundreds: of each its length, 32 bits, low byte first, and its
//! bytes.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context as _, Result, ensure};

use super::program::{Target, folder, sources};

/// Folder of a target's seeds and findings.
pub(super) fn seeds(target: &str) -> PathBuf {
    sources().join("corpus").join(target)
}

/// Creates the folder to which runs add inputs that reach something new.
pub(super) fn learned(target: &str) -> Result<PathBuf> {
    let learned = folder().join("corpus").join(target);
    fs::create_dir_all(&learned)?;
    Ok(learned)
}

/// Folder with the repository's inputs for a target.
pub(super) fn kept(target: &str) -> Result<PathBuf> {
    let inputs = folder().join("kept").join(target);
    if inputs.exists() {
        fs::remove_dir_all(&inputs)?;
    }
    fs::create_dir_all(&inputs)?;
    let file = file(target);
    if file.exists() {
        let bytes = fs::read(&file)?;
        let found = unpack(&bytes).with_context(|| format!("{} is damaged", file.display()))?;
        for (number, input) in found.iter().enumerate() {
            fs::write(inputs.join(format!("{number:04}")), input)?;
        }
    }
    Ok(inputs)
}

/// Writes an input for each branch that anything reached so far; their number, and bytes of the file.
pub(super) fn keep(program: &Path, target: &Target) -> Result<(usize, usize)> {
    let Target { name, longest } = target;
    let merged = folder().join("merged").join(name);
    if merged.exists() {
        fs::remove_dir_all(&merged)?;
    }
    fs::create_dir_all(&merged)?;
    let output = Command::new(program)
        .args(["-merge=1", "-use_counters=0"])
        .arg(format!("-max_len={longest}"))
        .arg(&merged)
        .args([learned(name)?, seeds(name), kept(name)?])
        .env("MYOINTENT_FUZZ_TARGET", name)
        .env("TMPDIR", folder())
        .output()?;
    let log = String::from_utf8_lossy(&output.stderr);
    ensure!(output.status.success(), "{name} cannot be merged: {log}");
    // By name, which is a digest of the content: the same inputs make the same file.
    let mut paths = fs::read_dir(&merged)?
        .map(|entry| Ok(entry?.path()))
        .collect::<Result<Vec<_>>>()?;
    paths.sort();
    let inputs = paths.iter().map(fs::read).collect::<Result<Vec<_>, _>>()?;
    let packed = pack(&inputs)?;
    fs::write(file(name), &packed)?;
    Ok((inputs.len(), packed.len()))
}

fn file(target: &str) -> PathBuf {
    sources().join("corpus").join(format!("{target}.inputs"))
}

fn pack(inputs: &[Vec<u8>]) -> Result<Vec<u8>> {
    let mut packed = Vec::new();
    for input in inputs {
        packed.extend(u32::try_from(input.len())?.to_le_bytes());
        packed.extend(input);
    }
    Ok(packed)
}

/// The inputs of a file; `None` if it ends within an input.
fn unpack(mut packed: &[u8]) -> Option<Vec<&[u8]>> {
    let mut inputs = Vec::new();
    while !packed.is_empty() {
        let (length, rest) = packed.split_first_chunk()?;
        let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
        let (input, rest) = rest.split_at_checked(length)?;
        inputs.push(input);
        packed = rest;
    }
    Some(inputs)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inputs_are_unpacked_as_they_were_packed() {
        let inputs = [vec![], vec![7; 300], vec![1, 2]];
        let packed = pack(&inputs).unwrap();
        assert_eq!(packed.len(), 3 * 4 + 302);
        assert_eq!(unpack(&packed).unwrap(), inputs);
        for end in [1, 4, 5, 307, 309, 313] {
            let cut = unpack(&packed[..end]);
            assert!(cut.is_none_or(|cut| cut.len() < 3), "{end}");
        }
        assert_eq!(unpack(&packed[..5]), None);
    }

    #[test]
    fn what_the_repository_keeps_can_be_read_and_has_no_input_twice() {
        let folder = sources().join("corpus");
        let files = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path());
        let files: Vec<_> = files
            .filter(|path| path.extension().is_some_and(|ending| ending == "inputs"))
            .collect();
        assert!(files.len() > 10, "{files:?}");
        for path in files {
            let bytes = fs::read(&path).unwrap();
            let mut inputs = unpack(&bytes).unwrap();
            let all = inputs.len();
            inputs.sort_unstable();
            inputs.dedup();
            assert!(all > 0 && inputs.len() == all, "{}", path.display());
        }
    }
}
