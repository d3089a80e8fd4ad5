//! The program of tests/fuzz: how it is compiled, and which targets it has.

use std::{
    env,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context as _, Result, ensure};

use crate::run;

/// Compiler flags that count branches, and show libFuzzer the operands of comparisons; those of `cargo fuzz`.
const FLAGS: [&str; 5] = [
    "-Cpasses=sancov-module",
    "-Cllvm-args=-sanitizer-coverage-level=4",
    "-Cllvm-args=-sanitizer-coverage-inline-8bit-counters",
    "-Cllvm-args=-sanitizer-coverage-pc-table",
    "-Cllvm-args=-sanitizer-coverage-trace-compares",
];

pub(super) fn sources() -> PathBuf {
    crate::workspace().join("tests/fuzz")
}

/// A folder of its own: compiled with other flags than everything else.
pub(super) fn folder() -> PathBuf {
    crate::target().join("fuzz")
}

pub(super) fn build() -> Result<PathBuf> {
    let host = crate::host()?;
    let compiler = env::var_os("CXX").unwrap_or_else(|| "c++".into());
    ensure!(
        Command::new(&compiler).arg("--version").output().is_ok(),
        "no C++ compiler, which libFuzzer is compiled with: apt-get install g++"
    );
    let mut flags = env::var("RUSTFLAGS").unwrap_or_default();
    for flag in FLAGS {
        flags = format!("{flags} {flag}");
    }
    let folder = folder();
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        // With a target named, the flags are not those of build scripts and macros.
        .args(["build", "--quiet", "--locked", "--release", "--target"])
        .arg(&host)
        .arg("--manifest-path")
        .arg(sources().join("Cargo.toml"))
        .arg("--target-dir")
        .arg(&folder)
        .env("RUSTFLAGS", flags.trim());
    run(&mut cargo, "the fuzz targets cannot be built")?;
    Ok(folder.join(host).join("release/myointent-fuzz"))
}

#[derive(PartialEq, Eq, Debug)]
pub(super) struct Target {
    pub name: String,
    /// Bytes of its longest input.
    pub longest: u32,
}

impl Target {
    /// Parses a line of the program: name and longest input, with a space between.
    fn of(line: &str) -> Result<Self> {
        let named = line.split_once(' ');
        let (name, longest) = named.with_context(|| format!("{line:?} is no target"))?;
        Ok(Self {
            name: name.to_owned(),
            longest: longest.parse()?,
        })
    }
}

pub(super) fn targets(program: &Path) -> Result<Vec<Target>> {
    let output = Command::new(program)
        .env("MYOINTENT_FUZZ_LIST", "1")
        .output()
        .with_context(|| format!("{} cannot be run", program.display()))?;
    let text = String::from_utf8(output.stdout)?;
    ensure!(!text.is_empty(), "no targets");
    text.lines().map(Target::of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_is_a_name_and_the_length_of_its_longest_input() {
        let target = Target::of("npy 1024").unwrap();
        assert_eq!((target.name.as_str(), target.longest), ("npy", 1024));
        assert!(Target::of("npy").is_err() && Target::of("npy many").is_err());
    }
}
