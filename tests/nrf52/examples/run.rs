//! Runs an image with a model for some seconds beside an armband, and prints what its UART sends: `run IMAGE.elf
//! MODEL.intent SECONDS`.

use std::error::Error;

use nrf52::chip::ChipModel;
use nrf52::softdevice::{SoftDevice, SoftDeviceKind};
use nrf52::time::{HZ, ms};
use nrf52::{Image, Machine};
use shared::myo::binding;
use virtual_armband::{ADDRESS, Behaviour, armbands};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [elf, file, seconds] = &arguments[..] else {
        return Err("run IMAGE.elf MODEL.intent SECONDS".into());
    };
    let image = Image::parse(&std::fs::read(elf)?)?;
    // By the place at which it begins.
    let kinds = [SoftDeviceKind::S140, SoftDeviceKind::S132];
    let kind = kinds
        .into_iter()
        .find(|kind| kind.program() == image.start());
    let model = match kind {
        Some(SoftDeviceKind::S132) => ChipModel::Nrf52832,
        _ => ChipModel::Nrf52840,
    };
    let seconds: f64 = seconds.parse()?;
    let samples = vec![[1; 8]; (seconds * 200.0) as usize];
    let mut machine = Machine::new(model, image, kind.map(SoftDevice::new), 1);
    machine.air_mut().armbands = armbands(Behaviour::default(), None, samples, 0);
    let memory = machine.chip().bus.memory.clone();
    memory.program(0x5_8000, &std::fs::read(file)?);
    memory.program(0x5_7000, &binding::to_record(ADDRESS));
    let outcome = machine.run((seconds * HZ as f64) as u64);
    let text: Vec<u8> = machine
        .chip()
        .sent()
        .iter()
        .map(|(_, byte)| *byte)
        .collect();
    println!("{}", String::from_utf8_lossy(&text));
    for (at, incident) in &machine.incidents {
        println!("{:.3} ms {incident:?}", *at as f64 / ms(1) as f64);
    }
    Ok(outcome?)
}
