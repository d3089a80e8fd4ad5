//! Advice about a serial port that cannot be used, step by step.

use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

use serde::Serialize;
use web::said::Said;

/// Reason why a port cannot be used, and steps that help.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Advice {
    pub(super) why: Said,
    pub(super) steps: Vec<Said>,
}

/// Reason why a port cannot be used.
#[derive(Serialize, thiserror::Error, Debug)]
#[serde(tag = "name", rename_all = "kebab-case")]
enum Reason<'p> {
    #[error("another program has {path} open")]
    Busy { path: &'p str },
    #[error("there is no port {path}")]
    Missing { path: &'p str },
    #[error("this user may not open {path}")]
    Forbidden { path: &'p str },
    #[error("{path} is gone")]
    Gone { path: &'p str },
    #[error("{path} is no serial port")]
    NotSerial { path: &'p str },
    #[error("{why}; looking for it again")]
    Again { why: &'p Said },
}

/// Step that may help.
#[derive(Serialize, thiserror::Error, Debug)]
#[serde(tag = "name", rename_all = "kebab-case")]
enum Step {
    #[error(
        "Close every other program that reads this port: a terminal, a serial monitor, another myointent."
    )]
    Close,
    #[error("If none is to be found, pull the board's USB cable and put it back.")]
    PullIfNone,
    #[error("Pull the board's USB cable and put it back.")]
    Pull,
    #[error("Check the board's USB cable and its power.")]
    Check,
    #[error("Connect the board's USB cable: one that carries data, not power alone.")]
    Connect,
    #[error(
        "Linux: run  sudo usermod -aG dialout $USER  (uucp in place of dialout on Arch) and log in again, or have udev give you the port."
    )]
    Linux,
    #[error("macOS: name the port /dev/cu.usbmodem…, not /dev/tty…")]
    Macos,
    #[error("No serial port exists on this computer at the moment.")]
    NoPorts,
    #[error(
        "Ports that exist: {ports}. If one of them is the board, end the program and start it with  --port {first}"
    )]
    Ports { ports: String, first: String },
}

/// Error number of a path that is not a serial port on Linux and macOS (`ENOTTY`).
const NO_TERMINAL: i32 = 25;
/// Error numbers of a port whose device is gone there (`EIO`, `ENXIO`, `ENODEV`).
const GONE: [i32; 3] = [5, 6, 19];

impl Advice {
    /// Advice for an error of opening or reading a port; `ports` are the existing ones.
    pub(super) fn of(error: &Error, path: &Path, ports: &[PathBuf]) -> Self {
        let path = &*path.to_string_lossy();
        let is_busy = cfg!(windows) && error.kind() == ErrorKind::PermissionDenied
            || error.kind() == ErrorKind::ResourceBusy;
        let has_number = |numbers: &[i32]| {
            cfg!(unix)
                && error
                    .raw_os_error()
                    .is_some_and(|raw| numbers.contains(&raw))
        };
        let (why, steps) = match error.kind() {
            _ if is_busy => (
                Some(Reason::Busy { path }),
                vec![Step::Close, Step::PullIfNone],
            ),
            ErrorKind::NotFound => (
                Some(Reason::Missing { path }),
                vec![Step::Connect, Step::existing(ports)],
            ),
            ErrorKind::PermissionDenied => (
                Some(Reason::Forbidden { path }),
                vec![Step::Linux, Step::Macos],
            ),
            _ if error.kind() == ErrorKind::UnexpectedEof || has_number(&GONE) => (
                Some(Reason::Gone { path }),
                vec![Step::Check, Step::existing(ports)],
            ),
            _ if has_number(&[NO_TERMINAL]) => (
                Some(Reason::NotSerial { path }),
                vec![Step::existing(ports)],
            ),
            _ => (None, vec![Step::Pull, Step::existing(ports)]),
        };
        Self {
            why: why.map_or_else(|| Said::of_os(error), |why| Said::of("port", &why)),
            steps: steps.iter().map(|step| Said::of("cable", step)).collect(),
        }
    }

    /// The reason, of a port that is looked for again.
    pub(super) fn again(&self) -> Said {
        Said::of("port", &Reason::Again { why: &self.why })
    }
}

impl Step {
    /// Step that names the ports that exist.
    fn existing(ports: &[PathBuf]) -> Self {
        let ports: Vec<_> = ports
            .iter()
            .map(|port| port.display().to_string())
            .collect();
        match ports.first() {
            None => Self::NoPorts,
            Some(first) => Self::Ports {
                first: first.clone(),
                ports: ports.join(", "),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn advice(error: Error, ports: &[&str]) -> Advice {
        let ports: Vec<_> = ports.iter().map(PathBuf::from).collect();
        Advice::of(&error, Path::new("/dev/ttyACM0"), &ports)
    }

    #[test]
    fn each_error_has_its_reason_and_steps_and_none_its_number() {
        for (kind, why, step) in [
            (
                ErrorKind::NotFound,
                "there is no port /dev/ttyACM0",
                "USB cable",
            ),
            (ErrorKind::ResourceBusy, "another program", "Close"),
            (ErrorKind::UnexpectedEof, "is gone", "power"),
        ] {
            let advice = advice(kind.into(), &[]);
            assert!(advice.why.text.contains(why), "{advice:?}");
            assert!(advice.steps[0].text.contains(step), "{advice:?}");
        }
        let refused = advice(ErrorKind::PermissionDenied.into(), &[]);
        let expected = if cfg!(windows) {
            "another"
        } else {
            "may not open"
        };
        assert!(refused.why.text.contains(expected), "{refused:?}");
        let none = advice(Error::from_raw_os_error(NO_TERMINAL), &[]);
        assert!(
            cfg!(windows) || none.why.text.contains("no serial port"),
            "{none:?}"
        );
    }

    #[test]
    fn the_ports_that_exist_are_named() {
        let some = advice(ErrorKind::NotFound.into(), &["/dev/ttyACM1", "/dev/ttyS0"]);
        assert!(
            some.steps[1].text.contains("/dev/ttyACM1, /dev/ttyS0"),
            "{some:?}"
        );
        let none = advice(ErrorKind::NotFound.into(), &[]);
        assert!(none.steps[1].text.contains("No serial port"), "{none:?}");
    }
}
