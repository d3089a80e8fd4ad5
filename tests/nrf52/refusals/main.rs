//! Each refusal has a program that earns it.

mod board;
#[path = "../program.rs"]
mod program;
mod usb;

use nrf52::What;
use nrf52::chip::ChipModel;
use nrf52::softdevice::SoftDeviceKind;
use nrf52::time::ms;
use program::Program;

const CLOCK: u32 = 0x4000_0000;
const UARTE: u32 = 0x4000_2000;
const TIMER1: u32 = 0x4000_9000;
const PWM: u32 = 0x4001_c000;
const WDT: u32 = 0x4001_0000;
const RTC1: u32 = 0x4001_1000;
const NVMC: u32 = 0x4001_e000;
const PPI: u32 = 0x4001_f000;
const P0: u32 = 0x5000_0000;
const UICR: u32 = 0x1000_1000;

/// Runs programs, each of which is refused in these words; without words it runs.
fn each<const N: usize>(
    model: ChipModel,
    kind: Option<SoftDeviceKind>,
    cases: [(Program, &str); N],
) {
    for (number, (program, words)) in cases.into_iter().enumerate() {
        let found = program.machine(model, kind).run(ms(10));
        let found = found.err().map(|refusal| refusal.to_string());
        let is_expected = match &found {
            Some(found) => !words.is_empty() && found.contains(words),
            None => words.is_empty(),
        };
        assert!(is_expected, "{number}: {found:?}, expected {words:?}");
    }
}

/// Wait for an interrupt.
const WFI: u16 = 0xbf30;

#[test]
fn programs_without_a_softdevice() {
    let program = Program::default;
    let received = program()
        .store(P0 + 0x720, 0)
        .store(UARTE + 0x514, 8)
        .store(UARTE + 0x500, 8)
        .store(UARTE + 0x534, 0x2000_4000)
        .store(UARTE + 0x538, 4);
    let sent = program()
        .store(P0 + 0x518, 1 << 6)
        .store(UARTE + 0x50c, 6)
        .store(UARTE + 0x500, 8);
    each(
        ChipModel::Nrf52840,
        None,
        [
            (program().store(P0 + 0x508, 1).read(P0 + 0x504), ""),
            (
                program().read(UARTE + 0x5f0),
                "UARTE0+0x5f0 is not modelled",
            ),
            (program().store(0x4000_3000, 1), "belongs to no peripheral"),
            (program().store_byte(P0 + 0x508, 1), "with 1 bytes"),
            (program().read(TIMER1), "is read: it can only be written"),
            (
                program().store(WDT + 0x400, 1),
                "is written 0x1: it can only be read",
            ),
            (
                program().store(TIMER1 + 0x144, 1),
                "TIMER1.EVENTS_COMPARE[1] is written 0x1: a program writes 0",
            ),
            (
                program().store(TIMER1 + 0x504, 0x11),
                "the bits 0x10 are reserved",
            ),
            (
                program().store(UARTE + 0x524, 0x0027_5000),
                "is written 0x275000: ",
            ),
            // A watchdog that is configured while it runs.
            (
                program().store(WDT, 1).store(WDT + 0x504, 100),
                "is written 0x64: ",
            ),
            (
                program().store(UARTE + 0x008, 1),
                "is triggered while it is disabled",
            ),
            (program().store(RTC1, 1), "RTC1.TASKS_START is triggered"),
            // A receiver that is stopped while a shortcut starts it again.
            (
                received
                    .store(UARTE + 0x200, 1 << 5)
                    .store(UARTE, 1)
                    .store(UARTE + 0x004, 1),
                "UARTE0.TASKS_STOPRX is triggered",
            ),
            (
                program().store(PPI + 0x510, TIMER1 + 0x504),
                "and is no event",
            ),
            (
                program().store(PPI + 0x514, TIMER1 + 0x140),
                "and is no task",
            ),
            (
                sent.store(UARTE + 0x544, 0x100)
                    .store(UARTE + 0x548, 4)
                    .store(UARTE + 0x008, 1),
                "is given 0x00000100 and 4 bytes",
            ),
            // UICR and a page without leave.
            (program().store(UICR + 0x200, 18), "is written 0x12: "),
            (
                program().store(NVMC + 0x508, 0x8_0000),
                "is written 0x80000: ",
            ),
            (program().then(&[WFI]), ""),
        ],
    );
}

/// A program that has given PWM0 a pin, periods of a millisecond, and a pulse of so many microseconds, its own word.
fn with_pulse(high_us: u32) -> Program {
    const VALUE: u32 = 0x2000_8000;
    [
        (P0 + 0x518, 1 << 6),
        (VALUE, 1 << 15 | high_us),
        (PWM + 0x560, 6),
        (PWM + 0x508, 1000),
        (PWM + 0x50c, 4),
        (PWM + 0x520, VALUE),
        (PWM + 0x524, 1),
        (PWM + 0x500, 1),
    ]
    .into_iter()
    .fold(Program::default(), |program, (address, value)| {
        program.store(address, value)
    })
}

