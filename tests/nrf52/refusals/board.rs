//! Programs that do not fit the board: its pins, its clocks, its supply.

use nrf52::chip::{Chip, ChipModel, NFCPINS, PSELRESET, REGOUT0};
use nrf52::time::{ms, us};

use super::program::Program;
use super::{CLOCK, P0, UARTE, WDT};

const GPIOTE: u32 = 0x4000_6000;
const P1: u32 = P0 + 0x300;
const DIRSET: u32 = 0x518;
const PIN_CNF: u32 = 0x700;
const LFCLKSTART: u32 = CLOCK + 0x008;
const LFCLKSTOP: u32 = CLOCK + 0x00c;
const LFCLKSRC: u32 = CLOCK + 0x518;
const DCDCEN: u32 = CLOCK + 0x578;
const DCDCEN0: u32 = CLOCK + 0x580;
/// GPIOTE: a channel drives pin 0.
const TASK: u32 = 3;

/// A program, as the words that it writes; what a programmer and the board have done before; and what is refused.
type Case = (&'static [(u32, u32)], fn(&mut Chip), Option<&'static str>);

fn as_it_is(_: &mut Chip) {}

fn without_nfc(chip: &mut Chip) {
    chip.program_uicr(NFCPINS, !1);
}

fn with_reset(chip: &mut Chip) {
    for word in PSELRESET {
        chip.program_uicr(word, 18);
    }
}

fn with_half_a_reset(chip: &mut Chip) {
    chip.program_uicr(PSELRESET[0], 18);
}

fn at_vddh(chip: &mut Chip) {
    chip.bus.board.is_high_voltage = true;
}

fn at_vddh_with_3_volts(chip: &mut Chip) {
    at_vddh(chip);
    chip.program_uicr(REGOUT0, !7 | 5);
}

fn with_an_inductor(chip: &mut Chip) {
    chip.bus.board.inductors[0] = true;
}

const CRYSTAL: Option<&str> =
    Some("PIN_CNF[1] is configured for something else: the low-frequency clock's crystal");
const NFC: Option<&str> = Some("an antenna's");
const RESET: Option<&str> = Some("P0.PIN_CNF[18] is configured for something else: UICR.PSELRESET");
const LOW: Option<&str> = Some("1.8 V");
const SOURCE: Option<&str> =
    Some("CLOCK/POWER.LFCLKSRC is written 0x1: the low-frequency clock runs");
const INDUCTOR: Option<&str> = Some("no inductor");

