//! The compiler that builds for the Cortex-M4F, or for a browser, on this machine.
//!
//! First choice: the target that rustup downloads. Where there is no such download, Debian's packages:
//! a compiler and the sources of its libraries, which cargo then builds for the target.

use std::{fmt, fs, path::Path, path::PathBuf, process::Command};

use anyhow::{Context as _, Result, bail, ensure};

use crate::debian;

/// The target of every board: Cortex-M4 with FPU, hard-float calling convention.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// The target of the page that needs no program.
pub const WEB: &str = "wasm32-unknown-unknown";

/// Debian's packages of compiler, cargo, sources of `core` and clippy.
const DEBIAN_PACKAGES: [&str; 4] = ["rustc-web", "cargo-web", "rust-web-src", "rust-web-clippy"];
const DEBIAN_CARGO: &str = "/usr/bin/cargo";
/// Started directly: `cargo clippy` would find rustup's, which uses rustup's compiler.
const DEBIAN_CLIPPY: &str = "/usr/bin/cargo-clippy";
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";

/// A toolchain that can build for a target.
#[derive(Debug, PartialEq, Eq)]
pub enum Toolchain {
    /// rustup has the libraries for the target.
    Rustup,
    /// Debian's compiler builds the libraries from source and links with the given `rust-lld`.
    Debian {
        /// The linker, which is in no package of Debian's: that of rustup's toolchain.
        linker: PathBuf,
    },
}

/// Finds a toolchain for a target; installs Debian's if there is none and `install` is set.
///
/// # Errors
/// When there is none; names the commands that install one.
pub fn find(target: &str, install: bool) -> Result<Toolchain> {
    if rustup_has(target) {
        return Ok(Toolchain::Rustup);
    }
    let missing = debian::missing(&DEBIAN_PACKAGES);
    if !missing.is_empty() {
        let command = debian::install_command(&missing);
        ensure!(
            install,
            "no compiler for {target}. Either\n  rustup target add {target}\nor, where rustup cannot \
             download,\n  {command}\n(--install runs the latter)"
        );
        debian::install(&missing)?;
    }
    Ok(Toolchain::Debian {
        linker: rust_lld()?,
    })
}

/// Runs the firmware on a board, by cargo with these further arguments. First checks what cargo would find missing only
/// after a minute or more of compiling.
///
/// # Errors
/// When there is no compiler for the target, `probe-rs` is missing, or cargo fails.
pub fn run_on_board(arguments: &[String]) -> Result<()> {
    let toolchain = find(TARGET, false)?;
    // Another runner brings its own program.
    let another = std::env::var_os("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUNNER");
    let probe = Command::new("probe-rs").arg("--version").output();
    ensure!(
        another.is_some() || probe.is_ok(),
        "no probe-rs, which flashes the board: https://probe.rs says how to install it"
    );
    let status = toolchain
        .cargo("run", TARGET)
        .args(["--package", "myointent-firmware", "--profile", "firmware"])
        .args(arguments)
        .status()?;
    ensure!(status.success(), "the board's program did not run");
    Ok(())
}

impl Toolchain {
    /// A cargo command for a target with this toolchain; the package is to be added.
    pub fn cargo(&self, subcommand: &str, target: &str) -> Command {
        let mut cargo = match self {
            Self::Rustup => Command::new(env!("CARGO")),
            Self::Debian { .. } if subcommand == "clippy" => Command::new(DEBIAN_CLIPPY),
            Self::Debian { .. } => Command::new(DEBIAN_CARGO),
        };
        cargo.args([subcommand, "--target", target]);
        if let Self::Debian { linker } = self {
            // build-std is unstable; RUSTC_BOOTSTRAP permits it on a stable compiler.
            let libraries = if target == WEB {
                "build-std=std,panic_abort"
            } else {
                "build-std=core,alloc"
            };
            let name = target.to_uppercase().replace('-', "_");
            cargo
                .args(["-Z", libraries])
                .env("RUSTC_BOOTSTRAP", "1")
                .env("RUSTC", DEBIAN_RUSTC)
                .env(format!("CARGO_TARGET_{name}_LINKER"), linker);
            // Set by the cargo that runs this program, for rustup's compiler.
            for name in ["RUSTUP_TOOLCHAIN", "RUSTC_WRAPPER", "RUSTDOC"] {
                cargo.env_remove(name);
            }
            cargo.env("CARGO", DEBIAN_CARGO);
        }
        cargo
    }
}

impl fmt::Display for Toolchain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rustup => f.write_str("rustup's toolchain: it has the target"),
            Self::Debian { linker } => write!(
                f,
                "Debian's {DEBIAN_CARGO}, building the libraries from source: rustup has not the target\n\
                 linker {}",
                linker.display()
            ),
        }
    }
}

fn rustup_has(target: &str) -> bool {
    let installed = Command::new("rustup")
        .args(["target", "list", "--installed"])
        .output();
    // Without rustup the command cannot be run: then it has no target either.
    installed.is_ok_and(|output| lists(target, &String::from_utf8_lossy(&output.stdout)))
}

fn lists(target: &str, installed: &str) -> bool {
    installed.lines().any(|line| line.trim() == target)
}

/// The linker of rustup's toolchain, or else a `rust-lld` on the path.
fn rust_lld() -> Result<PathBuf> {
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let output = Command::new(rustc)
        .args(["--print", "sysroot"])
        .output()
        .context("rustc cannot be run")?;
    let sysroot = PathBuf::from(String::from_utf8(output.stdout)?.trim());
    let hosts = sysroot.join("lib/rustlib");
    for host in
        fs::read_dir(&hosts).with_context(|| format!("{} cannot be read", hosts.display()))?
    {
        let linker = host?.path().join("bin/rust-lld");
        if linker.is_file() {
            return Ok(linker);
        }
    }
    let on_path = std::env::var_os("PATH")
        .iter()
        .flat_map(std::env::split_paths)
        .map(|directory| directory.join("rust-lld"))
        .find(|candidate: &PathBuf| Path::is_file(candidate));
    let Some(linker) = on_path else {
        bail!(
            "no rust-lld under {} nor on the path: install a toolchain with rustup",
            hosts.display()
        );
    };
    Ok(linker)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_full_name_is_the_target() {
        assert!(lists(
            TARGET,
            "x86_64-unknown-linux-gnu\nthumbv7em-none-eabihf\n"
        ));
        assert!(!lists(
            TARGET,
            "thumbv7em-none-eabi\nthumbv7em-none-eabihf-extra\n"
        ));
    }

    #[test]
    fn debians_cargo_gets_its_own_compiler_and_linker() {
        let linker = PathBuf::from("/somewhere/rust-lld");
        let cargo = Toolchain::Debian {
            linker: linker.clone(),
        }
        .cargo("build", TARGET);
        let set: Vec<_> = cargo.get_envs().collect();
        assert!(set.contains(&("RUSTC".as_ref(), Some(DEBIAN_RUSTC.as_ref()))));
        assert!(set.contains(&(
            "CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER".as_ref(),
            Some(linker.as_os_str())
        )));
        assert!(set.contains(&("RUSTUP_TOOLCHAIN".as_ref(), None)));
    }
}
