//! A board with an emulated chip that runs an image as it is flashed, and armbands beside it.

mod output;

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use nrf52::chip::{APPROTECT, ChipModel, PAGE, REGOUT0, RESET_PINS, Reset};
use nrf52::controller::Controller;
use nrf52::softdevice::{Flash, SoftDevice, SoftDeviceKind, boot};
use nrf52::time::ms;
use nrf52::{Image, Incident, Machine, Memory, Refusal};
use shared::myo::{Address, AddressKind, binding};
use shared::units::Sample;
use virtual_armband::{ADDRESS, Behaviour, End, Stranger, armbands, framed};
use xtask::firmware::{self, Compiling, Image as Built};
use xtask::toolchain;

/// The page of the bound armband, as in `memory.x`.
pub const BINDING: u32 = 0x5_7000;
/// Another armband than the one of the page.
pub const OTHER: Address = Address {
    kind: AddressKind::Public,
    bytes: [0xab, 0x89, 0x67, 0x45, 0x23, 0xf1],
};
/// The model's region, as in `memory.x`.
pub const MODEL: u32 = 0x5_8000;
/// Address at which a boot loader starts the program.
const PROGRAM: u32 = 0x1000;
/// RAM that Adafruit's boot loader uses: words that it keeps, its variables and its stack (linker/nrf52840.ld of
/// Adafruit_nRF52_Bootloader).
pub const BOOT_LOADER_RAM: std::ops::Range<u32> = 0x2000_7f7c..0x2004_0000;

/// Pins of a board by their names on it, as its maker's documents have them: the second port's follow at 32.
#[derive(Clone, Copy, Debug)]
pub struct ChipPins {
    /// One for each intent, in class order.
    pub intents: [u32; 6],
    /// `valid`.
    pub valid: u32,
    /// Pulses of the strength.
    pub strength: u32,
    /// LEDs: the label is valid; an armband streams; what an alignment does.
    pub leds: [u32; 3],
    /// Level that lights them.
    pub led_on: bool,
    pub button: u32,
    /// The UART: sends, receives.
    pub uart: [u32; 2],
    /// A pin that is low for good.
    pub low: Option<u32>,
    pub reset: u32,
}

impl ChipPins {
    const NRF52840: Self = Self {
        intents: [33, 34, 35, 36, 37, 38],
        valid: 39,
        strength: 40,
        leds: [13, 14, 15],
        led_on: false,
        button: 11,
        uart: [6, 8],
        low: None,
        reset: 18,
    };
    const NRF52832: Self = Self {
        intents: [11, 12, 22, 23, 24, 25],
        valid: 26,
        strength: 27,
        leds: [17, 18, 19],
        led_on: false,
        button: 13,
        uart: [6, 8],
        low: None,
        reset: 21,
    };
    /// D0 to D5, D8, D9; green, blue, red; D10; D6, D7; the lower end of the battery's divider.
    const XIAO: Self = Self {
        intents: [2, 3, 28, 29, 4, 5],
        valid: 45,
        strength: 46,
        leds: [30, 6, 26],
        led_on: false,
        button: 47,
        uart: [43, 44],
        low: Some(14),
        reset: 18,
    };
    /// A0 to A5, D5, D9; red, blue, D6; the user switch; TX, RX.
    const FEATHER: Self = Self {
        intents: [4, 5, 30, 28, 2, 3],
        valid: 40,
        strength: 26,
        leds: [47, 42, 7],
        led_on: true,
        button: 34,
        uart: [25, 24],
        low: None,
        reset: 18,
    };
    /// 017, 020, 022, 024, 100, 011, 104, 111; the board's LED, 106, 115; 113; 006, 008.
    const NICE_NANO: Self = Self {
        intents: [17, 20, 22, 24, 32, 11],
        valid: 36,
        strength: 43,
        leds: [15, 38, 47],
        led_on: true,
        button: 45,
        uart: [6, 8],
        low: None,
        reset: 18,
    };
}

/// An image; if it cannot be built here, reports the test as skipped.
///
/// # Panics
/// If the image does not build: that is no reason to skip.
pub fn image(image: Built) -> Option<Image> {
    static PARSED: Mutex<BTreeMap<&str, Image>> = Mutex::new(BTreeMap::new());
    let elf = elf(image)?;
    let mut parsed = PARSED.lock().unwrap_or_else(PoisonError::into_inner);
    let parsed = parsed
        .entry(image.name())
        .or_insert_with(|| Image::parse(&elf).expect("an image"));
    Some(parsed.clone())
}

