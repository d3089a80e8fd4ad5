//! The compiler that builds for the Cortex-M4F, for a browser or for 64-bit ARM, on this machine.
//!
//! First choice: the target that rustup downloads. Where there is no such download, Debian's packages:
//! a compiler and the sources of its libraries, which cargo then builds for the target.

use std::{env, fmt, iter, path::Path, path::PathBuf, process::Command};

use anyhow::{Context as _, Result, ensure};

use crate::{debian, host, run, rustc};

/// The target of every board: Cortex-M4 with FPU, hard-float calling convention.
pub const TARGET: &str = "thumbv7em-none-eabihf";

/// The target of the page that needs no program.
pub const WEB: &str = "wasm32-unknown-unknown";

/// The target of small computers, such as a Raspberry Pi.
pub const ARM: &str = "aarch64-unknown-linux-gnu";
/// Debian's linker for it, and what it needs.
const ARM_LINKER: &str = "aarch64-linux-gnu-gcc";
const ARM_PACKAGES: [&str; 2] = ["gcc-aarch64-linux-gnu", "libc6-dev-arm64-cross"];

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
    /// Debian's compiler builds the libraries from source and uses the given linker.
    Debian {
        /// The linker: `rust-lld`, which is in no package of Debian's, of rustup's toolchain, or a compiler.
        linker: PathBuf,
    },
}

/// Finds a toolchain for a target; installs Debian's if there is none and `install` is set.
pub fn find(target: &str, install: bool) -> Result<Toolchain> {
    if rustup_has(target) {
        return Ok(Toolchain::Rustup);
    }
    let mut packages = DEBIAN_PACKAGES.to_vec();
    if target == ARM {
        packages.extend(ARM_PACKAGES);
    }
    let otherwise = format!(
        "no compiler for {target}. Either\n  rustup target add {target}\nor, where rustup cannot download,"
    );
    debian::provide(&packages, install, &otherwise)?;
    let linker = match target {
        TARGET | WEB => rust_lld()?,
        _ => ARM_LINKER.into(),
    };
    Ok(Toolchain::Debian { linker })
}

/// Runs the firmware on a board, by cargo with these further arguments. First checks what cargo would find missing only
/// after a minute or more of compiling.
pub fn run_on_board(arguments: &[String]) -> Result<()> {
    let toolchain = find(TARGET, false)?;
    // Another runner brings its own program.
    let another = env::var_os("CARGO_TARGET_THUMBV7EM_NONE_EABIHF_RUNNER");
    let probe = Command::new("probe-rs").arg("--version").output();
    ensure!(
        another.is_some() || probe.is_ok(),
        "no probe-rs, which flashes the board: https://probe.rs says how to install it"
    );
    let mut cargo = toolchain.cargo("run", TARGET);
    cargo
        .args(["--package", "myointent-firmware", "--profile", "firmware"])
        .args(arguments);
    run(&mut cargo, "the board's program did not run")
}

impl Toolchain {
    /// A cargo command for a target with this toolchain; the package is to be added.
    pub fn cargo(&self, subcommand: &str, target: &str) -> Command {
        let program = match self {
            Self::Rustup => env!("CARGO"),
            Self::Debian { .. } if subcommand == "clippy" => DEBIAN_CLIPPY,
            Self::Debian { .. } => DEBIAN_CARGO,
        };
        let mut cargo = Command::new(program);
        cargo.arg(subcommand);
        self.build_for(target, &mut cargo);
        cargo
    }

    /// Has a command that builds, cargo or one that calls it, build for a target.
    pub fn build_for(&self, target: &str, command: &mut Command) {
        command.args(["--target", target]);
        let linker = match self {
            Self::Debian { linker } => Some(linker.as_path()),
            Self::Rustup => (target == ARM).then(|| Path::new(ARM_LINKER)),
        };
        if let Some(linker) = linker {
            let name = target.to_uppercase().replace('-', "_");
            command.env(format!("CARGO_TARGET_{name}_LINKER"), linker);
        }
        if let Self::Debian { .. } = self {
            // build-std is unstable; RUSTC_BOOTSTRAP permits it on a stable compiler.
            let libraries = match target {
                TARGET => "build-std=core,alloc",
                WEB => "build-std=std,panic_abort",
                _ => "build-std=std,panic_abort,panic_unwind",
            };
            command
                .args(["-Z", libraries])
                .env("RUSTC_BOOTSTRAP", "1")
                .env("RUSTC", DEBIAN_RUSTC);
            // Set by the cargo that runs this program, for rustup's compiler.
            for name in ["RUSTUP_TOOLCHAIN", "RUSTC_WRAPPER", "RUSTDOC"] {
                command.env_remove(name);
            }
            command.env("CARGO", DEBIAN_CARGO);
        }
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
    let sysroot = rustc(&["--print", "sysroot"])?;
    let libraries = Path::new(sysroot.trim()).join("lib/rustlib");
    let own = libraries.join(host()?).join("bin/rust-lld");
    let path = env::var_os("PATH").unwrap_or_default();
    let on_path = env::split_paths(&path).map(|folder| folder.join("rust-lld"));
    let missing = format!(
        "no {} nor rust-lld on the path: install a toolchain with rustup",
        own.display()
    );
    let mut files = iter::once(own).chain(on_path);
    files.find(|file| file.is_file()).context(missing)
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
