//! Bluetooth with Nordic's controller library linked into the program: no SoftDevice to flash.

use embassy_executor::Spawner;
use embassy_nrf::{
    Peri, bind_interrupts,
    mode::Blocking,
    pac,
    peripherals::{NVMC, RNG},
    rng,
};
use nrf_mpsl::{MultiprotocolServiceLayer, SessionMem};
use nrf_sdc::{Builder, Mem, SoftdeviceController};
use static_cell::StaticCell;

use super::chip_flash::ChipFlash;
use crate::installation;
use crate::messages::uart::{self, UartMessage};
use crate::radio::{driver::SessionDriver, trouble};
use crate::settings::{SLOW_CLOCK, SlowClock};

bind_interrupts!(pub(super) struct Interrupts {
    EGU0_SWI0 => nrf_mpsl::LowPrioInterruptHandler;
    CLOCK_POWER => nrf_mpsl::ClockInterruptHandler, #[cfg(feature = "uf2")] embassy_nrf::usb::vbus_detect::InterruptHandler;
    #[cfg(feature = "uf2")]
    USBD => embassy_nrf::usb::InterruptHandler<embassy_nrf::peripherals::USBD>;
    RADIO => nrf_mpsl::HighPrioInterruptHandler;
    TIMER0 => nrf_mpsl::HighPrioInterruptHandler;
    RTC0 => nrf_mpsl::HighPrioInterruptHandler;
});

/// Bytes of the L2CAP packet of an armband's notification, and packets that are buffered: 200 ms.
const RECEIVE_BYTES: u16 = 27;
const RECEIVE_COUNT: u8 = 20;
const SEND_BYTES: u16 = 27;
const SEND_COUNT: u8 = 3;
/// Memory that the controller is given; it refuses to start with less than it needs.
const CONTROLLER_BYTES: usize = 3584;
const _: () = assert!(
    NEEDED_BYTES <= CONTROLLER_BYTES,
    "the controller would not start"
);

/// Links as a central and as a peripheral. Of each the library has one unless it is told otherwise
/// (`SDC_DEFAULT_CENTRAL_COUNT`, `SDC_DEFAULT_PERIPHERAL_COUNT`).
const CENTRAL_COUNT: u8 = 1;
const PERIPHERAL_COUNT: u8 = 0;
/// Upper bound of the controller's memory, by the macros of `sdc.h`: `SDC_MEM_PER_CENTRAL_LINK`, `SDC_MEM_PER_PERIPHERAL_LINK`,
/// `SDC_MEM_SCAN` and `SDC_MEM_FAL` with their defaults, `SDC_MEM_INITIATOR`. bindgen translates no macros with arguments.
const NEEDED_BYTES: usize = {
    // Those beyond the first one in each direction, each with 15 bytes of its own.
    let buffers = (SEND_BYTES as usize + 15) * (SEND_COUNT as usize - 1)
        + (RECEIVE_BYTES as usize + 15) * (RECEIVE_COUNT as usize - 1);
    let central = CENTRAL_COUNT as usize * (803 + buffers) + 21;
    let peripheral = PERIPHERAL_COUNT as usize * (923 + buffers + 17);
    let (scan, accept_list, initiator) = (408 + 3 * 104, 4 + 8 * 8, 384);
    central + peripheral + scan + accept_list + initiator
};

/// The peripherals that the library uses.
pub struct RadioParts {
    pub(super) mpsl: nrf_mpsl::Peripherals<'static>,
    pub(super) controller: nrf_sdc::Peripherals<'static>,
    pub(super) random: Peri<'static, RNG>,
    pub(super) flash: Peri<'static, NVMC>,
    #[cfg(feature = "uf2")]
    pub(super) usb: Peri<'static, embassy_nrf::peripherals::USBD>,
}