/// The ELF file of an image; if it cannot be built here, reports the test as skipped.
///
/// # Panics
/// If the image does not build: that is no reason to skip.
pub fn elf(image: Built) -> Option<Vec<u8>> {
    static BUILT: Mutex<BTreeMap<&str, Vec<u8>>> = Mutex::new(BTreeMap::new());
    let found = toolchain::find(toolchain::TARGET, false);
    let toolchain = found
        .map_err(|reason| crate::skip(&format!("{reason:#}")))
        .ok()?;
    let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    let elf = built.entry(image.name()).or_insert_with(|| {
        let file = firmware::build_image(&toolchain, image, Compiling::default());
        let file = file.unwrap_or_else(|error| panic!("the image {image}: {error:#}"));
        std::fs::read(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
    });
    Some(elf.clone())
}

/// The model that the README flashes.
pub fn model() -> Vec<u8> {
    crate::model_file("three-class")
}

/// Contents and surroundings of a board.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The model's flash region from its start.
    pub model: Vec<u8>,
    /// The page of the bound armband from its start.
    pub page: Vec<u8>,
    pub samples: Vec<Sample>,
    pub behaviour: Behaviour,
    /// Another armband.
    pub stranger: Option<Stranger>,
    /// True if UICR was never written.
    pub is_blank: bool,
}

impl Default for Setting {
    /// The README's model, bound to an armband that disconnects after its last sample.
    fn default() -> Self {
        Self {
            model: model(),
            page: binding::to_record(ADDRESS).to_vec(),
            samples: Vec::new(),
            behaviour: Behaviour {
                end: End::Disconnect,
                ..Behaviour::default()
            },
            stranger: None,
            is_blank: false,
        }
    }
}

impl Setting {
    /// Returns the setting of this model and an armband that streams these samples.
    pub fn of(model: Vec<u8>, samples: Vec<Sample>) -> Self {
        Self {
            model,
            samples,
            ..Self::default()
        }
    }
}

#[derive(Debug)]
pub struct Board {
    pub machine: Machine,
    pub pins: ChipPins,
}

impl Board {
    /// A board with this image; if it cannot be built here, reports the test as skipped.
    ///
    /// # Panics
    /// Where [`image`] does.
    pub fn of(built: Built, setting: Setting) -> Option<Self> {
        Some(Self::new(built, image(built)?, setting))
    }

    /// A board with this image, whose power has just come. One with USB has its boot loader, which starts the program: the vectors
    /// at 0 are not the program's, and none but reset's leads anywhere; and a full battery.
    pub fn new(built: Built, image: Image, setting: Setting) -> Self {
        let (model, pins, kind) = match built {
            Built::Nrf52840S140 => (
                ChipModel::Nrf52840,
                ChipPins::NRF52840,
                Some(SoftDeviceKind::S140),
            ),
            Built::Nrf52832S132 => (
                ChipModel::Nrf52832,
                ChipPins::NRF52832,
                Some(SoftDeviceKind::S132),
            ),
            Built::Xiao => (ChipModel::Nrf52840, ChipPins::XIAO, None),
            Built::Feather => (ChipModel::Nrf52840, ChipPins::FEATHER, None),
            Built::NiceNano => (ChipModel::Nrf52840, ChipPins::NICE_NANO, None),
            Built::Nrf52840Sdc => (ChipModel::Nrf52840, ChipPins::NRF52840, None),
        };
        let softdevice = kind.map(SoftDevice::new);
        let mut machine = Machine::new(model, image, softdevice, 0x6d79_6f21);
        machine.air_mut().armbands =
            armbands(setting.behaviour, setting.stranger, setting.samples, 0);
        {
            let mut chip = machine.chip();
            chip.bus.memory.program(MODEL, &setting.model);
            chip.bus.memory.program(BINDING, &setting.page);
            // The battery is at VDDH; the boot loader sets 3.3 V.
            chip.bus.board.is_high_voltage = built == Built::NiceNano;
            if !setting.is_blank {
                for word in RESET_PINS {
                    chip.program_uicr(word, pins.reset);
                }
                chip.program_uicr(APPROTECT, 0x5a);
                chip.program_uicr(REGOUT0, !7 | 5);
            }
        }
        if Built::UF2.contains(&built) {
            let mut chip = machine.chip();
            boot::install_reset(&chip.bus.memory, PROGRAM);
            // AIN5, AIN7 and the chip's own divider of its supply.
            for (input, millivolts) in [(6, 2050), (8, 1385), (13, 820)] {
                chip.set_input(input, millivolts);
            }
            drop(chip);
            machine.boot_loader_ram = Some(BOOT_LOADER_RAM);
            machine.reset(Reset::Power);
        }
        Self { machine, pins }
    }

    /// Flash and RAM.
    pub fn memory(&self) -> Memory {
        self.machine.chip().bus.memory.clone()
    }

