//! USB: the lines and commands of the UART on a serial port (CDC-ACM) of the host, and, where that is switched on, a keyboard,
//! mouse or gamepad (HID).
//!
//! It needs the high-frequency crystal, which the radio's start has requested. Lines wait in [`LINES`]; the host waits while
//! its bytes are not taken.

use core::cell::Cell;
use core::fmt::Write as _;
use core::future::{pending, poll_fn};
use core::pin::pin;
use core::task::Poll;

use embassy_executor::Spawner;
use embassy_futures::{
    join::{join, join3},
    select::{Either, select},
};
use embassy_nrf::{
    Peri,
    interrupt::{self, InterruptExt as _, Priority},
    pac,
    peripherals::USBD,
    usb::{Driver, vbus_detect::HardwareVbusDetect},
};
use embassy_sync::{blocking_mutex::raw::CriticalSectionRawMutex, pipe::Pipe};
use embassy_time::{Duration, Timer, with_timeout};
use embassy_usb::{
    Builder, Config, Handler,
    class::{
        cdc_acm::{self, CdcAcmClass, ControlChanged, Receiver, Sender},
        hid::{self, HidBootProtocol, HidSubclass, HidWriter},
    },
};
use heapless::String;
use shared::hid::{DESCRIPTOR_BYTES, REPORT_BYTES, Reporter, descriptor};
use shared::uart_line::USB_NUMBERS;

use super::{controller::Interrupts, release};
use crate::hid_region;
use crate::messages::{hid as outputs, usb::LINES};

/// Bytes of a packet: the most at full speed.
const PACKET: usize = 64;
/// Time in which the host's request to close the port ends, and an answer goes out before the board leaves the bus.
const ENDING: Duration = Duration::from_millis(20);
/// Time for which a board is off the bus when its devices change: hosts take less for a bad contact.
const ABSENCE: Duration = Duration::from_millis(500);
/// Interval in which the host asks for a report.
const POLL_MS: u8 = 1;
/// Time in which it has taken one.
const TAKEN: Duration = Duration::from_millis(10 * POLL_MS as u64);
/// Interval between two reports of a movement.
const MOVEMENT: Duration = Duration::from_millis(10);

type UsbDriver<'d> = Driver<'d, HardwareVbusDetect>;

pub static RECEIVED: Pipe<CriticalSectionRawMutex, { 4 * PACKET }> = Pipe::new();

/// Starts it. To be called once.
///
/// # Panics
/// If it is called again.
pub fn start(spawner: Spawner, usb: Peri<'static, USBD>) {
    interrupt::USBD.set_priority(Priority::P3);
    outputs::set(hid_region::load());
    match run(usb) {
        Ok(task) => spawner.spawn(task),
        Err(_) => panic!("USB runs already"),
    }
}

#[embassy_executor::task]
async fn run(mut usb: Peri<'static, USBD>) {
    loop {
        run_once(usb.reborrow()).await;
        Timer::after(ABSENCE).await;
    }
}

/// Runs until the computer is to see other devices.
async fn run_once(usb: Peri<'_, USBD>) {
    let (mut configuration, mut capabilities, mut control) = ([0; 128], [0; 16], [0; PACKET]);
    let (mut port, mut hid) = (cdc_acm::State::new(), hid::State::new());
    let mut description = [0; DESCRIPTOR_BYTES];
    // The chip's own number.
    let [high, low] = [0, 1].map(|word| pac::FICR.deviceid(word).read());
    let mut number = String::<16>::new();
    let _ = write!(number, "{high:08X}{low:08X}");
    let bus = Bus::default();
    let mut cable = Cable(&bus);

    let [vendor, product] = USB_NUMBERS;
    let mut config = Config::new(vendor, product);
    config.manufacturer = Some("myointent");
    config.product = Some("myointent");
    config.serial_number = Some(number.as_str());
    // The battery.
    config.self_powered = true;
    let driver = Driver::new(usb, Interrupts, HardwareVbusDetect::new(Interrupts));
    let mut builder = Builder::new(
        driver,
        config,
        &mut configuration,
        &mut capabilities,
        &mut [],
        &mut control,
    );
    builder.handler(&mut cable);
    let class = CdcAcmClass::new(&mut builder, &mut port, PACKET as u16);
    let devices = outputs::settings().devices();
    let writer = devices.contains(&true).then(|| {
        let config = hid::Config {
            report_descriptor: descriptor(devices, &mut description),
            request_handler: None,
            poll_ms: POLL_MS,
            max_packet_size: 16,
            hid_subclass: HidSubclass::No,
            hid_boot_protocol: HidBootProtocol::None,
        };
        HidWriter::new(&mut builder, &mut hid, config)
    });
    let mut device = builder.build();
    let (sender, receiver, changes) = class.split_with_control();
    let classes = join3(
        send(sender),
        receive(receiver, changes),
        report(writer, &bus),
    );
    let other_devices = async {
        outputs::devices_change(devices).await;
        Timer::after(ENDING).await;
    };
    let running = join(device.run(), bus.while_in_use(classes));
    select(running, other_devices).await;
    device.disable().await;
}