/// Runs the Myo session forever.
///
/// # Panics
///
/// If the library refuses its peripherals or the high-frequency crystal, or needs more than [`CONTROLLER_BYTES`].
pub async fn run_radio(spawner: Spawner, parts: RadioParts, driver: &SessionDriver<'_>) {
    static MPSL: StaticCell<MultiprotocolServiceLayer<'static>> = StaticCell::new();
    static FLASH_SESSION: StaticCell<SessionMem<1>> = StaticCell::new();
    static RANDOM: StaticCell<rng::Rng<'static, Blocking>> = StaticCell::new();
    static MEMORY: StaticCell<Mem<CONTROLLER_BYTES>> = StaticCell::new();

    let clock = nrf_mpsl::raw::mpsl_clock_lfclk_cfg_t {
        source: nrf_mpsl::raw::MPSL_CLOCK_LF_SRC_RC as u8,
        rc_ctiv: SlowClock::CALIBRATION_INTERVAL,
        rc_temp_ctiv: SlowClock::MOST_SKIPPED,
        accuracy_ppm: SlowClock::OSCILLATOR_PPM,
        skip_wait_lfclk_started: false,
    };
    let session = FLASH_SESSION.init(SessionMem::new());
    let mpsl = MultiprotocolServiceLayer::with_timeslots(parts.mpsl, Interrupts, clock, session);
    let mpsl = match mpsl {
        Ok(mpsl) => &*MPSL.init(mpsl),
        Err(error) => panic!("the radio's scheduler did not start: {error:?}"),
    };
    uart::enqueue(UartMessage::SlowClock(SLOW_CLOCK));
    match run_mpsl(mpsl) {
        Ok(task) => spawner.spawn(task),
        Err(_) => panic!("the radio's scheduler runs already"),
    }
    // Kept on for good: between radio events the UART and the dead-man timer would otherwise run on the chip's own oscillator,
    // which is up to 8 % off (nRF52840 product specification, HFINT).
    let _crystal = match mpsl.request_hfclk().await {
        Ok(crystal) => crystal,
        Err(error) => panic!("the crystal did not start: {error:?}"),
    };
    #[cfg(feature = "uf2")]
    {
        super::usb::start(spawner, parts.usb);
    }
    let random = RANDOM.init(rng::Rng::new_blocking(parts.random));
    let memory = MEMORY.init(Mem::new());
    let controller = match build(parts.controller, random, mpsl, memory) {
        Ok(controller) => controller,
        Err(error) => panic!("the Bluetooth controller did not start: {error:?}"),
    };
    // In time slots that the radio's scheduler grants.
    let flash = ChipFlash(nrf_mpsl::Flash::take(mpsl, parts.flash));
    installation::beside(flash, async |flash| {
        trouble::run(controller, own_address(), driver, flash).await;
    })
    .await;
}

fn build(
    peripherals: nrf_sdc::Peripherals<'static>,
    random: &'static mut rng::Rng<'static, Blocking>,
    mpsl: &'static MultiprotocolServiceLayer<'static>,
    memory: &'static mut Mem<CONTROLLER_BYTES>,
) -> Result<SoftdeviceController<'static>, nrf_sdc::Error> {
    Builder::new()?
        .support_central()
        // The host ends a scan, or an attempt to connect, later than it begins the next: neither may be refused until then.
        .support_parallel_scanning_and_initiating()
        .central_count(CENTRAL_COUNT)?
        .peripheral_count(PERIPHERAL_COUNT)?
        .buffer_cfg(SEND_BYTES, RECEIVE_BYTES, SEND_COUNT, RECEIVE_COUNT)?
        .build(peripherals, random, mpsl, memory)
}

/// The random static address that Nordic programs into every chip.
fn own_address() -> [u8; 6] {
    let [a, b, c, d] = pac::FICR.deviceaddr(0).read().to_le_bytes();
    let [e, f, ..] = pac::FICR.deviceaddr(1).read().to_le_bytes();
    [a, b, c, d, e, f | 0xc0]
}

#[embassy_executor::task]
async fn run_mpsl(mpsl: &'static MultiprotocolServiceLayer<'static>) -> ! {
    mpsl.run().await
}
