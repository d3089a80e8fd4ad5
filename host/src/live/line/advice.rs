//! Advice about a serial port that cannot be used, step by step.

use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

/// Reason why a port cannot be used, and steps that help.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) struct Advice {
    pub(super) why: String,
    pub(super) steps: Vec<String>,
}

/// Error number of a path that is not a serial port on Linux and macOS (`ENOTTY`).
const NO_TERMINAL: i32 = 25;
/// Error numbers of a port whose device is gone there (`EIO`, `ENXIO`, `ENODEV`).
const GONE: [i32; 3] = [5, 6, 19];

impl Advice {
    /// Advice for an error of opening or reading a port; `ports` are the existing ones.
    pub(super) fn of(error: &Error, path: &Path, ports: &[PathBuf]) -> Self {
        let path = path.display();
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
                format!("another program has {path} open"),
                vec![
                    "Close every other program that reads this port: a terminal, a serial monitor, another myointent.".to_owned(),
                    "If none is to be found, pull the board's USB cable and put it back.".to_owned(),
                ],
            ),
            ErrorKind::NotFound => (
                format!("there is no port {path}"),
                vec![
                    "Connect the board's USB cable: one that carries data, not power alone.".to_owned(),
                    existing(ports),
                ],
            ),
            ErrorKind::PermissionDenied => (
                format!("this user may not open {path}"),
                vec![
                    "Linux: run  sudo usermod -aG dialout $USER  (uucp in place of dialout on Arch) and log in again, or have udev give you the port.".to_owned(),
                    "macOS: name the port /dev/cu.usbmodem…, not /dev/tty…".to_owned(),
                ],
            ),
            _ if error.kind() == ErrorKind::UnexpectedEof || has_number(&GONE) => (
                format!("{path} is gone"),
                vec![
                    "Check the board's USB cable and its power.".to_owned(),
                    existing(ports),
                ],
            ),
            _ if has_number(&[NO_TERMINAL]) => {
                (format!("{path} is no serial port"), vec![existing(ports)])
            }
            _ => (
                error.to_string(),
                vec![
                    "Pull the board's USB cable and put it back.".to_owned(),
                    existing(ports),
                ],
            ),
        };
        Self { why, steps }
    }
}

/// Step that names the ports that exist.
fn existing(ports: &[PathBuf]) -> String {
    if ports.is_empty() {
        return "No serial port exists on this computer at the moment.".to_owned();
    }
    let names: Vec<_> = ports
        .iter()
        .map(|port| port.display().to_string())
        .collect();
    format!(
        "Ports that exist: {}. If one of them is the board, start again with  --port {}",
        names.join(", "),
        names[0]
    )
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
            assert!(advice.why.contains(why), "{advice:?}");
            assert!(advice.steps[0].contains(step), "{advice:?}");
        }
        let refused = advice(ErrorKind::PermissionDenied.into(), &[]);
        let expected = if cfg!(windows) {
            "another"
        } else {
            "may not open"
        };
        assert!(refused.why.contains(expected), "{refused:?}");
        let none = advice(Error::from_raw_os_error(NO_TERMINAL), &[]);
        assert!(
            cfg!(windows) || none.why.contains("no serial port"),
            "{none:?}"
        );
    }

    #[test]
    fn the_ports_that_exist_are_named() {
        let some = advice(ErrorKind::NotFound.into(), &["/dev/ttyACM1", "/dev/ttyS0"]);
        assert!(
            some.steps[1].contains("/dev/ttyACM1, /dev/ttyS0"),
            "{some:?}"
        );
        let none = advice(ErrorKind::NotFound.into(), &[]);
        assert!(none.steps[1].contains("No serial port"), "{none:?}");
    }
}
