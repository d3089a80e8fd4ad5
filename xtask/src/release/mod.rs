//! Files of a release: `cargo xtask release --out FOLDER`. `.github/workflows/release.yml` calls the parts on several systems;
//! `tests/release` uses each file as a user does.

mod packages;

use std::env::consts::EXE_SUFFIX;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use sha2::{Digest as _, Sha256};
use shared::uf2::Uf2;

use crate::firmware::{Compiling, Image};
use crate::toolchain::{self, ARM};
use crate::{cargo, cross_target, merge, page, target, uf2, workspace};

const SUMS: &str = "SHA256SUMS";
/// Shipped models, with the one of the images first.
const MODELS: [&str; 3] = ["three-class", "five-class", "six-class"];

#[derive(Clone, Copy, PartialEq, Eq, Debug, clap::ValueEnum)]
enum ReleasePart {
    /// Images with a model, models, the page: the same from every system.
    Boards,
    /// The program for this system.
    Program,
    /// The Python package for this system.
    Wheel,
    /// The Python package for 64-bit ARM, built on another Linux.
    ArmWheel,
    /// Licences and packages of all that is linked, what the files are, checksums of the folder.
    Papers,
}

/// Options of a release.
#[derive(Debug, clap::Parser)]
pub struct Arguments {
    /// Folder to write.
    #[arg(long)]
    out: PathBuf,
    /// Tag of the release: the version of the crates, and the first heading of the changelog.
    #[arg(long)]
    tag: Option<String>,
    /// Installs a missing cross compiler or libclang, as root, with apt-get.
    #[arg(long)]
    install: bool,
    /// Parts to make.
    #[arg(default_values = ["boards", "program", "wheel", "papers"])]
    parts: Vec<ReleasePart>,
}

/// Makes the parts of a release.
pub fn run(arguments: &Arguments) -> Result<()> {
    let out = &arguments.out;
    if let Some(tag) = &arguments.tag {
        let changelog = fs::read_to_string(workspace().join("CHANGELOG.md"))?;
        agree(tag, env!("CARGO_PKG_VERSION"), &changelog)?;
    }
    fs::create_dir_all(out).with_context(|| format!("{} cannot be made", out.display()))?;
    for part in &arguments.parts {
        match part {
            ReleasePart::Boards => boards(out, arguments.install)?,
            ReleasePart::Program => program(out)?,
            ReleasePart::Wheel => wheel(out, &mut maturin())?,
            ReleasePart::ArmWheel => {
                let mut maturin = maturin();
                maturin.env("CARGO_TARGET_DIR", cross_target());
                toolchain::find(ARM, arguments.install)?.build_for(ARM, &mut maturin);
                wheel(out, &mut maturin)?;
            }
            ReleasePart::Papers => papers(out)?,
        }
    }
    Ok(())
}

/// Refuses a tag of another version, and a version that is not the newest of the changelog.
fn agree(tag: &str, version: &str, changelog: &str) -> Result<()> {
    ensure!(
        tag == format!("v{version}"),
        "tag {tag}: the crates have version {version}"
    );
    let newest = changelog.lines().find_map(|line| line.strip_prefix("## "));
    let newest = newest.and_then(|heading| heading.split(' ').next());
    ensure!(
        newest == Some(version),
        "CHANGELOG.md begins with {newest:?}, not with {version}"
    );
    Ok(())
}

fn boards(out: &Path, install: bool) -> Result<()> {
    let models = workspace().join("models");
    let files = |name: String| merge::Files {
        model: models.join(MODELS[0]).with_extension("intent"),
        out: Some(out.join(name)),
        compiling: Compiling {
            install,
            locked: true,
        },
    };
    for board in Image::UF2.map(|image| image.name().to_owned()) {
        let files = files(format!("{board}.uf2"));
        uf2::run(&uf2::Arguments { board, files })?;
    }
    for image in merge::CHIPS.map(|image| image.name().to_owned()) {
        let files = files(format!("{image}.hex"));
        merge::run(&merge::Arguments {
            image,
            softdevice: None,
            files,
        })?;
    }
    let page = out.join("myointent.html");
    page::run(&page::Arguments { out: page, install })?;
    for name in MODELS {
        let file = format!("{name}.intent");
        let model = fs::read(models.join(&file)).context(file.clone())?;
        let mut uf2 = Uf2::default();
        uf2.put_model(&model)?;
        fs::write(out.join(format!("{name}.uf2")), uf2.file())?;
        fs::write(out.join(file), model)?;
    }
    Ok(())
}

fn program(out: &Path) -> Result<()> {
    let mut cargo = cargo();
    cargo.args(["rustc", "--release", "--locked", "--package=myointent"]);
    cargo.args(["--bin=myointent", "--", "-Cstrip=symbols"]);
    crate::run(&mut cargo, "the program did not build")?;
    let built = target()
        .join("release")
        .join(format!("myointent{EXE_SUFFIX}"));
    let file = out.join(program_name(&crate::host()?));
    fs::copy(&built, &file).with_context(|| format!("{} cannot be kept", built.display()))?;
    println!("{}", file.display());
    Ok(())
}

/// Name of the program's file for a target triple, which `cargo binstall` downloads.
fn program_name(target: &str) -> String {
    let suffix = if target.contains("windows") {
        ".exe"
    } else {
        ""
    };
    format!("myointent-{target}{suffix}")
}

