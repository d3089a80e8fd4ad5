//! Each refusal has a program that earns it.

#[path = "refusals/board.rs"]
mod board;
#[path = "program.rs"]
mod program;
#[path = "refusals/usb.rs"]
mod usb;

use nrf52::What;
use nrf52::chip::Model;
use nrf52::softdevice::Kind;
use nrf52::time::ms;
use program::Program;

const CLOCK: u32 = 0x4000_0000;
const UARTE: u32 = 0x4000_2000;
const TIMER1: u32 = 0x4000_9000;
const WDT: u32 = 0x4001_0000;
const RTC1: u32 = 0x4001_1000;
const NVMC: u32 = 0x4001_e000;
const PPI: u32 = 0x4001_f000;
const P0: u32 = 0x5000_0000;
const UICR: u32 = 0x1000_1000;

/// Returns the refusal that ends a program without a SoftDevice.
fn refused(program: Program) -> (String, What) {
    let mut machine = program.machine(Model::Nrf52840, None);
    let refusal = machine
        .run(ms(10))
        .expect_err("the program has to be refused");
    (refusal.subject, refusal.what)
}

/// Returns the refusal that ends a program that has enabled S140.
fn refused_beside_a_softdevice(program: impl FnOnce(Program) -> Program) -> (String, What) {
    let program = program(Program::default().enable(Kind::S140));
    let mut machine = program.machine(Model::Nrf52840, Some(Kind::S140));
    let refusal = machine
        .run(ms(10))
        .expect_err("the program has to be refused");
    (refusal.subject, refusal.what)
}

fn why(what: What) -> String {
    match what {
        What::WrongCall { why } => why,
        other => panic!("{other}"),
    }
}

#[test]
fn what_is_modelled_is_not_refused() {
    let program = Program::default().store(P0 + 0x508, 1).read(P0 + 0x504);
    let mut machine = program.machine(Model::Nrf52840, None);
    machine.run(ms(10)).expect("nothing to refuse");
    assert_eq!(machine.core().register(2), 1);
}

#[test]
fn a_register_that_is_not_modelled() {
    let (subject, what) = refused(Program::default().read(UARTE + 0x5f0));
    assert_eq!(
        (subject.as_str(), what),
        ("UARTE0+0x5f0", What::NotModelled)
    );
}

#[test]
fn an_address_of_no_peripheral() {
    let (_, what) = refused(Program::default().store(0x4000_3000, 1));
    assert_eq!(what, What::NoPeripheral);
    // The nRF52832 has one port.
    let program = Program::default().store(P0 + 0x808, 1);
    let refusal = program.machine(Model::Nrf52832, None).run(ms(10));
    assert_eq!(refusal.expect_err("no second port").what, What::NotModelled);
}

#[test]
fn another_width_than_a_word() {
    let (_, what) = refused(Program::default().store_byte(P0 + 0x508, 1));
    assert_eq!(what, What::Width { bytes: 1 });
}

#[test]
fn a_task_that_is_read() {
    assert_eq!(
        refused(Program::default().read(TIMER1)).1,
        What::NotReadable
    );
}

#[test]
fn a_status_that_is_written() {
    let (_, what) = refused(Program::default().store(WDT + 0x400, 1));
    assert_eq!(what, What::NotWritable { value: 1 });
}

#[test]
fn an_event_that_is_set() {
    let (subject, what) = refused(Program::default().store(TIMER1 + 0x144, 1));
    assert_eq!(subject, "TIMER1.EVENTS_COMPARE[1]");
    assert_eq!(what, What::EventSet { value: 1 });
}

#[test]
fn reserved_bits() {
    let (_, what) = refused(Program::default().store(TIMER1 + 0x504, 0x11));
    let expected = What::Reserved {
        value: 0x11,
        reserved: 0x10,
    };
    assert_eq!(what, expected);
}

#[test]
fn a_value_that_is_not_modelled() {
    let (_, what) = refused(Program::default().store(UARTE + 0x524, 0x0027_5000));
    assert!(matches!(what, What::Value { .. }), "{what}");
}