#[test]
fn programs_that_make_pulses() {
    const START: u32 = PWM + 0x008;
    const STOP: u32 = PWM + 0x004;
    let ready = || with_pulse(300);
    let disabled = "PWM0.TASKS_SEQSTART is triggered while it is disabled";
    each(
        ChipModel::Nrf52840,
        None,
        [
            (ready().store(START, 1).store(START, 1), ""),
            (Program::default().store(START, 1), disabled),
            (ready().store(PWM + 0x524, 2), "longer sequences"),
            (ready().store(PWM + 0x564, 7), "other channels"),
            (
                ready().store(PWM + 0x520, 0x100).store(START, 1),
                "RAM alone",
            ),
            (ready().store(START, 1).store(PWM + 0x508, 9), "no pulses"),
            (
                ready().store(START, 1).store(STOP, 1).store(START, 1),
                "while it is stopping",
            ),
            (ready().store(P0 + 0x51c, 1 << 6), "it is no output"),
            (
                ready().store(0x4000_6510, 3 | 6 << 8),
                "PWM0 and another have it",
            ),
        ],
    );
}

#[test]
fn programs_on_the_nrf52832() {
    // subs r3, #1; bne: four cycles a turn.
    let wait = |turns| Program::default().load(3, turns).then(&[0x3b01, 0xd1fd]);
    let starts = |turns| wait(turns).store(CLOCK + 0x008, 1);
    // What FICR holds at 0x258, of which seven bits count.
    let worked_around = Program::default().store(CLOCK + 0xee4, 0x43);
    each(
        ChipModel::Nrf52832,
        None,
        [
            (Program::default().store(P0 + 0x808, 1), "is not modelled"),
            (Program::default().then(&[WFI]), "erratum 108"),
            (worked_around.then(&[WFI]), ""),
            // The RC oscillator within the time of erratum 132, before and after it.
            (starts(1500), "is triggered"),
            (starts(100), ""),
            (starts(3000), ""),
        ],
    );
}

#[test]
fn programs_beside_a_softdevice() {
    let own = || Program::default().enable(SoftDeviceKind::S140);
    let flash = 0x8_0000;
    each(
        ChipModel::Nrf52840,
        Some(SoftDeviceKind::S140),
        [
            (own().store(0x4000_0000, 1), "belongs to the SoftDevice"),
            (own().store(0x4000_8000, 1), "belongs to the SoftDevice"),
            (own().store(NVMC + 0x504, 1), "belongs to the SoftDevice"),
            (own().store(PPI + 0x598, 1), "belongs to the SoftDevice"),
            (own().store(0x2000_3ffc, 1), "belongs to the SoftDevice"),
            // Channel 0 is the program's.
            (own().store(PPI + 0x504, 1), ""),
            (
                own().call(44, [1, 2, 3]),
                "SVC 44 is a call that is not modelled",
            ),
            // cpsid i
            (
                own().then(&[0xb672]).call(75, [0x2000_8000, 0, 0]),
                "priority",
            ),
            // cmp r0, r0; it eq; svceq 75
            (own().then(&[0x4280, 0xbf08, 0xdf4b]), "in an IT block"),
            // Interrupt 23 has priority 0 unless it is given another one.
            (
                own()
                    .store(0xe000_e100, 1 << 23)
                    .call(75, [0x2000_8000, 0, 0]),
                "interrupt 23 has priority 0",
            ),
            (
                own()
                    .store(0xe000_e100, 1 << 1)
                    .call(75, [0x2000_8000, 0, 0]),
                "interrupt 1",
            ),
            (own().call(41, [flash, 0x2_7000, 1]), "no RAM"),
        ],
    );
    let twice = own()
        .store(0x2000_8000, 1)
        .call(41, [flash, 0x2000_8000, 1]);
    let mut machine = twice.machine(ChipModel::Nrf52840, Some(SoftDeviceKind::S140));
    machine.chip().bus.memory.program(flash, &[0; 4]);
    let refusal = machine.run(ms(10)).expect_err("ones over zeros");
    assert!(refusal.to_string().contains("erase first"));
}

#[test]
fn a_core_that_locks_up() {
    // bx to address 0x20, without the bit for Thumb; its fault's handler is broken too.
    let program = Program::default().load(0, 0x20).then(&[0x4700]);
    let mut machine = program.machine(ChipModel::Nrf52840, None);
    machine.chip().bus.memory.clear_bits(12, &[0; 4]);
    let refusal = machine.run(ms(10)).expect_err("a fault in a fault");
    assert_eq!(refusal.what, What::LockedUp);
}

/// Sends a byte while the clock is off by `thousandths`; returns what a receiver whose clock is right reads.
fn read_on_the_line(thousandths: i64) -> Vec<u8> {
    let program = Program::default()
        .store(0x2000_4000, 0x41)
        .store(P0 + 0x518, 1 << 6)
        .store(UARTE + 0x50c, 6)
        .store(UARTE + 0x524, 0x01d6_0000)
        .store(UARTE + 0x500, 8)
        .store(UARTE + 0x544, 0x2000_4000)
        .store(UARTE + 0x548, 1)
        .store(UARTE + 0x008, 1);
    let mut machine = program.machine(ChipModel::Nrf52840, None);
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
