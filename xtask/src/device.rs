//! Builds and runs test programs for the emulated Cortex-M4F.
//!
//! The emulator is QEMU with its board `mps2-an386`. Arguments, files, output and exit code of a
//! program go through semihosting (tests/device/runtime).

use std::{
    ffi::OsStr,
    io::{self, Read as _},
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::mpsc,
    thread,
    time::Duration,
};

use anyhow::{Context as _, Result, bail, ensure};

use crate::cross_target;
use crate::emulator::QEMU;
use crate::toolchain::{TARGET, Toolchain};

/// A program for the emulated core.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Image {
    /// The unit tests of `shared`.
    UnitTests,
    /// Runs a golden check.
    Golden,
    /// Counts instructions.
    Count,
}

impl Image {
    fn cargo_arguments(self) -> &'static [&'static str] {
        match self {
            Self::UnitTests => &["--package=myointent-shared", "--lib", "--profile=test"],
            Self::Golden => &[
                "--package=myointent-device-images",
                "--bin=golden",
                "--profile=device",
            ],
            Self::Count => &[
                "--package=myointent-device-images",
                "--bin=count",
                "--profile=device",
            ],
        }
    }
}

/// Builds an image and gives its path.
pub fn build(toolchain: &Toolchain, image: Image) -> Result<PathBuf> {
    let mut cargo = toolchain.cargo("rustc", TARGET);
    cargo
        .args(image.cargo_arguments())
        // The cargo that built this program has brought Cargo.lock up to date.
        .args([
            "--locked",
            "--quiet",
            "--message-format=json-render-diagnostics",
        ])
        // Without --nmagic the linker pads segments to pages of 64 KiB.
        .args(["--", "-Clink-arg=-Tlink.x", "-Clink-arg=--nmagic"])
        .env("CARGO_TARGET_DIR", cross_target())
        // The test harness of `shared` needs an unstable feature.
        .env("RUSTC_BOOTSTRAP", "1")
        .stderr(Stdio::inherit());
    let output = cargo.output().context("cargo cannot be run")?;
    ensure!(output.status.success(), "{image:?} did not build");
    let messages = String::from_utf8(output.stdout)?;
    executable(&messages).with_context(|| format!("cargo named no executable of {image:?}"))
}

/// The last executable in cargo's messages: libraries and build scripts come before.
fn executable(messages: &str) -> Option<PathBuf> {
    let executable = |line: &str| {
        let message: serde_json::Value = serde_json::from_str(line).ok()?;
        Some(PathBuf::from(message.get("executable")?.as_str()?))
    };
    messages.lines().filter_map(executable).next_back()
}

/// Pace of the emulated time.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Clock {
    /// Time that passes as fast as the emulator goes.
    Free,
    /// 64 ns an instruction, on every machine: the timers count instructions.
    Instructions,
}

/// Result of a program's run.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DeviceOutcome {
    /// True if the program exited with 0.
    pub success: bool,
    /// Text that the program and the emulator printed.
    pub output: String,
}

/// Runs an image to its end.
pub fn run(
    image: &Path,
    arguments: &[impl AsRef<OsStr>],
    clock: Clock,
    limit: Duration,
) -> Result<DeviceOutcome> {
    let (mut output, input) = io::pipe()?;
    let mut emulator = Command::new(QEMU);
    emulator
        .args(["-M", "mps2-an386", "-cpu", "cortex-m4"])
        .args(["-display", "none", "-monitor", "none", "-serial", "none"])
        .arg("-semihosting-config")
        .arg(semihosting(arguments))
        .arg("-kernel")
        .arg(image)
        .stdin(Stdio::null())
        .stdout(input.try_clone()?)
        .stderr(input);
    if clock == Clock::Instructions {
        emulator.args(["-icount", "shift=6"]);
    }
    let mut running = emulator.spawn().context("the emulator cannot be started")?;
    // It holds a writing end of the pipe, and the output ends when the last one is closed.
    drop(emulator);

    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || {
        let mut bytes = Vec::new();
        let read = output.read_to_end(&mut bytes);
        // The receiver is gone once the limit is over.
        let _ = sender.send(read.map(|_| bytes));
    });
    let Ok(bytes) = receiver.recv_timeout(limit) else {
        running.kill()?;
        running.wait()?;
        bail!("no end within {limit:?}");
    };
    Ok(DeviceOutcome {
        success: running.wait()?.success(),
        output: String::from_utf8_lossy(&bytes?).into_owned(),
    })
}

/// The emulator's option: the first argument is the program's name. A comma in an argument is doubled.
fn semihosting(arguments: &[impl AsRef<OsStr>]) -> String {
    let mut option = String::from("enable=on,target=native,arg=image");
    for argument in arguments {
        let argument = argument.as_ref().to_string_lossy().replace(',', ",,");
        option.push_str(",arg=");
        option.push_str(&argument);
    }
    option
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_executable_is_found_among_cargos_messages() {
        let messages = r#"{"reason":"compiler-artifact","executable":null}
{"reason":"compiler-artifact","executable":"/target/debug/deps/shared-0123"}
{"reason":"build-finished","success":true}
"#;
        let expected = PathBuf::from("/target/debug/deps/shared-0123");
        assert_eq!(executable(messages), Some(expected));
        assert_eq!(executable("{}\nno message\n"), None);
    }

    #[test]
    fn arguments_may_hold_commas() {
        let option = semihosting(&["a::b", "/tmp/x,y"]);
        assert_eq!(
            option,
            "enable=on,target=native,arg=image,arg=a::b,arg=/tmp/x,,y"
        );
    }
}