#[test]
fn a_watchdog_that_is_configured_while_it_runs() {
    let program = Program::default().store(WDT, 1).store(WDT + 0x504, 100);
    assert!(matches!(refused(program).1, What::Value { .. }));
}

#[test]
fn a_task_at_the_wrong_time() {
    let (_, what) = refused(Program::default().store(UARTE + 0x008, 1));
    assert_eq!(
        what,
        What::Untimely {
            when: "while it is disabled"
        }
    );
    let (subject, what) = refused(Program::default().store(RTC1, 1));
    assert_eq!(subject, "RTC1.TASKS_START");
    assert!(matches!(what, What::Untimely { .. }), "{what}");
}

#[test]
fn a_receiver_that_is_stopped_while_a_shortcut_starts_it_again() {
    let program = Program::default()
        .store(P0 + 0x720, 0)
        .store(UARTE + 0x514, 8)
        .store(UARTE + 0x500, 8)
        .store(UARTE + 0x534, 0x2000_4000)
        .store(UARTE + 0x538, 4)
        .store(UARTE + 0x200, 1 << 5)
        .store(UARTE, 1)
        .store(UARTE + 0x004, 1);
    let (subject, what) = refused(program);
    assert_eq!(subject, "UARTE0.TASKS_STOPRX");
    assert!(matches!(what, What::Untimely { .. }), "{what}");
}

/// Returns the refusal that ends a program on the nRF52832.
fn refused_on_the_nrf52832(program: Program) -> What {
    let mut machine = program.machine(Model::Nrf52832, None);
    let refusal = machine.run(ms(10));
    refusal.expect_err("the program has to be refused").what
}

#[test]
fn sleep_without_the_workaround_of_erratum_108() {
    const WFI: u16 = 0xbf30;
    let sleeps = || Program::default().then(&[WFI]);
    assert_eq!(refused_on_the_nrf52832(sleeps()), What::RamIsLost);
    // What FICR holds at 0x258, of which seven bits count.
    let program = Program::default().store(CLOCK + 0xee4, 0x43).then(&[WFI]);
    let mut machine = program.machine(Model::Nrf52832, None);
    machine.run(ms(10)).expect("it may sleep");
    let mut machine = sleeps().machine(Model::Nrf52840, None);
    machine.run(ms(10)).expect("the other chip may");
}

#[test]
fn the_rc_oscillator_within_the_time_of_erratum_132() {
    // subs r3, #1; bne: four cycles a turn.
    let wait = |turns| Program::default().load(3, turns).then(&[0x3b01, 0xd1fd]);
    let what = refused_on_the_nrf52832(wait(1500).store(CLOCK + 0x008, 1));
    assert!(matches!(what, What::Untimely { .. }), "{what}");
    for turns in [100, 3000] {
        let program = wait(turns).store(CLOCK + 0x008, 1);
        let mut machine = program.machine(Model::Nrf52832, None);
        machine.run(ms(10)).expect("before and after it may");
    }
}

#[test]
fn ends_of_a_channel_that_are_no_event_and_no_task() {
    let (_, what) = refused(Program::default().store(PPI + 0x510, TIMER1 + 0x504));
    assert_eq!(what, What::NoEvent);
    let (_, what) = refused(Program::default().store(PPI + 0x514, TIMER1 + 0x140));
    assert_eq!(what, What::NoTask);
}

#[test]
fn dma_from_flash() {
    let program = Program::default()
        .store(P0 + 0x518, 1 << 6)
        .store(UARTE + 0x50c, 6)
        .store(UARTE + 0x500, 8)
        .store(UARTE + 0x544, 0x100)
        .store(UARTE + 0x548, 4)
        .store(UARTE + 0x008, 1);
    let expected = What::NoDma {
        address: 0x100,
        length: 4,
    };
    assert_eq!(refused(program).1, expected);
}

#[test]
fn uicr_and_pages_without_leave() {
    let (_, what) = refused(Program::default().store(UICR + 0x200, 18));
    assert!(matches!(what, What::Value { .. }), "{what}");
    let (_, what) = refused(Program::default().store(NVMC + 0x508, 0x8_0000));
    assert!(matches!(what, What::Value { .. }), "{what}");
}

