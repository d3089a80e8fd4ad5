//! Refusals of the peripherals that boards with USB use: USBD and SAADC.

use nrf52::What;
use nrf52::chip::Model;
use nrf52::time::ms;

use super::program::Program;
use super::refused;

const USBD: u32 = 0x4002_7000;
const STARTEPIN1: u32 = USBD + 0x008;
const STARTEPOUT1: u32 = USBD + 0x02c;
const EPINEN: u32 = USBD + 0x510;
const EPIN1: u32 = USBD + 0x614;
const RAM: u32 = 0x2000_4000;

const SAADC: u32 = 0x4000_7000;
const SAMPLE: u32 = SAADC + 0x004;
const PSELP: u32 = SAADC + 0x510;
const CONFIG: u32 = SAADC + 0x518;
const RESOLUTION: u32 = SAADC + 0x5f0;
const PTR: u32 = SAADC + 0x62c;
const MAXCNT: u32 = SAADC + 0x630;

/// Time that a program needs not to be refused in.
fn runs(program: Program) {
    let mut machine = program.machine(Model::Nrf52840, None);
    machine.run(ms(10)).expect("nothing to refuse");
}

/// USB, enabled and ready.
fn ready() -> Program {
    // subs r3, #1; bne: four cycles a turn, 125 us.
    enabled().load(3, 2000).then(&[0x3b01, 0xd1fd])
}

fn enabled() -> Program {
    Program::default().store(USBD + 0x500, 1)
}

/// A packet in endpoint 1, from this address.
fn packet(address: u32, length: u32) -> Program {
    ready()
        .store(EPINEN, 3)
        .store(EPIN1, address)
        .store(EPIN1 + 4, length)
        .store(STARTEPIN1, 1)
}

fn untimely(program: Program) -> (String, &'static str) {
    match refused(program) {
        (subject, What::Untimely { when }) => (subject, when),
        (subject, what) => panic!("{subject} {what}"),
    }
}

#[test]
fn usb_before_it_is_ready() {
    let before = "before it is ready (6.35.2)";
    for (program, subject) in [
        (Program::default().store(USBD + 0x504, 1), "USBD.USBPULLUP"),
        (enabled().store(USBD + 0x504, 1), "USBD.USBPULLUP"),
        (enabled().store(EPINEN, 3), "USBD.EPINEN"),
        (enabled().store(EPIN1, RAM), "USBD.EPIN.PTR[1]"),
        (enabled().store(STARTEPIN1, 1), "USBD.TASKS_STARTEPIN[1]"),
    ] {
        assert_eq!(untimely(program), (subject.to_owned(), before));
    }
    let disabled = untimely(Program::default().store(STARTEPIN1, 1)).1;
    assert_eq!(disabled, "while it is disabled");
    let again = ready().store(USBD + 0x500, 0).store(EPINEN, 3);
    assert_eq!(untimely(again).1, before);
    runs(ready().store(USBD + 0x504, 1).store(EPINEN, 3));
}

#[test]
fn a_packet_from_flash_or_longer_than_64_bytes() {
    runs(packet(RAM, 64));
    for (address, length) in [(0x100, 4), (RAM, 65), (0x2004_0000, 1)] {
        let what = refused(packet(address, length)).1;
        assert_eq!(what, What::NoDma { address, length });
    }
}

#[test]
fn packets_that_an_endpoint_cannot_give_or_take() {
    let twice = packet(RAM, 4).store(STARTEPIN1, 1);
    assert_eq!(
        untimely(twice).1,
        "before the host has taken the last packet"
    );
    for start in [STARTEPIN1, STARTEPOUT1] {
        let when = untimely(ready().store(start, 1)).1;
        assert_eq!(when, "while the endpoint is disabled");
    }
    let empty = ready().store(USBD + 0x514, 3).store(STARTEPOUT1, 1);
    assert_eq!(untimely(empty).1, "before the host has sent a packet");
    for start in [STARTEPIN1, STARTEPOUT1] {
        let asleep = ready()
            .store(EPINEN, 3)
            .store(USBD + 0x514, 3)
            .store(USBD + 0x52c, 1);
        let when = untimely(asleep.store(start, 1)).1;
        assert!(when.starts_with("in low-power mode"), "{when}");
    }
    for task in [0x04c, 0x050, 0x054] {
        let when = untimely(ready().store(USBD + task, 1)).1;
        assert_eq!(when, "without a control transfer");
    }
}

#[test]
fn registers_of_usb_and_their_reserved_bits() {
    for (address, value, reserved) in [
        (USBD + 0x500, 3, 2),
        (EPINEN, 0x201, 0x200),
        (EPIN1 + 4, 0x84, 0x80),
    ] {
        let what = refused(ready().store(address, value)).1;
        assert_eq!(what, What::Reserved { value, reserved });
    }
    let status = refused(ready().store(USBD + 0x470, 1)).1;
    assert_eq!(status, What::NotWritable { value: 1 });
    // Isochronous endpoints are not modelled.
    assert_eq!(refused(ready().store(USBD + 0x024, 1)).1, What::NotModelled);
}

/// A converter that is set up for one value of AIN0, and started.
fn started(address: u32, count: u32) -> Program {
    Program::default()
        .store(SAADC + 0x500, 1)
        .store(RESOLUTION, 2)
        .store(PSELP, 1)
        .store(CONFIG, 0x5_0000)
        .store(PTR, address)
        .store(MAXCNT, count)
        .store(SAADC, 1)
}

#[test]
fn conversions_at_the_wrong_time() {
    runs(started(RAM, 1).store(SAMPLE, 1));
    let disabled = untimely(Program::default().store(SAADC, 1));
    assert_eq!(
        disabled,
        ("SAADC.TASKS_START".to_owned(), "while it is disabled")
    );
    let early = Program::default().store(SAADC + 0x500, 1).store(SAMPLE, 1);
    assert_eq!(untimely(early).1, "before it is started");
    let stopped = started(RAM, 1).store(SAADC + 0x008, 1).store(SAMPLE, 1);
    assert_eq!(untimely(stopped).1, "before it is started");
    let twice = started(RAM, 1).store(SAMPLE, 1).store(SAMPLE, 1);
    assert_eq!(untimely(twice).1, "during a conversion");
    let off = Program::default()
        .store(SAADC + 0xffc, 0)
        .store(RESOLUTION, 2);
    assert_eq!(untimely(off).1, "while it is switched off");
}

#[test]
fn conversions_to_flash_of_no_input_or_with_other_settings() {
    let flash = refused(started(0x100, 1)).1;
    assert_eq!(
        flash,
        What::NoDma {
            address: 0x100,
            length: 2
        }
    );
    for (program, subject) in [
        (started(RAM, 2), "SAADC.RESULT.MAXCNT"),
        (
            started(RAM, 1).store(PSELP, 0).store(SAMPLE, 1),
            "SAADC.CH.PSELP[0]",
        ),
        (
            started(RAM, 1).store(CONFIG, 0x2_0000).store(SAMPLE, 1),
            "SAADC.CH.CONFIG[0]",
        ),
        (
            started(RAM, 1).store(RESOLUTION, 1).store(SAMPLE, 1),
            "SAADC.CH.CONFIG[0]",
        ),
    ] {
        let (found, what) = refused(program);
        assert!(matches!(what, What::Value { .. }), "{what}");
        assert_eq!(found, subject);
    }
    let what = refused(Program::default().store(RESOLUTION, 9)).1;
    assert_eq!(
        what,
        What::Reserved {
            value: 9,
            reserved: 8
        }
    );
}
