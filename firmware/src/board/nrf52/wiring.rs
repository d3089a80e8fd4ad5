//! Pin assignment: the only file to change for another board with the same chip.
//!
//! The numbers are those of Nordic's development kits, PCA10056 (nRF52840) and PCA10040
//! (nRF52832). Their debugger connects the UART to USB. The label pins are free on the headers;
//! none is a button's, which would short a high output to ground.

use embassy_nrf::{
    Peri, Peripherals,
    gpio::{AnyPin, Input, Level, Output, OutputDrive, Pull},
    gpiote::{Channel, OutputChannel, OutputChannelPolarity},
    peripherals,
};
use shared::intent::MAX_CLASSES;

/// Level that lights an LED.
pub const LED_ON: Level = Level::Low;
/// Level that switches it off.
pub const LED_OFF: Level = Level::High;

/// The peripherals and pins of the program, by purpose.
pub struct Wiring {
    /// Pins of the intents, in class order: relax, open, close, wave-in, wave-out, pinch.
    pub intents: [OutputChannel<'static>; MAX_CLASSES],
    /// High while the label is valid.
    pub valid: OutputChannel<'static>,
    /// LED: the label is valid.
    pub valid_led: Output<'static>,
    /// LED: an armband streams.
    pub armband_led: Output<'static>,
    /// LED: what an alignment does.
    pub alignment_led: Output<'static>,
    /// Button: begins an alignment. Connects the pin to ground while it is down.
    pub button: Input<'static>,
    /// The UART of labels and commands, 115200 8N1.
    pub uart: super::uart::Parts,
    /// Parts of the radio.
    pub radio: super::RadioParts,
    /// The dead-man timer and its connections to the pins.
    pub dead_man: super::dead_man::Parts,
    /// The watchdog.
    pub watchdog: Peri<'static, peripherals::WDT>,
}

/// Configures every pin, outputs at their safe levels.
pub fn wire(p: Peripherals) -> Wiring {
    #[cfg(feature = "nrf52840")]
    let (relax, others, valid, leds, button) = (
        p.P1_01,
        [
            p.P1_02.into(),
            p.P1_03.into(),
            p.P1_04.into(),
            p.P1_05.into(),
            p.P1_06.into(),
        ],
        p.P1_07,
        [p.P0_13.into(), p.P0_14.into(), p.P0_15.into()],
        p.P0_11,
    );
    #[cfg(feature = "nrf52832")]
    let (relax, others, valid, leds, button) = (
        p.P0_11,
        [
            p.P0_12.into(),
            p.P0_22.into(),
            p.P0_23.into(),
            p.P0_24.into(),
            p.P0_25.into(),
        ],
        p.P0_26,
        [p.P0_17.into(), p.P0_18.into(), p.P0_19.into()],
        p.P0_13,
    );

    let leds: [Peri<'static, AnyPin>; 3] = leds;
    let [valid_led, armband_led, alignment_led] =
        leds.map(|pin| Output::new(pin, LED_OFF, OutputDrive::Standard));
    let [open, close, wave_in, wave_out, pinch]: [Peri<'static, AnyPin>; MAX_CLASSES - 1] = others;
    Wiring {
        intents: [
            output(p.GPIOTE_CH0, relax.into(), Level::High),
            output(p.GPIOTE_CH1, open, Level::Low),
            output(p.GPIOTE_CH2, close, Level::Low),
            output(p.GPIOTE_CH3, wave_in, Level::Low),
            output(p.GPIOTE_CH4, wave_out, Level::Low),
            output(p.GPIOTE_CH5, pinch, Level::Low),
        ],
        valid: output(p.GPIOTE_CH6, valid.into(), Level::Low),
        dead_man: super::dead_man::Parts {
            timer: p.TIMER1,
            links: [
                p.PPI_CH0.into(),
                p.PPI_CH1.into(),
                p.PPI_CH2.into(),
                p.PPI_CH3.into(),
            ],
        },
        valid_led,
        armband_led,
        alignment_led,
        button: Input::new(button, Pull::Up),
        uart: super::uart::Parts {
            uart: p.UARTE0,
            tx: p.P0_06.into(),
            rx: p.P0_08.into(),
            counter: p.TIMER2,
            links: [p.PPI_CH4.into(), p.PPI_CH5.into()],
        },
        #[cfg(feature = "radio-softdevice")]
        radio: super::RadioParts {},
        #[cfg(feature = "radio-trouble")]
        radio: super::RadioParts {
            mpsl: nrf_mpsl::Peripherals::new(
                p.RTC0, p.TIMER0, p.TEMP, p.PPI_CH19, p.PPI_CH30, p.PPI_CH31,
            ),
            controller: nrf_sdc::Peripherals::new(
                p.PPI_CH17, p.PPI_CH18, p.PPI_CH20, p.PPI_CH21, p.PPI_CH22, p.PPI_CH23, p.PPI_CH24,
                p.PPI_CH25, p.PPI_CH26, p.PPI_CH27, p.PPI_CH28, p.PPI_CH29,
            ),
            random: p.RNG,
            flash: p.NVMC,
        },
        watchdog: p.WDT,
    }
}

/// An output that tasks of the peripheral interconnect can set too. Only tasks set it: writing the port does nothing.
fn output(
    channel: Peri<'static, impl Channel>,
    pin: Peri<'static, AnyPin>,
    level: Level,
) -> OutputChannel<'static> {
    let drive = OutputDrive::Standard;
    OutputChannel::new(channel, pin, level, drive, OutputChannelPolarity::Toggle)
}
