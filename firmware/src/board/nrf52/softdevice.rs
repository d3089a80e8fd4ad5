//! Bluetooth with Nordic's SoftDevice, which is flashed once, at the addresses below the program.

use core::ptr;

use embassy_executor::Spawner;
use nrf_softdevice::{Config, Softdevice, raw};

use super::chip_flash::ChipFlash;
use crate::installation;
use crate::messages::uart::{self, UartMessage};
use crate::radio::{self, driver::SessionDriver};
use crate::settings::{SLOW_CLOCK, SlowClock};

/// The SoftDevice needs none of the program's peripherals.
pub struct RadioParts {}

/// Runs the Myo session forever.
///
/// # Panics
///
/// If there is a SoftDevice of another major version, if this configuration needs more RAM than `memory.x` leaves the SoftDevice (the log says where the program's RAM has to
/// start at least), or if the SoftDevice refuses the crystal.
pub async fn run_radio(spawner: Spawner, _: RadioParts, driver: &SessionDriver<'_>) {
    check_version();
    let config = Config {
        clock: Some(match SLOW_CLOCK {
            SlowClock::Crystal => raw::nrf_clock_lf_cfg_t {
                source: raw::NRF_CLOCK_LF_SRC_XTAL as u8,
                rc_ctiv: 0,
                rc_temp_ctiv: 0,
                accuracy: raw::NRF_CLOCK_LF_ACCURACY_20_PPM as u8,
            },
            SlowClock::Oscillator => raw::nrf_clock_lf_cfg_t {
                source: raw::NRF_CLOCK_LF_SRC_RC as u8,
                rc_ctiv: SlowClock::CALIBRATION_INTERVAL,
                rc_temp_ctiv: SlowClock::MOST_SKIPPED,
                accuracy: raw::NRF_CLOCK_LF_ACCURACY_500_PPM as u8,
            },
        }),
        conn_gap: Some(raw::ble_gap_conn_cfg_t {
            conn_count: 1,
            // Units of 1.25 ms: the whole of a 15 ms interval, so that delayed notifications are
            // sent in one connection event.
            event_length: 12,
        }),
        // The armband supports no larger one, so an exchange would gain nothing.
        conn_gatt: Some(raw::ble_gatt_conn_cfg_t { att_mtu: 23 }),
        gap_role_count: Some(raw::ble_gap_cfg_role_count_t {
            adv_set_count: 0,
            periph_role_count: 0,
            central_role_count: 1,
            central_sec_count: 0,
            _bitfield_1: raw::ble_gap_cfg_role_count_t::new_bitfield_1(0),
        }),
        ..Config::default()
    };
    let softdevice: &Softdevice = Softdevice::enable(&config);
    keep_crystal_on();
    uart::enqueue(UartMessage::SlowClock(SLOW_CLOCK));
    match run_softdevice(softdevice) {
        Ok(task) => spawner.spawn(task),
        Err(_) => panic!("the SoftDevice's task runs already"),
    }
    // Between radio events.
    let flash = ChipFlash(nrf_softdevice::Flash::take(softdevice));
    installation::beside(flash, async |flash| {
        radio::softdevice::run(softdevice, driver, flash).await;
    })
    .await;
}

/// Panics if the SoftDevice has another major version: its calls take other arguments.
#[expect(unsafe_code, reason = "the version is no Rust object")]
fn check_version() {
    let address = (raw::MBR_SIZE + raw::SD_VERSION_OFFSET) as usize;
    // SAFETY: a word of flash, which every chip has, below the program; no section of the program is placed in it, and it does
    // not change while the program runs. Any word is a valid `u32`.
    let version = unsafe { ptr::with_exposed_provenance::<u32>(address).read_volatile() };
    let [major, minor, bugfix] = [version / 1_000_000, version / 1000 % 1000, version % 1000];
    let expected = raw::SD_MAJOR_VERSION;
    if major != expected {
        panic!(
            "SoftDevice {major}.{minor}.{bugfix} is here, expected {expected}.x: docs/guides/flash.md"
        );
    }
}

/// Keeps the high-frequency crystal on. Between radio events the UART and the dead-man timer would otherwise run on the
/// chip's own oscillator, which is up to 8 % off (nRF52840 product specification, HFINT).
#[expect(
    unsafe_code,
    reason = "the library has no function of its own for this supervisor call"
)]
fn keep_crystal_on() {
    // SAFETY: the call takes no arguments, and the SoftDevice is enabled: the caller has it from `Softdevice::enable`.
    let answer = unsafe { raw::sd_clock_hfclk_request() };
    if answer != raw::NRF_SUCCESS {
        panic!("the SoftDevice refused the crystal: {answer}");
    }
}

#[embassy_executor::task]
async fn run_softdevice(softdevice: &'static Softdevice) -> ! {
    softdevice.run().await
}
