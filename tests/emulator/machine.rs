//! The emulated board: QEMU's `mps2-an386`, a Cortex-M4F.

use std::path::Path;
use std::process::Command;

use anyhow::ensure;
use xtask::emulator::QEMU;

use super::process::Guarded;

/// Bytes of flash that the model has.
pub const MODEL_REGION: usize = 160 * 1024;
const MODEL_ADDRESS: u32 = 0x5_8000;
/// A word that slows the guest's clock down.
const STRAPS_ADDRESS: u32 = 0x8_0000;
const ERASED: u8 = 0xff;

/// What the board writes: UART0 and UART2, as files of the run's folder.
pub const LABELS: &str = "uart0";
/// See [`LABELS`].
pub const PINS: &str = "uart2";

/// A running board.
pub struct Machine(pub Guarded);

impl Machine {
    /// Starts it; `hci` is the socket of a controller that already listens.
    pub fn start(
        folder: &Path,
        image: &Path,
        model: &[u8],
        time_scale: u32,
        hci: Option<&Path>,
    ) -> anyhow::Result<Self> {
        ensure!(
            model.len() <= MODEL_REGION,
            "a model of {} bytes, the region has {MODEL_REGION}",
            model.len()
        );
        let mut region = vec![ERASED; MODEL_REGION];
        region[..model.len()].copy_from_slice(model);
        let region_file = folder.join("model-region");
        std::fs::write(&region_file, region)?;

        let file = |name: &str| format!("file:{}", folder.join(name).display());
        let mut qemu = Command::new(QEMU);
        qemu.args(["-M", "mps2-an386", "-display", "none", "-monitor", "none"]);
        qemu.arg("-kernel").arg(image);
        qemu.args(["-serial", &file(LABELS)]);
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
        qemu.args(["-serial", &file(PINS)]);
        let region = region_file.display();
        let loaded = format!("loader,file={region},addr={MODEL_ADDRESS:#x},force-raw=on");
        let straps = format!("loader,addr={STRAPS_ADDRESS:#x},data={time_scale},data-len=4");
        qemu.args(["-device", &loaded, "-device", &straps]);
        Guarded::start("machine", qemu, folder).map(Self)
    }
}
