//! The nRF52840 and the nRF52832, on the boards of [`wiring`].

#[cfg(feature = "uf2")]
mod battery;
mod chip_flash;
#[cfg(feature = "radio-trouble")]
mod controller;
mod dead_man;
mod drive;
#[cfg(feature = "nrf52832")]
mod errata;
#[cfg(feature = "uf2")]
mod release;
#[cfg(feature = "radio-softdevice")]
mod softdevice;
mod uart;
#[cfg(feature = "uf2")]
mod usb;
mod wiring;

use core::{cell::RefCell, fmt};

use critical_section::Mutex;
use defmt_rtt as _;
use embassy_nrf::{
    gpio::{Input, Output},
    gpiote::OutputChannel,
    interrupt::Priority,
    pac, peripherals,
    ppi::Event,
    wdt,
};
use shared::intent::{Intent, MAX_CLASSES};

use super::Board;
use crate::messages::pin_state::PinState;
use crate::reset_reason::{End, ResetReason, keep_end, previous_end};
use crate::settings::{PULSES, WATCHDOG_MS};
#[cfg(feature = "radio-trouble")]
pub use controller::{RadioParts, run_radio};
#[cfg(feature = "radio-softdevice")]
pub use softdevice::{RadioParts, run_radio};

#[cfg(feature = "uf2")]
pub use battery::Battery;
pub use dead_man::DeadMan;
use drive::Drive;
pub use uart::{CommandPort, LabelPort};

/// Bits of RESETREAS (nRF52840 product specification, section 5.3.7.9).
const RESET_BY_PIN: u32 = 1 << 0;
const RESET_BY_WATCHDOG: u32 = 1 << 1;
const RESET_BY_SOFTWARE: u32 = 1 << 2;

/// Takes the peripherals and sets all outputs to their safe levels.
pub fn start() -> Board {
    #[cfg(feature = "uf2")]
    take_vectors();
    #[cfg(feature = "nrf52832")]
    errata::work_around();
    let mut config = embassy_nrf::config::Config::default();
    // The SoftDevices reserve the priorities 0, 1 and 4, and refuse to start if an interrupt of the
    // program has one of them.
    config.gpiote_interrupt_priority = Priority::P2;
    config.time_interrupt_priority = Priority::P2;
    // The slow clock starts from the chip's oscillator, in less than a millisecond. A crystal may never start: nothing may wait
    // for it before the pins are safe and the watchdog runs.
    config.lfclk_source = embassy_nrf::config::LfclkSource::InternalRC;
    // The battery is at VDDH. Boot loaders set this; pins have 1.8 V if none did.
    #[cfg(feature = "nice-nano")]
    {
        config.dcdc.reg0_voltage = Some(embassy_nrf::config::Reg0Voltage::_3V3);
    }
    // Instructions from flash would wait otherwise. Before the SoftDevice, which reserves the register.
    pac::NVMC.icachecnf().write(|cache| cache.set_cacheen(true));
    let peripherals = embassy_nrf::init(config);
    let wiring = wiring::wire(peripherals);
    let drive = Drive::start(wiring.drive);
    let dead_man = DeadMan::start(
        wiring.dead_man,
        &wiring.intents,
        &wiring.valid,
        drive.stop_task(),
    );
    let outputs = Outputs {
        expired: dead_man.expired(),
        intents: wiring.intents,
        valid: wiring.valid,
        drive,
        valid_led: wiring.valid_led,
        armband_led: wiring.armband_led,
        alignment_led: wiring.alignment_led,
    };
    #[cfg(feature = "uf2")]
    release::start(wiring.release, dead_man.expired());
    critical_section::with(|section| OUTPUTS.borrow(section).replace(Some(outputs)));
    let watchdog = Watchdog::start(wiring.watchdog);

    let (labels, commands) = uart::start(wiring.uart);
    Board {
        labels,
        commands,
        pins: Pins(()),
        button: Button(wiring.button),
        radio: wiring.radio,
        watchdog,
        dead_man,
        #[cfg(feature = "uf2")]
        battery: Battery::start(wiring.battery),
        reset_reason: reset_reason(),
    }
}

/// Makes the core take exceptions to the program's own vectors. The boot loader leaves those of the master boot record at 0,
/// which forwards them, unless one starts the program in another way.
#[cfg(feature = "uf2")]
#[expect(unsafe_code, reason = "the register is no Rust object")]
fn take_vectors() {
    unsafe extern "C" {
        static __vector_table: u32;
    }
    let vectors = (&raw const __vector_table) as u32;
    // SAFETY: the table is the linked image's, complete and constant, at 0x1000 and so aligned to more than its length. No
    // interrupt is enabled yet, and an exception has the same handler by either table.
    unsafe { (*cortex_m::peripheral::SCB::PTR).vtor.write(vectors) };
}

