//! Serial ports of boards with USB, told by the numbers of their devices. No port is opened for it: some boards restart when
//! theirs is, and a port of Bluetooth blocks.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use shared::uart_line::USB_NUMBERS;

/// Ports of boards that run this firmware; none where the system does not say.
pub(super) fn ports() -> Vec<PathBuf> {
    let mut ports = if cfg!(windows) {
        let devices = r"HKLM\SYSTEM\CurrentControlSet\Enum\USB";
        let mut ports = of_registry(&said("reg", &["query", devices, "/s", "/v", "PortName"]));
        // The registry also has what is unplugged.
        let present = serial2::SerialPort::available_ports().unwrap_or_default();
        ports.retain(|port| present.contains(port));
        ports
    } else if cfg!(target_os = "macos") {
        let devices = ["-r", "-c", "IOUSBHostDevice", "-l", "-w", "0"];
        of_ioreg(&said("/usr/sbin/ioreg", &devices))
    } else {
        of_sysfs(Path::new("/sys/class/tty"))
    };
    ports.sort_unstable();
    // A device behind a hub is listed with the hub, too.
    ports.dedup();
    ports
}

/// Output of one of the system's programs; empty if it cannot be run.
fn said(program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).output();
    output.map_or_else(
        |_| String::new(),
        |output| String::from_utf8_lossy(&output.stdout).into_owned(),
    )
}

/// Ports in Linux's list of terminals, whose links lead to their devices.
fn of_sysfs(terminals: &Path) -> Vec<PathBuf> {
    let number = |path: PathBuf| {
        let text = fs::read_to_string(path).ok()?;
        u16::from_str_radix(text.trim(), 16).ok()
    };
    let is_board = |entry: &fs::DirEntry| {
        let interface = fs::canonicalize(entry.path().join("device")).unwrap_or_default();
        let numbers = interface.ancestors().find_map(|device| {
            let vendor = number(device.join("idVendor"))?;
            Some([vendor, number(device.join("idProduct"))?])
        });
        numbers == Some(USB_NUMBERS)
    };
    let entries = fs::read_dir(terminals).into_iter().flatten().flatten();
    let boards = entries.filter(is_board);
    boards
        .map(|entry| Path::new("/dev").join(entry.file_name()))
        .collect()
}

/// Ports in the output of macOS's `ioreg`: below the numbers of their device.
fn of_ioreg(devices: &str) -> Vec<PathBuf> {
    let mut numbers = [None; 2];
    let mut ports = Vec::new();
    for line in devices.lines() {
        let Some((name, value)) = line.split_once(" = ") else {
            continue;
        };
        let value = value.trim();
        match name.trim_start_matches([' ', '|']) {
            r#""idVendor""# => numbers[0] = value.parse().ok(),
            r#""idProduct""# => numbers[1] = value.parse().ok(),
            r#""IOCalloutDevice""# if numbers == USB_NUMBERS.map(Some) => {
                ports.push(value.trim_matches('"').into());
            }
            _ => {}
        }
    }
    ports
}

