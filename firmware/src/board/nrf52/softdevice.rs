//! Bluetooth by Nordic's SoftDevice, which is flashed once and lies below the program.

use embassy_executor::Spawner;
use nrf_softdevice::{Config, Softdevice, raw};

use crate::radio::{self, follow::Follower};

/// The SoftDevice needs none of the program's peripherals.
pub struct RadioParts {}

/// Follows the armband for ever.
///
/// # Panics
///
/// If the RAM that `memory.x` leaves the SoftDevice does not hold what is asked of it here; its
/// log says the least start address.
pub async fn run_radio(spawner: Spawner, _: RadioParts, follower: &Follower<'_>) {
    let config = Config {
        clock: Some(raw::nrf_clock_lf_cfg_t {
            // The kits' crystal; a board without one takes NRF_CLOCK_LF_SRC_RC, 16, 2, 500 ppm.
            source: raw::NRF_CLOCK_LF_SRC_XTAL as u8,
            rc_ctiv: 0,
            rc_temp_ctiv: 0,
            accuracy: raw::NRF_CLOCK_LF_ACCURACY_20_PPM as u8,
        }),
        conn_gap: Some(raw::ble_gap_conn_cfg_t {
            conn_count: 1,
            // Units of 1.25 ms: all of a 15 ms interval, so that a late armband catches up at once.
            event_length: 12,
        }),
        // The armband has no larger one, and asking for it would cost an exchange.
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
    match run_softdevice(softdevice) {
        Ok(task) => spawner.spawn(task),
        Err(_) => defmt::panic!("the SoftDevice's task runs already"),
    }
    radio::softdevice::run(softdevice, follower).await;
}

#[embassy_executor::task]
async fn run_softdevice(softdevice: &'static Softdevice) -> ! {
    softdevice.run().await
}
