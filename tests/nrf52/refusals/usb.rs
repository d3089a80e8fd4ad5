//! Refusals of the peripherals that boards with USB use: USBD and SAADC.

use nrf52::chip::ChipModel;

use super::each;
use super::program::Program;

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

#[test]
fn usb_at_the_wrong_time_or_with_packets_that_an_endpoint_cannot_give_or_take() {
    let early = "before it is ready (6.35.2)";
    let disabled = "is triggered while the endpoint is disabled";
    let asleep = |task| {
        let woken = ready().store(EPINEN, 3).store(USBD + 0x514, 3);
        woken.store(USBD + 0x52c, 1).store(task, 1)
    };
    let empty = ready().store(USBD + 0x514, 3).store(STARTEPOUT1, 1);
    let off = |program: Program| program.store(USBD + 0x500, 0);
    each(
        ChipModel::Nrf52840,
        None,
        [
            (Program::default().store(USBD + 0x504, 1), early),
            (enabled().store(USBD + 0x504, 1), early),
            (enabled().store(EPINEN, 3), early),
            (enabled().store(EPIN1, RAM), early),
            (enabled().store(STARTEPIN1, 1), early),
            (off(ready()).store(EPINEN, 3), early),
            (Program::default().store(STARTEPIN1, 1), "is disabled"),
            (ready().store(USBD + 0x504, 1).store(EPINEN, 3), ""),
            (packet(RAM, 64), ""),
            (packet(0x100, 4), "is given 0x00000100 and 4 bytes"),
            (packet(RAM, 65), "is given 0x20004000 and 65 bytes"),
            (packet(0x2004_0000, 1), "is given 0x20040000 and 1 bytes"),
            (packet(RAM, 4).store(STARTEPIN1, 1), "has taken the last"),
            (ready().store(STARTEPIN1, 1), disabled),
            (ready().store(STARTEPOUT1, 1), disabled),
            (empty, "before the host has sent a packet"),
            (asleep(STARTEPIN1), "in low-power mode"),
            (asleep(STARTEPOUT1), "in low-power mode"),
            (ready().store(USBD + 0x04c, 1), "without a control transfer"),
            (ready().store(USBD + 0x050, 1), "without a control transfer"),
            (ready().store(USBD + 0x054, 1), "without a control transfer"),
            (ready().store(USBD + 0x500, 3), "the bits 0x2 are reserved"),
            (ready().store(EPINEN, 0x201), "the bits 0x200 are reserved"),
            (ready().store(EPIN1 + 4, 0x84), "the bits 0x80 are reserved"),
            (ready().store(USBD + 0x470, 1), "it can only be read"),
            // Isochronous endpoints.
            (ready().store(USBD + 0x024, 1), "is not modelled"),
        ],
    );
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
fn conversions_at_the_wrong_time_to_flash_of_no_input_or_with_other_settings() {
    let early = "before it is started";
    let with = |register, value| started(RAM, 1).store(register, value).store(SAMPLE, 1);
    let off = Program::default().store(SAADC + 0xffc, 0);
    let sampled = || started(RAM, 1).store(SAMPLE, 1);
    each(
        ChipModel::Nrf52840,
        None,
        [
            (sampled(), ""),
            (
                Program::default().store(SAADC, 1),
                "SAADC.TASKS_START is triggered while it is disabled",
            ),
            (
                Program::default().store(SAADC + 0x500, 1).store(SAMPLE, 1),
                early,
            ),
            (with(SAADC + 0x008, 1), early),
            (sampled().store(SAMPLE, 1), "during a conversion"),
            (off.store(RESOLUTION, 2), "while it is switched off"),
            (started(0x100, 1), "is given 0x00000100 and 2 bytes"),
            (started(RAM, 2), "SAADC.RESULT.MAXCNT is written"),
            (with(PSELP, 0), "SAADC.CH.PSELP[0] is written"),
            (with(CONFIG, 0x2_0000), "SAADC.CH.CONFIG[0] is written"),
            (with(RESOLUTION, 1), "SAADC.CH.CONFIG[0] is written"),
            (
                Program::default().store(RESOLUTION, 9),
                "the bits 0x8 are reserved",
            ),
        ],
    );
}
