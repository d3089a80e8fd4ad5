//! Refusals of the chip, each with a program that earns it: the lines of `programs.txt`.

use std::collections::BTreeMap;

use nrf52::chip::{Chip, ChipModel, Surroundings};
use nrf52::softdevice::{SoftDevice, SoftDeviceKind};
use nrf52::time::{ms, us};
use nrf52::{Image, Machine, What};

const UICR: u32 = 0x1000_1000;
/// Offset of the program's own words from its start, in bytes. Its instructions end before.
const WORDS: u32 = 0x400;
/// A clock configuration for a SoftDevice: the crystal, 20 ppm.
const CLOCK: u32 = 0x0700_0001;

/// Names of registers, and of the steps that lines share.
struct Names {
    model: ChipModel,
    kind: Option<SoftDeviceKind>,
    registers: BTreeMap<String, u32>,
    steps: BTreeMap<String, String>,
}

impl Names {
    fn new(model: ChipModel, kind: Option<SoftDeviceKind>) -> Self {
        let mut chip = Chip::new(model, 1);
        let peripherals = (0..0x30).map(|number| 0x4000_0000 | number << 12);
        let pages = peripherals.chain([UICR, 0x5000_0000]);
        let addresses = pages.flat_map(|page| (page..page + 0x1000).step_by(4));
        Self {
            model,
            kind,
            registers: addresses.map(|one| (chip.name_of(one), one)).collect(),
            steps: BTreeMap::new(),
        }
    }

    /// A number, in decimal or hex, or the address of a register.
    fn value(&self, text: &str) -> u32 {
        let number = match text.strip_prefix("0x") {
            Some(digits) => u32::from_str_radix(digits, 16).ok(),
            None => text.parse().ok(),
        };
        let number = number.or_else(|| self.registers.get(text).copied());
        number.unwrap_or_else(|| panic!("{text} is neither a number nor a register"))
    }

    /// The chip that runs these steps: they end in a loop, and so does every exception.
    fn machine(&self, steps: &str) -> Machine {
        let mut program = Program::default();
        let start = self.kind.map_or(0, SoftDeviceKind::program);
        if self.kind.is_some() {
            program.call(&[16, start + WORDS, 0x1, 0]);
        }
        self.add(steps, &mut program);
        let mut image = Vec::new();
        let mut word = |value: u32| image.extend(value.to_le_bytes());
        word(0x2000_8000);
        word(start + 0x101);
        // An exception that is not meant ends in the loop at 0x200.
        (2..64).for_each(|_| word(start + 0x201));
        // b to itself.
        let code = program.code.into_iter().chain([0xe7fe]);
        image.extend(code.flat_map(u16::to_le_bytes));
        assert!(image.len() <= 0x200, "the program is too long");
        image.resize(0x200, 0);
        image.extend(0xe7fe_u16.to_le_bytes());
        image.resize(WORDS as usize, 0xff);
        image.extend(CLOCK.to_le_bytes());
        let softdevice = self.kind.map(SoftDevice::new);
        let machine = Machine::new(self.model, Image::raw(start, image), softdevice, 1);
        let mut chip = machine.chip();
        chip.bus.board = program.board;
        for (address, value) in program.programmed {
            chip.program_uicr(address - UICR, value);
        }
        drop(chip);
        machine
    }

    fn add(&self, steps: &str, program: &mut Program) {
        for step in steps.split_whitespace() {
            let numbers = |text: &str| text.split(',').map(|one| self.value(one)).collect();
            if let Some(name) = step.strip_prefix('@') {
                self.add(&self.steps[name], program);
            } else if step == "+vddh" {
                program.board.is_high_voltage = true;
            } else if step == "+inductor" {
                program.board.inductors[0] = true;
            } else if let Some(numbers_of_call) = step.strip_prefix("call:") {
                let call: Vec<u32> = numbers(numbers_of_call);
                program.call(&call);
            } else if let Some(turns) = step.strip_prefix("wait:") {
                program.load(3, self.value(turns));
                // subs r3, #1; bne: four cycles a turn.
                program.code.extend([0x3b01, 0xd1fd]);
            } else if let Some(code) = step.strip_prefix("code:") {
                let halves = code.split(',').map(|half| u16::from_str_radix(half, 16));
                program.code.extend(halves.map(|half| half.expect(step)));
            } else if let Some(register) = step.strip_suffix('?') {
                program.access([self.value(register), 0], 0x6802);
            } else {
                let (register, value) = step.split_once('=').expect(step);
                let value = self.value(value);
                if let Some(word) = register.strip_prefix('+') {
                    program.programmed.push((self.value(word), value));
                } else if let Some(byte) = register.strip_suffix(':') {
                    program.access([self.value(byte), value], 0x7001);
                } else {
                    program.access([self.value(register), value], 0x6001);
                }
            }
        }
    }
}

/// A program in Thumb instructions, and what was done before it runs.
#[derive(Default)]
struct Program {
    code: Vec<u16>,
    board: Surroundings,
    /// Words of UICR.
    programmed: Vec<(u32, u32)>,
}