#[test]
fn what_the_softdevice_owns() {
    let taken = [0x4000_0000, 0x4000_8000, NVMC + 0x504, PPI + 0x598];
    for address in taken {
        let (_, what) = refused_beside_a_softdevice(|program| program.store(address, 1));
        assert_eq!(what, What::SoftDevices, "{address:#x}");
    }
    // The program's own channels are its own.
    let program = Program::default().enable(Kind::S140).store(PPI + 0x504, 1);
    let mut machine = program.machine(Model::Nrf52840, Some(Kind::S140));
    machine.run(ms(10)).expect("channel 0 is the program's");
}

#[test]
fn ram_of_the_softdevice() {
    let (_, what) = refused_beside_a_softdevice(|program| program.store(0x2000_3ffc, 1));
    assert_eq!(what, What::SoftDevices);
}

#[test]
fn a_call_that_is_not_modelled() {
    let (subject, what) = refused_beside_a_softdevice(|program| program.call(44, [1, 2, 3]));
    assert_eq!(subject, "SVC 44");
    assert!(matches!(what, What::UnknownCall { .. }), "{what}");
}

#[test]
fn a_call_with_interrupts_disabled() {
    // cpsid i
    let (subject, what) = refused_beside_a_softdevice(|program| {
        program.then(&[0xb672]).call(75, [0x2000_8000, 0, 0])
    });
    assert!(subject.starts_with("SVC 75"), "{subject}");
    assert!(why(what).contains("priority"));
}

#[test]
fn a_call_in_an_it_block() {
    // cmp r0, r0; it eq; svceq 75
    let (_, what) = refused_beside_a_softdevice(|program| program.then(&[0x4280, 0xbf08, 0xdf4b]));
    assert_eq!(what, What::CallInItBlock);
}

#[test]
fn an_interrupt_with_a_reserved_priority() {
    // Interrupt 23 has priority 0 unless it is given another one.
    let (_, what) = refused_beside_a_softdevice(|program| {
        program
            .store(0xe000_e100, 1 << 23)
            .call(75, [0x2000_8000, 0, 0])
    });
    let expected = What::Priority {
        interrupt: 23,
        priority: 0,
    };
    assert_eq!(what, expected);
}

#[test]
fn an_interrupt_of_the_softdevice_that_the_program_enables() {
    let (_, what) = refused_beside_a_softdevice(|program| {
        program
            .store(0xe000_e100, 1 << 1)
            .call(75, [0x2000_8000, 0, 0])
    });
    assert!(why(what).contains("interrupt 1"));
}

#[test]
fn flash_that_is_written_from_flash_or_twice() {
    let flash = 0x8_0000;
    let (_, what) = refused_beside_a_softdevice(|program| program.call(41, [flash, 0x2_7000, 1]));
    assert!(why(what).contains("no RAM"));
    let program = Program::default()
        .enable(Kind::S140)
        .store(0x2000_8000, 1)
        .call(41, [flash, 0x2000_8000, 1]);
    let mut machine = program.machine(Model::Nrf52840, Some(Kind::S140));
    machine.chip().bus.memory.program(flash, &[0; 4]);
    let refusal = machine.run(ms(10)).expect_err("ones over zeros");
    assert!(why(refusal.what).contains("erase first"));
}

#[test]
fn a_core_that_locks_up() {
    // bx to address 0x20, without the bit for Thumb; its fault's handler is broken too.
    let program = Program::default().load(0, 0x20).then(&[0x4700]);
    let mut machine = program.machine(Model::Nrf52840, None);
    machine.chip().bus.memory.clear_bits(12, &[0; 4]);
    let refusal = machine.run(ms(10)).expect_err("a fault in a fault");
    assert_eq!(refusal.what, What::LockedUp);
}

/// Sends a byte while the clock is off by so many thousandths; returns what a receiver whose clock is right reads.
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
    let mut machine = program.machine(Model::Nrf52840, None);
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
