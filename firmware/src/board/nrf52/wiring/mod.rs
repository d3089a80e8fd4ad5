//! Pin assignment, one file a board: all that another board with the same chip needs.

#[cfg(all(feature = "nrf52840", not(feature = "uf2")))]
#[path = "dk.rs"]
mod board;
#[cfg(feature = "nrf52832")]
#[path = "dk52832.rs"]
mod board;
#[cfg(feature = "xiao")]
#[path = "xiao.rs"]
mod board;
#[cfg(feature = "feather")]
#[path = "feather.rs"]
mod board;
#[cfg(feature = "nice-nano")]
#[path = "nice_nano.rs"]
mod board;

#[cfg(feature = "uf2")]
use embassy_nrf::ppi::AnyConfigurableChannel;
#[cfg(feature = "nice-nano")]
use embassy_nrf::saadc::VddhDiv5Input;
#[cfg(feature = "uf2")]
use embassy_nrf::saadc::{AnyInput, Input as _};
use embassy_nrf::{
    Peri, Peripherals,
    gpio::{AnyPin, Input, Level, Output, OutputDrive, Pull},
    gpiote::{Channel, OutputChannel, OutputChannelPolarity},
    peripherals,
};
use shared::intent::MAX_CLASSES;

#[cfg(feature = "uf2")]
pub use board::DIVIDER;
pub use board::LED_ON;

struct Pins {
    /// Pins of the intents, in class order: relax, open, close, wave-in, wave-out, pinch.
    intents: [Peri<'static, AnyPin>; MAX_CLASSES],
    valid: Peri<'static, AnyPin>,
    /// Pulses of the strength.
    strength: Peri<'static, AnyPin>,
    /// LEDs: the label is valid; an armband streams; what an alignment does.
    leds: [Peri<'static, AnyPin>; 3],
    button: Peri<'static, AnyPin>,
    tx: Peri<'static, AnyPin>,
    rx: Peri<'static, AnyPin>,
    #[cfg(feature = "uf2")]
    battery: AnyInput<'static>,
    /// Keeps what it is measured by in use.
    #[cfg(feature = "uf2")]
    divider: Option<Output<'static>>,
}

/// The peripherals and pins of the program, by purpose.
pub struct Wiring {
    /// Pins of the intents, in class order: relax, open, close, wave-in, wave-out, pinch.
    pub intents: [OutputChannel<'static>; MAX_CLASSES],
    /// High while the label is valid.
    pub valid: OutputChannel<'static>,
    /// Pulses of the strength.
    pub drive: super::drive::Parts,
    pub valid_led: Output<'static>,
    pub armband_led: Output<'static>,
    /// LED: what an alignment does.
    pub alignment_led: Output<'static>,
    /// Button: begins an alignment. Connects the pin to ground while it is down.
    pub button: Input<'static>,
    /// The UART of labels and commands, 115200 8N1.
    pub uart: super::uart::Parts,
    pub radio: super::RadioParts,
    #[cfg(feature = "uf2")]
    pub battery: super::battery::Parts,
    /// The dead-man timer and its connections to the pins.
    pub dead_man: super::dead_man::Parts,
    /// Connects it to USB.
    #[cfg(feature = "uf2")]
    pub release: Peri<'static, AnyConfigurableChannel>,
    pub watchdog: Peri<'static, peripherals::WDT>,
}

/// Configures every pin, outputs at their safe levels.
pub fn wire(p: Peripherals) -> Wiring {
    let pins = board::pins!(p);
    let [valid_led, armband_led, alignment_led] = pins
        .leds
        .map(|pin| Output::new(pin, level_of_led(false), OutputDrive::Standard));
    let [relax, open, close, wave_in, wave_out, pinch] = pins.intents;
    Wiring {
        intents: [
            output(p.GPIOTE_CH0, relax, Level::High),
            output(p.GPIOTE_CH1, open, Level::Low),
            output(p.GPIOTE_CH2, close, Level::Low),
            output(p.GPIOTE_CH3, wave_in, Level::Low),
            output(p.GPIOTE_CH4, wave_out, Level::Low),
            output(p.GPIOTE_CH5, pinch, Level::Low),
        ],
        valid: output(p.GPIOTE_CH6, pins.valid, Level::Low),
        drive: super::drive::Parts {
            pwm: p.PWM0,
            pin: pins.strength,
        },
        dead_man: super::dead_man::Parts {
            timer: p.TIMER1,
            links: [
                p.PPI_CH0.into(),
                p.PPI_CH1.into(),
                p.PPI_CH2.into(),
                p.PPI_CH3.into(),
            ],
        },
        #[cfg(feature = "uf2")]
        release: p.PPI_CH6.into(),
        valid_led,
        armband_led,
        alignment_led,
        button: Input::new(pins.button, Pull::Up),
        uart: super::uart::Parts {
            uart: p.UARTE0,
            tx: pins.tx,
            rx: pins.rx,
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
            #[cfg(feature = "uf2")]
            usb: p.USBD,
        },
        #[cfg(feature = "uf2")]
        battery: super::battery::Parts {
            converter: p.SAADC,
            input: pins.battery,
            _divider: pins.divider,
        },
        watchdog: p.WDT,
    }
}

pub fn level_of_led(on: bool) -> Level {
    Level::from(on == (LED_ON == Level::High))
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