impl Program {
    /// Loads a constant: `movw`, `movt`.
    fn load(&mut self, register: u16, value: u32) {
        for (half, base) in [(value as u16, 0xf240), ((value >> 16) as u16, 0xf2c0)] {
            let (imm4, i) = (half >> 12, half >> 11 & 1);
            let (imm3, imm8) = (half >> 8 & 7, half & 0xff);
            self.code.push(base | i << 10 | imm4);
            self.code.push(imm3 << 12 | register << 8 | imm8);
        }
    }

    /// Runs an instruction with an address and a value in the first two registers.
    fn access(&mut self, registers: [u32; 2], instruction: u16) {
        self.load(0, registers[0]);
        self.load(1, registers[1]);
        self.code.push(instruction);
    }

    /// Calls the SoftDevice, by number and arguments.
    fn call(&mut self, call: &[u32]) {
        for (register, argument) in (0..).zip(&call[1..]) {
            self.load(register, *argument);
        }
        self.code.push(0xdf00 | call[0] as u16);
    }
}

#[test]
fn each_program_is_refused_in_its_words_or_runs() {
    let mut names = Names::new(ChipModel::Nrf52840, None);
    let (mut refused, mut ran) = (0, 0);
    let lines = include_str!("programs.txt").lines().zip(1..);
    // The head describes the lines.
    for (line, number) in lines.skip_while(|(line, _)| !line.starts_with('[')) {
        if line.starts_with('[') {
            let model = if line.contains("52840") {
                ChipModel::Nrf52840
            } else {
                ChipModel::Nrf52832
            };
            let kind = line.contains("S140").then_some(SoftDeviceKind::S140);
            names = Names::new(model, kind);
        } else if let Some((name, steps)) = line
            .strip_prefix("let ")
            .and_then(|line| line.split_once(" = "))
        {
            names.steps.insert(name.to_owned(), steps.to_owned());
        } else if let Some((steps, words)) = line.split_once("->") {
            let words = words.trim();
            let found = names.machine(steps).run(ms(10)).err();
            let found = found.map(|refusal| refusal.to_string());
            let is_expected = match &found {
                Some(found) => !words.is_empty() && found.contains(words),
                None => words.is_empty(),
            };
            assert!(is_expected, "{number}: {line}: {found:?}");
            *(if words.is_empty() {
                &mut ran
            } else {
                &mut refused
            }) += 1;
        }
    }
    assert_eq!((refused, ran), (122, 23));
}

#[test]
fn a_core_that_locks_up() {
    // bx to address 0x20, without the bit for Thumb; its fault's handler is broken too.
    let mut machine = Names::new(ChipModel::Nrf52840, None).machine("code:2020,4700");
    machine.chip().bus.memory.clear_bits(12, &[0; 4]);
    let refusal = machine.run(ms(10)).expect_err("a fault in a fault");
    assert_eq!(refusal.what, What::LockedUp);
}

/// Sends a byte while the clock is off by `thousandths`; returns what a receiver whose clock is right reads.
fn read_on_the_line(thousandths: i64) -> Vec<u8> {
    let steps = "0x20004000=0x41 P0.DIRSET=64 UARTE0.PSEL_TXD=6 UARTE0.BAUDRATE=0x01d60000 UARTE0.ENABLE=8 \
                 UARTE0.TXD_PTR=0x20004000 UARTE0.TXD_MAXCNT=1 UARTE0.TASKS_STARTTX=1";
    let mut machine = Names::new(ChipModel::Nrf52840, None).machine(steps);
    machine.chip().bus.inaccuracy = thousandths;
    machine.run(ms(10)).expect("nothing to refuse");
    let chip = machine.chip();
    chip.sent().iter().map(|(_, byte)| *byte).collect()
}

#[test]
fn a_line_whose_clock_is_off_by_more_than_half_a_bit_is_not_readable() {
    assert_eq!(read_on_the_line(20), [0x41]);
    assert_eq!(read_on_the_line(-20), [0x41]);
    assert_ne!(read_on_the_line(60), [0x41]);
}

/// Milliseconds after which the low-frequency clock runs, and after which it says that its source does.
fn started_after_ms(crystal: Option<u64>) -> [Option<u64>; 2] {
    let names = Names::new(ChipModel::Nrf52840, None);
    let steps = "CLOCK/POWER.LFCLKSRC=1 CLOCK/POWER.TASKS_LFCLKSTART=1";
    let mut machine = names.machine(steps);
    machine.chip().bus.slow_crystal = crystal;
    let mut found = [None; 2];
    for now in 1..=20 {
        machine.run(ms(1)).expect("nothing to refuse");
        let mut chip = machine.chip();
        let started = names.value("CLOCK/POWER.EVENTS_LFCLKSTARTED");
        let seen = [
            chip.low_frequency_source() == Some(0),
            chip.read(started, 4) == 1,
        ];
        for (found, seen) in found.iter_mut().zip(seen) {
            *found = found.or(seen.then_some(now));
        }
    }
    found
}

#[test]
fn the_low_frequency_clock_runs_from_the_oscillator_until_its_crystal_does() {
    assert_eq!(started_after_ms(Some(us(9500))), [Some(1), Some(10)]);
    assert_eq!(started_after_ms(None), [Some(1), None]);
}
