//! Runs an image for some seconds and prints what its UART sends and what is refused.
//!
//! `run IMAGE.elf MODEL.intent SECONDS [SAMPLES.i8] [MILLISECONDS:COMMAND ...]`: the armband streams the samples, 8 signed
//! bytes each, and disconnects; commands are sent to the UART at their times.

use std::error::Error;

use nrf52::chip::ChipModel;
use nrf52::softdevice::{SoftDevice, SoftDeviceKind};
use nrf52::time::{HZ, ms};
use nrf52::{Image, Machine};
use shared::myo::{Address, binding};
use virtual_armband::{Armband, Behaviour, End};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [elf, file, seconds, rest @ ..] = &arguments[..] else {
        return Err(
            "run IMAGE.elf MODEL.intent SECONDS [SAMPLES.i8] [MILLISECONDS:COMMAND ...]".into(),
        );
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
    let bytes = match rest.first().filter(|path| !path.contains(':')) {
        Some(path) => std::fs::read(path)?,
        None => Vec::new(),
    };
    let (samples, _) = bytes.as_chunks::<8>();
    let samples = samples.iter().map(|bytes| bytes.map(u8::cast_signed));
    let address = Address::parse("FA:12:34:56:78:9A").map_err(|_| "no address")?;
    let behaviour = Behaviour {
        end: End::Disconnect,
        ..Behaviour::default()
    };
    let armband = Armband::new(address, -50, samples.collect()).of_wearer(behaviour, 0);
    let mut machine = Machine::new(model, image, kind.map(SoftDevice::new), 1);
    machine.air_mut().armbands = vec![armband];
    machine.survey = Some(Vec::new());
    {
        let mut chip = machine.chip();
        chip.bus.memory.program(0x5_8000, &std::fs::read(file)?);
        let record = binding::to_record(address);
        chip.bus.memory.program(0x5_7000, &record);
        for command in rest {
            if let Some((at, body)) = command.split_once(':') {
                let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
                let line = format!("${body}*{sum:02X}\r\n");
                chip.receive(ms(at.parse()?), line.bytes().map(|byte| (byte, false)));
            }
        }
    }
    let begun = std::time::Instant::now();
    let outcome = machine.run((seconds.parse::<f64>()? * HZ as f64) as u64);
    let took = begun.elapsed().as_secs_f64();
    let text: Vec<u8> = machine
        .chip()
        .sent()
        .iter()
        .map(|(_, byte)| *byte)
        .collect();
    println!("{}", String::from_utf8_lossy(&text));
    for refusal in machine.survey.iter().flatten() {
        println!("refused {refusal}");
    }
    if let Err(refusal) = outcome {
        println!("ended {refusal}");
    }
    for (at, incident) in &machine.incidents {
        println!("{:.3} ms {incident:?}", *at as f64 / ms(1) as f64);
    }
    let place = machine.core().place();
    println!(
        "{took:.2} s, {} instructions, at {}",
        machine.instructions,
        machine.image().place(place)
    );
    println!("overruns {}", machine.chip().overruns());
    Ok(())
}