    /// The SoftDevice's operations of flash.
    ///
    /// # Panics
    /// If the image has no SoftDevice.
    pub fn flash(&mut self) -> &mut Flash {
        let softdevice = self.machine.softdevice.as_mut();
        &mut softdevice.expect("an image with one").flash
    }

    /// The controller of an image without a SoftDevice.
    ///
    /// # Panics
    /// If the image has a SoftDevice.
    pub fn controller(&mut self) -> &mut Controller {
        let controller = self.machine.controller.as_mut();
        controller.expect("an image with one")
    }

    /// Returns the number of notifications that the wearer's armband has sent.
    pub fn sent(&self) -> usize {
        self.machine.air().armbands[0].sent()
    }

    /// Returns the armband in the page of the bound one.
    pub fn bound(&self) -> Option<Address> {
        let page = self.memory().read(BINDING, PAGE);
        binding::from_record(page.as_deref().and_then(<[u8]>::first_chunk)?)
    }

    pub fn text(&self) -> String {
        self.text_from(0)
    }

    /// Returns the text that the UART has sent after its first `bytes` bytes.
    pub fn text_from(&self, bytes: usize) -> String {
        let chip = self.machine.chip();
        let sent = chip.sent().get(bytes..).unwrap_or_default();
        let bytes: Vec<u8> = sent.iter().map(|(_, byte)| *byte).collect();
        String::from_utf8_lossy(&bytes).into_owned()
    }

    pub fn sent_bytes(&self) -> usize {
        self.machine.chip().sent().len()
    }

    /// Complete lines of labels, states and alignments, line ends included.
    pub fn lines(&self) -> Vec<String> {
        let text = self.text();
        let lines = text.split_inclusive('\n');
        let numbered =
            lines.filter(|line| line.ends_with('\n') && crate::output::is_numbered(line));
        numbered.map(str::to_owned).collect()
    }

    /// Sends a line to the UART; frame and checksum are added.
    pub fn send(&mut self, body: &str) {
        self.send_bytes(framed(body).bytes());
    }

    pub fn send_bytes(&mut self, bytes: impl IntoIterator<Item = u8>) {
        let now = self.machine.now();
        let bytes = bytes.into_iter().map(|byte| (byte, false));
        self.machine.chip().receive(now, bytes);
    }

    pub fn set_button(&mut self, is_down: bool) {
        let button = self.pins.button;
        self.machine.chip().drive(button, is_down.then_some(false));
    }

    pub fn run_ms(&mut self, count: u64) -> Result<(), Refusal> {
        self.machine.run(ms(count))
    }

    /// Sends a command and runs until an answer that begins so.
    pub fn ask(&mut self, command: &str, answer: &str) -> anyhow::Result<()> {
        let from = self.sent_bytes();
        self.send(command);
        self.wait_from(from, answer, 2000)
    }

    /// Runs until the UART has sent the text, at most the milliseconds given.
    pub fn wait_for(&mut self, text: &str, at_most_ms: u64) -> anyhow::Result<()> {
        self.wait_from(0, text, at_most_ms)
    }

    /// Runs until the UART has sent the text after its first `looked` bytes.
    pub fn wait_from(
        &mut self,
        mut looked: usize,
        text: &str,
        at_most_ms: u64,
    ) -> anyhow::Result<()> {
        self.until(&format!("{text:?}"), at_most_ms, ms(5), |board| {
            let said = board.text_from(looked);
            // It may have begun.
            looked = board.sent_bytes().saturating_sub(text.len());
            said.contains(text)
        })
    }

    /// Runs until something is so, looking every `ticks`; fails with what it waited for after the milliseconds given.
    pub fn until(
        &mut self,
        what: &str,
        at_most_ms: u64,
        ticks: u64,
        mut is_so: impl FnMut(&mut Self) -> bool,
    ) -> anyhow::Result<()> {
        let end = self.machine.now() + ms(at_most_ms);
        while !is_so(self) {
            let in_time = self.machine.now() < end;
            anyhow::ensure!(
                in_time,
                "no {what} within {at_most_ms} ms:\n{}",
                self.text()
            );
            self.machine.run(ticks)?;
        }
        Ok(())
    }

    /// Runs until the label is valid.
    pub fn until_valid(&mut self) -> anyhow::Result<()> {
        self.until("valid label", 10_000, ms(50), |board| board.is_valid())
    }

    /// Returns true if the pin of a valid label is high.
    pub fn is_valid(&self) -> bool {
        self.machine.chip().level(self.pins.valid) == Some(true)
    }

    /// Reasons of the program's starts, in order.
    pub fn starts(&self) -> Vec<Reset> {
        let incidents = self.machine.incidents.iter();
        let started = incidents.filter_map(|(_, incident)| match incident {
            Incident::Started(why) => Some(*why),
            Incident::HardFault(_) => None,
        });
        started.collect()
    }
}