/// The `maturin` of the package's tests, or the one on the path, as it builds a wheel.
fn maturin() -> Command {
    let own = target().join("python/bin/maturin");
    let mut maturin = Command::new(if own.is_file() { own } else { "maturin".into() });
    maturin.args(["build", "--release", "--locked"]);
    maturin
}

fn wheel(out: &Path, maturin: &mut Command) -> Result<()> {
    let package = workspace().join("host/python");
    let licences = packages::licences(&packages::linked()?)?;
    fs::write(package.join("LICENSES.txt"), licences)?;
    maturin
        .arg("--manifest-path")
        .arg(package.join("Cargo.toml"));
    crate::run(maturin.arg("--out").arg(out), "the wheel did not build")
}

fn papers(out: &Path) -> Result<()> {
    let linked = packages::linked()?;
    fs::write(out.join("LICENSES.txt"), packages::licences(&linked)?)?;
    fs::write(out.join("sbom.cdx.json"), packages::bill(&linked))?;
    fs::copy(workspace().join(".github/release.md"), out.join("FILES.md"))?;
    fs::write(out.join(SUMS), sums(out)?)?;
    Ok(())
}

/// Checksums of a folder's files, as `sha256sum` writes them.
fn sums(folder: &Path) -> Result<String> {
    let mut lines = Vec::new();
    for entry in fs::read_dir(folder)? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        if name != SUMS {
            let sum = Sha256::digest(fs::read(folder.join(&name))?);
            let sum: String = sum.iter().map(|byte| format!("{byte:02x}")).collect();
            lines.push((name.clone(), format!("{sum}  {name}\n")));
        }
    }
    lines.sort();
    Ok(lines.into_iter().map(|(_, line)| line).collect())
}

#[cfg(test)]
mod tests {
    use std::env;

    use clap::Parser as _;

    use super::*;

    #[test]
    fn a_tag_must_be_the_version_and_the_newest_of_the_changelog() {
        let changelog = "# Changelog\n\n## 0.2.0 - 2026-11-29\n\n## 0.1.0\n";
        assert!(agree("v0.2.0", "0.2.0", changelog).is_ok());
        assert!(agree("v0.2.0", "0.3.0", changelog).is_err());
        assert!(agree("0.2.0", "0.2.0", changelog).is_err());
        assert!(agree("v0.1.0", "0.1.0", changelog).is_err());
        assert!(agree("v0.2", "0.2", changelog).is_err());
        let more = "# Changelog\n\n## Unreleased\n\n- news\n\n## 0.2.0\n";
        assert!(agree("v0.2.0", "0.2.0", more).is_err());
    }

    #[test]
    fn the_changelog_has_this_version() {
        let changelog = include_str!("../../../CHANGELOG.md");
        let done = changelog.replace("\n## Unreleased\n", "\n");
        let version = env!("CARGO_PKG_VERSION");
        agree(&format!("v{version}"), version, &done).unwrap();
    }

    #[test]
    fn sums_are_those_of_sha256sum_and_leave_themselves_out() {
        let folder = env::temp_dir().join(format!("xtask-release-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        for (name, text) in [("b", "p { }"), ("a", ""), (SUMS, "old")] {
            fs::write(folder.join(name), text).unwrap();
        }
        // By sha256sum.
        assert_eq!(
            sums(&folder).unwrap(),
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  a\n\
             d87e42502bf2a39712923d588549e047bda4b35dd0ae606380dfb3cff969d836  b\n"
        );
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn cargo_binstall_downloads_a_file_of_the_release() {
        let manifest = include_str!("../../../host/Cargo.toml");
        let metadata = |key: &str| {
            let mut lines = manifest.lines();
            let value = lines.find_map(|line| line.strip_prefix(key)?.strip_prefix(" = \""));
            value.and_then(|own| own.strip_suffix('"')).unwrap()
        };
        assert_eq!(metadata("pkg-fmt"), "bin");
        let version = env!("CARGO_PKG_VERSION");
        let url = metadata("pkg-url").replace("{ version }", version);
        let url = url.replace("{ repo }", env!("CARGO_PKG_REPOSITORY"));
        let files = include_str!("../../../.github/release.md");
        for (target, suffix) in [
            ("x86_64-unknown-linux-gnu", ""),
            ("aarch64-unknown-linux-gnu", ""),
            ("aarch64-apple-darwin", ""),
            ("x86_64-apple-darwin", ""),
            ("x86_64-pc-windows-msvc", ".exe"),
        ] {
            let url = url.replace("{ bin }", "myointent");
            let url = url.replace("{ target }", target);
            let url = url.replace("{ binary-ext }", suffix);
            let name = program_name(target);
            let repository = "https://github.com/myointent/myointent";
            assert_eq!(
                url,
                format!("{repository}/releases/download/v{version}/{name}")
            );
            assert!(files.contains(&format!("`{name}`")), "{name}");
        }
    }

    #[test]
    fn the_workflow_calls_what_there_is() {
        let workflow = include_str!("../../../.github/workflows/release.yml");
        let calls = workflow
            .lines()
            .filter_map(|line| line.split_once("cargo xtask release "));
        let mut parts = Vec::new();
        for (_, call) in calls {
            let parsed = Arguments::try_parse_from(["release"].into_iter().chain(call.split(' ')));
            parts.extend(
                parsed
                    .unwrap_or_else(|error| panic!("{call}: {error}"))
                    .parts,
            );
        }
        assert_eq!(
            parts,
            [
                ReleasePart::Boards,
                ReleasePart::Program,
                ReleasePart::Wheel,
                ReleasePart::Papers,
                ReleasePart::Papers
            ]
        );
    }
}