const CASES: &[Case] = &[
    // The crystal's pins, before and after it is told to start; on another source they are free.
    (
        &[(LFCLKSRC, 1), (LFCLKSTART, 1), (P0 + DIRSET, 2)],
        as_it_is,
        CRYSTAL,
    ),
    (
        &[(P0 + DIRSET, 2), (LFCLKSRC, 1), (LFCLKSTART, 1)],
        as_it_is,
        CRYSTAL,
    ),
    (
        &[(LFCLKSRC, 1), (LFCLKSTART, 1), (P0 + PIN_CNF + 4, 0)],
        as_it_is,
        CRYSTAL,
    ),
    (
        &[(LFCLKSRC, 1), (LFCLKSTART, 1), (P0 + PIN_CNF + 4, 0xe)],
        as_it_is,
        CRYSTAL,
    ),
    (
        &[
            (LFCLKSRC, 1),
            (LFCLKSTART, 1),
            (GPIOTE + 0x510, TASK | 1 << 8),
        ],
        as_it_is,
        CRYSTAL,
    ),
    (&[(LFCLKSTART, 1), (P0 + DIRSET, 3)], as_it_is, None),
    (
        &[(LFCLKSRC, 1), (LFCLKSTART, 1), (P1 + DIRSET, 3)],
        as_it_is,
        None,
    ),
    // NFC's, until UICR says otherwise.
    (&[(P0 + DIRSET, 1 << 9)], as_it_is, NFC),
    (&[(P0 + PIN_CNF + 40, 0)], as_it_is, NFC),
    (&[(GPIOTE + 0x514, TASK | 10 << 8)], as_it_is, NFC),
    (&[(P0 + DIRSET, 3 << 9)], without_nfc, None),
    // The reset's: it may be read.
    (&[(P0 + DIRSET, 1 << 18)], with_reset, RESET),
    (&[(GPIOTE + 0x51c, TASK | 18 << 8)], with_reset, RESET),
    (&[(P0 + PIN_CNF + 72, 0)], with_reset, None),
    (&[(P0 + DIRSET, 1 << 18)], with_half_a_reset, None),
    // Levels of 1.8 V, where the supply is at VDDH and UICR is erased.
    (&[(P0 + DIRSET, 1 << 15)], at_vddh, LOW),
    (&[(GPIOTE + 0x510, TASK | 33 << 8)], at_vddh, LOW),
    (&[(P0 + DIRSET, 1 << 15)], at_vddh_with_3_volts, None),
    (&[(P0 + DIRSET, 1 << 15)], as_it_is, None),
    // The low-frequency clock's source, while it starts, runs, or the watchdog keeps it running.
    (&[(LFCLKSTART, 1), (LFCLKSRC, 1)], as_it_is, SOURCE),
    (&[(LFCLKSTART, 1), (LFCLKSRC, 0)], as_it_is, None),
    (&[(WDT, 1), (LFCLKSRC, 1)], as_it_is, SOURCE),
    (
        &[(LFCLKSTOP, 1)],
        as_it_is,
        Some("while the low-frequency clock does not run"),
    ),
    // Converters.
    (&[(DCDCEN, 1)], as_it_is, INDUCTOR),
    (&[(DCDCEN0, 1)], with_an_inductor, INDUCTOR),
    (&[(DCDCEN, 1), (DCDCEN0, 0)], with_an_inductor, None),
    // The UART's pins.
    (
        &[
            (P0 + DIRSET, 64),
            (UARTE + 0x50c, 6),
            (UARTE + 0x514, 6),
            (UARTE + 0x500, 8),
        ],
        as_it_is,
        Some("sends and receives"),
    ),
    (
        &[(UARTE + 0x50c, 6), (UARTE + 0x500, 8)],
        as_it_is,
        Some("no output"),
    ),
    (
        &[(P1 + DIRSET, 64), (UARTE + 0x50c, 6), (UARTE + 0x500, 8)],
        as_it_is,
        Some("no output"),
    ),
    (
        &[(UARTE + 0x514, 6), (UARTE + 0x500, 8)],
        as_it_is,
        Some("no input"),
    ),
    (
        &[
            (P0 + PIN_CNF + 24, 1),
            (UARTE + 0x514, 6),
            (UARTE + 0x500, 8),
        ],
        as_it_is,
        Some("no input"),
    ),
    (
        &[
            (P0 + DIRSET, 64),
            (UARTE + 0x50c, 6),
            (UARTE + 0x500, 8),
            (GPIOTE + 0x510, TASK | 6 << 8),
        ],
        as_it_is,
        Some("GPIOTE and the UART"),
    ),
    (
        &[(P0 + DIRSET, 64), (UARTE + 0x50c, 6), (UARTE + 0x500, 8)],
        as_it_is,
        None,
    ),
    // Two channels of GPIOTE.
    (
        &[
            (GPIOTE + 0x510, TASK | 4 << 8),
            (GPIOTE + 0x514, TASK | 4 << 8),
        ],
        as_it_is,
        Some("two channels"),
    ),
    (
        &[
            (GPIOTE + 0x510, TASK | 4 << 8),
            (GPIOTE + 0x514, TASK | 36 << 8),
        ],
        as_it_is,
        None,
    ),
];

#[test]
fn programs_that_do_not_fit_the_board() {
    for (number, (words, prepare, expected)) in CASES.iter().enumerate() {
        let program = words
            .iter()
            .fold(Program::default(), |program, (address, value)| {
                program.store(*address, *value)
            });
        let mut machine = program.machine(ChipModel::Nrf52840, None);
        prepare(&mut machine.chip());
        let found = machine.run(ms(1)).err().map(|refusal| refusal.to_string());
        let is_expected = match (&found, expected) {
            (Some(found), Some(expected)) => found.contains(expected),
            (found, expected) => found.is_none() && expected.is_none(),
        };
        assert!(
            is_expected,
            "{number}: {words:x?}: {found:?}, expected {expected:?}"
        );
    }
}

/// Milliseconds after which the low-frequency clock runs, and after which it says that its source does.
fn started_after_ms(crystal: Option<u64>) -> [Option<u64>; 2] {
    let program = Program::default().store(LFCLKSRC, 1).store(LFCLKSTART, 1);
    let mut machine = program.machine(ChipModel::Nrf52840, None);
    machine.chip().bus.slow_crystal = crystal;
    let mut found = [None; 2];
    for now in 1..=20 {
        machine.run(ms(1)).expect("nothing to refuse");
        let mut chip = machine.chip();
        let seen = [
            chip.low_frequency_source() == Some(0),
            chip.read(CLOCK + 0x104, 4) == 1,
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