/// State of the bus. An endpoint is touched only while the host uses it: the driver waits in a loop for a packet that it gives to
/// a controller that is switched off or sleeps, until the watchdog restarts the board.
#[derive(Default)]
struct Bus {
    is_configured: Cell<bool>,
    is_suspended: Cell<bool>,
    /// Whether to release what is pressed: the host has gone, or sleeps.
    interrupted: Cell<bool>,
}

impl Bus {
    /// Polls a future while the host is there. What wakes the device of the same task wakes it.
    async fn while_in_use(&self, future: impl Future) {
        let mut future = pin!(future);
        poll_fn(|context| {
            if self.is_configured.get() && !self.is_suspended.get() {
                future.as_mut().poll(context).map(drop)
            } else {
                Poll::Pending
            }
        })
        .await;
    }

    fn set(&self, is_configured: bool, is_suspended: bool) {
        self.is_configured.set(is_configured);
        self.is_suspended.set(is_suspended);
        release::arm(None);
        self.interrupted.set(true);
        outputs::wake();
    }
}

/// The cable, and the host at its other end.
struct Cable<'b>(&'b Bus);

impl Handler for Cable<'_> {
    fn enabled(&mut self, is_plugged: bool) {
        LINES.set_plugged(is_plugged);
        self.0.set(false, false);
    }

    fn reset(&mut self) {
        self.0.set(false, false);
    }

    fn configured(&mut self, is_configured: bool) {
        self.0.set(is_configured, false);
    }

    fn suspended(&mut self, is_suspended: bool) {
        self.0.set(self.0.is_configured.get(), is_suspended);
    }
}

/// Sends reports of what is pressed.
async fn report<'d>(writer: Option<HidWriter<'d, UsbDriver<'d>, REPORT_BYTES>>, bus: &Bus) {
    let Some(mut writer) = writer else {
        return pending().await;
    };
    let mut reporter = Reporter::default();
    loop {
        if release::has_fired() {
            // The endpoint has a report, which the driver does not know of.
            release::arm(None);
            Timer::after(TAKEN).await;
            reporter.interrupt();
        }
        if bus.interrupted.take() {
            reporter.interrupt();
        }
        while let Some(report) = reporter.next(outputs::wanted()) {
            let is_sent = writer.write(report.bytes()).await.is_ok();
            release::arm(reporter.release());
            if !is_sent {
                // A reset of the bus.
                writer.ready().await;
                reporter.interrupt();
            }
        }
        match reporter.repeated() {
            None => outputs::changed().await,
            Some(report) => {
                if with_timeout(MOVEMENT, outputs::changed()).await.is_err() {
                    // After a reset of the bus there is nothing to repeat.
                    let _ = writer.write(report.bytes()).await;
                    release::arm(reporter.release());
                }
            }
        }
    }
}

/// Sends lines while the host is there.
async fn send<'d>(mut sender: Sender<'d, UsbDriver<'d>>) {
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
async fn receive<'d>(mut receiver: Receiver<'d, UsbDriver<'d>>, control: ControlChanged<'d>) {
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