/// Must be called before the SoftDevice is enabled, which reserves the register.
fn reset_reason() -> ResetReason {
    let reasons = pac::POWER.resetreas().read();
    // Bits stay set over resets until a one is written to them.
    pac::POWER.resetreas().write_value(reasons);
    let end = previous_end();
    match reasons.0 {
        // First: the pin may set the other bits too (nRF52840 erratum 136, nRF52832 erratum 136).
        bits if bits & RESET_BY_PIN != 0 => ResetReason::Power,
        bits if bits & RESET_BY_WATCHDOG != 0 => ResetReason::Watchdog,
        bits if bits & RESET_BY_SOFTWARE != 0 && end == End::StackOverflow => {
            ResetReason::StackOverflow
        }
        // A blank chip is reset once, before the program has run, to set its registers in UICR.
        bits if bits & RESET_BY_SOFTWARE != 0 && end != End::Unknown => ResetReason::Software,
        _ => ResetReason::Power,
    }
}

/// Every output. Static, so that the panic handler can set them.
static OUTPUTS: Mutex<RefCell<Option<Outputs>>> = Mutex::new(RefCell::new(None));

struct Outputs {
    intents: [OutputChannel<'static>; MAX_CLASSES],
    valid: OutputChannel<'static>,
    /// Pulses of the strength.
    drive: Drive,
    expired: Event<'static>,
    valid_led: Output<'static>,
    armband_led: Output<'static>,
    alignment_led: Output<'static>,
}

impl Outputs {
    fn set(&mut self, state: PinState) {
        let status = state.status;
        let valid = status.valid();
        self.drive.set(PULSES.high_us(status, state.strength));
        if !valid {
            self.valid.clear();
        }
        let label = status.label();
        for (intent, pin) in Intent::ALL.into_iter().zip(&self.intents) {
            if intent != label {
                pin.clear();
            }
        }
        if let Some(pin) = self.intents.get(label.class()) {
            pin.set();
        }
        if valid {
            self.valid.set();
        }
    }
}

pub struct Pins(());

impl Pins {
    /// Sets every level, within a few microseconds. A driver may act on two pins at once (both halves of a bridge), so
    /// the old label's pin falls before the new one's rises. `valid` falls before them and rises after them; between two
    /// valid labels it stays high.
    pub fn set(&mut self, state: PinState) {
        set_outputs(state);
    }
}

fn set_outputs(state: PinState) {
    critical_section::with(|section| {
        let Ok(mut outputs) = OUTPUTS.borrow(section).try_borrow_mut() else {
            return;
        };
        let Some(outputs) = outputs.as_mut() else {
            return;
        };
        let safe = PinState::SAFE;
        let expired = outputs.expired.is_triggered();
        outputs.set(if expired { safe } else { state });
        // It may have expired since, and then some pin was set after it.
        if outputs.expired.is_triggered() {
            outputs.set(safe);
        }
        let valid = state.status.valid() && !outputs.expired.is_triggered();
        #[cfg(feature = "uf2")]
        crate::messages::hid::show(if valid { state } else { safe });
        outputs.valid_led.set_level(wiring::level_of_led(valid));
        outputs
            .armband_led
            .set_level(wiring::level_of_led(state.armband));
        outputs
            .alignment_led
            .set_level(wiring::level_of_led(state.alignment_led));
    });
}

fn pulses_stopped() {
    critical_section::with(|section| {
        if let Ok(mut outputs) = OUTPUTS.borrow(section).try_borrow_mut()
            && let Some(outputs) = outputs.as_mut()
        {
            outputs.drive.stopped();
        }
    });
}

pub struct Button(Input<'static>);

impl Button {
    /// Whether the button is down at this moment; its contact may bounce.
    pub fn is_down(&mut self) -> bool {
        self.0.is_low()
    }
}

/// The watchdog. It keeps running over resets until power is lost.
pub struct Watchdog(());

impl Watchdog {
    fn start(peripheral: embassy_nrf::Peri<'static, peripherals::WDT>) -> Self {
        let mut config = wdt::Config::default();
        config.timeout_ticks = WATCHDOG_MS * 32_768 / 1000;
        // A debugger that halts the core must not cause a reset.
        config.action_during_debug_halt = wdt::HaltConfig::Pause;
        // One that runs already, by a boot loader or another program, cannot be configured: it is used as it is.
        let started: Result<(_, [_; 1]), _> = wdt::Watchdog::try_new(peripheral, config);
        if started.is_err() {
            defmt::info!("a watchdog runs already");
        }
        Self(())
    }

    /// Restarts the period. One that runs already may wait for any of its reload requests.
    pub fn feed(&mut self) {
        for request in 0..8 {
            let request = pac::WDT.rr(request);
            request.write(|request| request.set_rr(pac::wdt::vals::Rr::Reload));
        }
    }
}

/// Restarts into Adafruit's boot loader, which then shows its drive: `DFU_MAGIC_UF2_RESET` in its main.c.
#[cfg(feature = "uf2")]
fn enter_boot_loader() -> ! {
    const SHOW_DRIVE: u8 = 0x57;
    set_outputs(PinState::SAFE);
    pac::POWER
        .gpregret()
        .write(|register| register.set_gpregret(SHOW_DRIVE));
    cortex_m::peripheral::SCB::sys_reset();
}

/// Sets every output to its safe level and logs a message. Called with interrupts off.
pub fn enter_safe_state(message: &dyn fmt::Display, end: End) {
    set_outputs(PinState::SAFE);
    keep_end(end, message);
    defmt::error!("{}", defmt::Display2Format(message));
    // 50 ms for a debug probe to read the message before the reset clears memory: turns of three cycles at 64 MHz.
    cortex_m::asm::delay(64_000_000 / 20 / 3);
}