/// Ports in the output of Windows's `reg query`: below the key of their device.
fn of_registry(devices: &str) -> Vec<PathBuf> {
    let [vendor, product] = USB_NUMBERS;
    let board = format!("VID_{vendor:04X}&PID_{product:04X}");
    let mut is_board = false;
    let mut ports = Vec::new();
    for line in devices.lines() {
        let mut fields = line.split_whitespace();
        if line.starts_with("HKEY_") {
            is_board = line.to_ascii_uppercase().contains(&board);
        } else if is_board && fields.next() == Some("PortName") {
            ports.extend(fields.nth(1).map(PathBuf::from));
        }
    }
    ports
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn linux_names_the_port_of_a_board_and_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let [devices, terminals] = ["devices", "class"].map(|name| folder.path().join(name));
        fs::create_dir(&terminals).unwrap();
        // A board behind a hub with a board's numbers; an Arduino behind a board's hub; the same vendor; Bluetooth; the UART.
        for (name, device, numbers) in [
            ("ttyACM0", "usb1/1-1/1-1.2", Some(["1209\n", "0001\n"])),
            (
                "ttyACM1",
                "usb1/1-1/1-1.2/1-1.2.1",
                Some(["2341\n", "0043\n"]),
            ),
            ("ttyACM2", "usb1/1-3", Some(["1209\n", "0064\n"])),
            ("ttyACM3", "usb2/2-1", Some(["239a\n", "8029\n"])),
            ("rfcomm0", "bluetooth/hci0", None),
            ("ttyS0", "platform/serial8250", None),
        ] {
            let device = devices.join(device);
            let interface = device.join("interface:1.0");
            let terminal = interface.join("tty").join(name);
            fs::create_dir_all(&terminal).unwrap();
            for (file, number) in ["idVendor", "idProduct"]
                .iter()
                .zip(numbers.iter().flatten())
            {
                fs::write(device.join(file), number).unwrap();
            }
            std::os::unix::fs::symlink(&interface, terminal.join("device")).unwrap();
            std::os::unix::fs::symlink(&terminal, terminals.join(name)).unwrap();
        }
        // A terminal without a device.
        fs::create_dir(terminals.join("tty1")).unwrap();
        assert_eq!(of_sysfs(&terminals), [PathBuf::from("/dev/ttyACM0")]);
        assert_eq!(
            of_sysfs(&folder.path().join("none")),
            [""; 0].map(PathBuf::from)
        );
    }

    #[test]
    fn macos_names_the_port_of_a_board_and_no_other() {
        let said = r#"
+-o myointent@14100000  <class IOUSBHostDevice, id 0x100000a2b, registered, matched, active, busy 0 (12 ms), retain 30>
  | {
  |   "idProduct" = 1
  |   "USB Product Name" = "myointent"
  |   "idVendor" = 4617
  | }
  +-o AppleUSBACMData  <class AppleUSBACMData, id 0x100000a3c, registered, matched, active, busy 0 (5 ms), retain 8>
      | {
      |   "idVendor" = 4617
      |   "IOTTYDevice" = "usbmodem14101"
      |   "IOCalloutDevice" = "/dev/cu.usbmodem14101"
      |   "IODialinDevice" = "/dev/tty.usbmodem14101"
      | }
+-o Arduino Uno@14200000  <class IOUSBHostDevice, id 0x100000b11, registered, matched, active, busy 0 (9 ms), retain 28>
  | {
  |   "idProduct" = 67
  |   "idVendor" = 9025
  | }
      |   "IOCalloutDevice" = "/dev/cu.usbmodem14201"
"#;
        assert_eq!(of_ioreg(said), [PathBuf::from("/dev/cu.usbmodem14101")]);
    }

    #[test]
    fn windows_names_the_port_of_a_board_and_no_other() {
        let said = "\r\n\
            HKEY_LOCAL_MACHINE\\SYSTEM\\CurrentControlSet\\Enum\\USB\\VID_1209&PID_0001&MI_00\\6&1a2b&0&0000\\Device Parameters\r\n    \
            PortName    REG_SZ    COM12\r\n\r\n\
            HKEY_LOCAL_MACHINE\\SYSTEM\\CurrentControlSet\\Enum\\USB\\VID_2341&PID_0043\\5573\\Device Parameters\r\n    \
            PortName    REG_SZ    COM3\r\n\r\n\
            HKEY_LOCAL_MACHINE\\SYSTEM\\CurrentControlSet\\Enum\\USB\\Vid_1209&Pid_0001\\01\\Device Parameters\r\n    \
            PortName    REG_SZ    COM4\r\n\r\n\
            End of search: 3 match(es) found.\r\n";
        assert_eq!(of_registry(said), ["COM12", "COM4"].map(PathBuf::from));
    }
}
