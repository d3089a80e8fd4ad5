//! USB: the lines and commands of the UART on a serial port (CDC-ACM) of the host.
//!
//! It needs the high-frequency crystal, which the radio's start has requested. Lines wait in [`LINES`]; the host waits while
//! its bytes are not taken.

use core::fmt::Write as _;

use embassy_executor::Spawner;
use embassy_futures::{
    join::join3,
    select::{Either, select},
};
use embassy_nrf::{
    interrupt::{self, InterruptExt as _, Priority},
    pac,
    usb::{Driver, vbus_detect::HardwareVbusDetect},
};
use embassy_sync::{blocking_mutex::raw::CriticalSectionRawMutex, pipe::Pipe};
use embassy_time::{Duration, Timer};
use embassy_usb::{
    Builder, Config, Handler, UsbDevice,
    class::cdc_acm::{CdcAcmClass, ControlChanged, Receiver, Sender, State},
};
use heapless::String;
use shared::uart_line::USB_NUMBERS;
use static_cell::{ConstStaticCell, StaticCell};

use crate::messages::usb::LINES;

/// Bytes of a packet: the most at full speed.
const PACKET: usize = 64;
/// Time in which the host's request to close the port ends.
const ENDING: Duration = Duration::from_millis(20);

type UsbDriver = Driver<'static, HardwareVbusDetect>;

/// Received bytes.
pub static RECEIVED: Pipe<CriticalSectionRawMutex, { 4 * PACKET }> = Pipe::new();

/// Starts it. To be called once.
///
/// # Panics
/// If it is called again.
pub fn start(spawner: Spawner, driver: UsbDriver) {
    static CONFIGURATION: ConstStaticCell<[u8; 96]> = ConstStaticCell::new([0; 96]);
    static CAPABILITIES: ConstStaticCell<[u8; 16]> = ConstStaticCell::new([0; 16]);
    static CONTROL: ConstStaticCell<[u8; PACKET]> = ConstStaticCell::new([0; PACKET]);
    static NUMBER: StaticCell<String<16>> = StaticCell::new();
    static STATE: StaticCell<State<'static>> = StaticCell::new();
    static CABLE: ConstStaticCell<Cable> = ConstStaticCell::new(Cable);

    interrupt::USBD.set_priority(Priority::P3);
    // The chip's own number.
    let [high, low] = [0, 1].map(|word| pac::FICR.deviceid(word).read());
    let number = NUMBER.init(String::new());
    let _ = write!(number, "{high:08X}{low:08X}");
    let [vendor, product] = USB_NUMBERS;
    let mut config = Config::new(vendor, product);
    config.manufacturer = Some("myointent");
    config.product = Some("myointent");
    config.serial_number = Some(number.as_str());
    // The battery.
    config.self_powered = true;
    let mut builder = Builder::new(
        driver,
        config,
        CONFIGURATION.take(),
        CAPABILITIES.take(),
        &mut [],
        CONTROL.take(),
    );
    builder.handler(CABLE.take());
    let class = CdcAcmClass::new(&mut builder, STATE.init(State::new()), PACKET as u16);
    match run(builder.build(), class) {
        Ok(task) => spawner.spawn(task),
        Err(_) => panic!("USB runs already"),
    }
}

/// The cable. The driver waits in a loop for a packet that it gives to a controller that is switched off, until the watchdog
/// restarts the board: so it gets no packet once the cable is pulled.
struct Cable;

impl Handler for Cable {
    fn enabled(&mut self, is_plugged: bool) {
        LINES.set_plugged(is_plugged);
    }
}

#[embassy_executor::task]
async fn run(mut device: UsbDevice<'static, UsbDriver>, class: CdcAcmClass<'static, UsbDriver>) {
    let (sender, receiver, control) = class.split_with_control();
    join3(device.run(), send(sender), receive(receiver, control)).await;
}

/// Sends lines while the host is there.
async fn send(mut sender: Sender<'static, UsbDriver>) {
    let mut packet = [0; PACKET];
    loop {
        sender.wait_connection().await;
        let count = LINES.take(&mut packet).await;
        let bytes = packet.get(..count).unwrap_or_default();
        // Unplugged, or a reset of the bus: the rest of the line goes to the next host, which finds the line behind it.
        let is_sent = sender.write_packet(bytes).await.is_ok();
        // The host waits for the end of what a full packet begins.
        if is_sent && count == PACKET && LINES.is_empty() {
            let _ = sender.write_packet(&[]).await;
        }
    }
}

/// Receives commands while the host is there, and what it says of its port: it may ask for the boot loader.
async fn receive(mut receiver: Receiver<'static, UsbDriver>, control: ControlChanged<'static>) {
    let mut packet = [0; PACKET];
    loop {
        let reading = async {
            receiver.wait_connection().await;
            receiver.read_packet(&mut packet).await
        };
        // The dropped future loses nothing: a packet stays in the endpoint until it is read, a change is a flag.
        match select(reading, control.control_changed()).await {
            Either::First(Ok(count)) => {
                let bytes = packet.get(..count).unwrap_or_default();
                RECEIVED.write_all(bytes).await;
            }
            Either::First(Err(_)) => {}
            Either::Second(()) => {
                if LINES.set_port(control.dtr(), receiver.line_coding().data_rate()) {
                    Timer::after(ENDING).await;
                    super::enter_boot_loader();
                }
            }
        }
    }
}
