//! The emulated board: QEMU's `mps2-an386`, a Cortex-M4F.

use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::ensure;
use xtask::qemu::QEMU;

use super::process::KillOnDrop;
use crate::output::{LEVELS, LINES};

/// Bytes of the model's flash region, as in `memory.x`.
pub const MODEL_REGION: usize = 160 * 1024;
const MODEL_ADDRESS: u32 = 0x5_8000;
/// A word by which the guest's clock runs slower.
const TIME_SCALE_ADDRESS: u32 = 0x8_0000;
const ERASED: u8 = 0xff;

/// Named pipes in the folder of the run, from which UART0 and UART2 receive.
const COMMANDS: &str = "uart0.in";
const BUTTON: &str = "uart2.in";
/// The socket of the emulator's own protocol, QMP.
const MONITOR: &str = "qmp";
/// The names that QEMU derives both files of a UART from.
const UART0: &str = "uart0";
const UART2: &str = "uart2";
/// The page of the bound armband, as in `memory.x`.
const BINDING_ADDRESS: u32 = 0x5_7000;

/// A running board.
pub struct Machine {
    /// The emulator.
    pub process: KillOnDrop,
    /// The socket that it takes orders on.
    monitor: PathBuf,
    button: File,
    commands: File,
}

impl Machine {
    /// Starts it; `hci` is the socket of a controller that listens already.
    ///
    /// A `page` or a `model` that is given is restored by every reset; without one it is empty, and a reset keeps what the
    /// program wrote.
    pub fn start(
        folder: &Path,
        image: &Path,
        model: Option<&[u8]>,
        page: Option<&[u8]>,
        time_scale: u32,
        hci: Option<&Path>,
    ) -> anyhow::Result<Self> {
        let mut qemu = Command::new(QEMU);
        qemu.args(["-M", "mps2-an386", "-display", "none", "-monitor", "none"]);
        let monitor = folder.join(MONITOR);
        let socket = monitor.display();
        qemu.args(["-qmp", &format!("unix:{socket},server=on,wait=off")]);
        qemu.arg("-kernel").arg(image);
        let commands = named_pipe(&folder.join(COMMANDS))?;
        let labels = folder.join(LINES);
        // A test may have made a named pipe of it.
        if !labels.exists() {
            File::create(labels)?;
        }
        let uart0 = folder.join(UART0);
        qemu.args([
            "-chardev",
            &format!("pipe,id=labels,path={}", uart0.display()),
        ]);
        qemu.args(["-serial", "chardev:labels"]);
        match hci {
            Some(socket) => {
                let socket = socket.display();
                qemu.args(["-chardev", &format!("socket,id=hci,path={socket}")]);
                qemu.args(["-serial", "chardev:hci"]);
            }
            None => {
                qemu.args(["-serial", "null"]);
            }
        }
        let button = named_pipe(&folder.join(BUTTON))?;
        File::create(folder.join(LEVELS))?;
        let uart2 = folder.join(UART2);
        qemu.args([
            "-chardev",
            &format!("pipe,id=pins,path={}", uart2.display()),
        ]);
        qemu.args(["-serial", "chardev:pins"]);
        if let Some(model) = model {
            ensure!(
                model.len() <= MODEL_REGION,
                "a model of {} bytes, the region has {MODEL_REGION}",
                model.len()
            );
            let mut region = vec![ERASED; MODEL_REGION];
            region[..model.len()].copy_from_slice(model);
            let region_file = folder.join("model-region");
            std::fs::write(&region_file, region)?;
            let region = region_file.display();
            let loaded = format!("loader,file={region},addr={MODEL_ADDRESS:#x},force-raw=on");
            qemu.args(["-device", &loaded]);
        }
        if let Some(page) = page {
            let page_file = folder.join("binding-page");
            std::fs::write(&page_file, page)?;
            let page = page_file.display();
            let loaded = format!("loader,file={page},addr={BINDING_ADDRESS:#x},force-raw=on");
            qemu.args(["-device", &loaded]);
        }
        let scale = format!("loader,addr={TIME_SCALE_ADDRESS:#x},data={time_scale},data-len=4");
        qemu.args(["-device", &scale]);
        let process = KillOnDrop::start("machine", qemu, folder)?;
        Ok(Self {
            process,
            monitor,
            button,
            commands,
        })
    }

    /// Resets the board, in the middle of whatever it does.
    ///
    /// # Errors
    /// When the emulator does not take the order.
    #[cfg(unix)]
    pub fn reset(&self) -> anyhow::Result<()> {
        use std::io::{BufRead as _, BufReader};
        use std::os::unix::net::UnixStream;

        let mut socket = UnixStream::connect(&self.monitor)?;
        let mut answers = BufReader::new(socket.try_clone()?).lines();
        for order in ["qmp_capabilities", "system_reset"] {
            writeln!(socket, "{{\"execute\": \"{order}\"}}")?;
            // A greeting and news of events come between.
            let is_done = |line: &std::io::Result<String>| {
                line.as_ref().is_ok_and(|line| line.contains("\"return\""))
            };
            ensure!(
                answers.by_ref().any(|line| is_done(&line)),
                "no answer to {order}"
            );
        }
        Ok(())
    }

    /// Sends bytes to the UART that takes commands; waits while the board takes none.
    ///
    /// # Errors
    /// When the pipe cannot be written.
    pub fn send(&mut self, bytes: &[u8]) -> anyhow::Result<()> {
        self.commands.write_all(bytes)?;
        Ok(())
    }

    /// Presses the button, or releases it: writes the level of its pin.
    ///
    /// # Errors
    /// When the pipe cannot be written.
    pub fn set_button(&mut self, is_down: bool) -> anyhow::Result<()> {
        self.button.write_all(if is_down { b"0" } else { b"1" })?;
        Ok(())
    }
}

pub fn named_pipe(path: &Path) -> anyhow::Result<File> {
    let made = Command::new("mkfifo").arg(path).status()?;
    ensure!(made.success(), "no named pipe {}: {made}", path.display());
    // For reading too: opening waits for nobody, and the machine never reads its end.
    Ok(File::options().read(true).write(true).open(path)?)
}
