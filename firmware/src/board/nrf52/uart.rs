//! The UART of labels and commands.
//!
//! The receiver needs no instruction to go on. The one of embassy-nrf 0.11 does: it ends for good where the core stands
//! still for two halves of its buffer, 11 ms, as it does for 85 ms while a page of flash is erased.
//!
//! ```text
//! byte ---> DMA ------> ring; at its end the shortcut from ENDRX starts it from the beginning
//!   +--- RXDRDY ------> TIMER2, which counts
//! ```
//!
//! The program takes what is counted. Where that is more than the ring holds, bytes were lost. After an error on the line
//! the count and the place in the ring may differ, because a byte without its stop bit is not stored and may be counted:
//! then the receiver is stopped and begins anew.

use core::future::poll_fn;
use core::sync::atomic::{AtomicU8, Ordering, compiler_fence};
use core::task::Poll;

#[cfg(feature = "uf2")]
use embassy_futures::select::{Either, select};
use embassy_nrf::{
    Peri, bind_interrupts,
    buffered_uarte::{self, BufferedUarteTx},
    gpio::{AnyPin, Input, Pin as _, Pull},
    interrupt::{self, InterruptExt as _, Priority, typelevel},
    pac::{self, uarte::vals::Enable},
    peripherals::{TIMER2, UARTE0},
    ppi::{AnyConfigurableChannel, Channel as _},
    timer,
    uarte::{Baudrate, Config, Parity},
};
use embassy_sync::waitqueue::AtomicWaker;
use embassy_time::{Duration, Timer};
use static_cell::ConstStaticCell;

use crate::board::BytesLost;

/// Bytes of the ring: on the nRF52840 under a SoftDevice 89 ms, more than a page takes to be erased. Else 22 ms: the DMA of the
/// nRF52832 counts with eight bits, and without a SoftDevice a page is erased in parts of 10 ms.
const RING_BYTES: usize = if cfg!(all(feature = "nrf52840", feature = "radio-softdevice")) {
    1024
} else {
    255
};
const SEND_BYTES: usize = 64;
/// Time from a byte to the look at what has come: eleven more.
const GATHERING: Duration = Duration::from_millis(1);
/// Most milliseconds that the receiver takes to stop: it waits for four more bytes (nRF52840 product specification, UARTE).
const STOPPING_MS: usize = 10;
/// Most reads of a register until a flush has ended, which takes microseconds.
const FLUSHING: usize = 1000;
/// Cycles in which DMA moves a byte that is counted already: a microsecond.
const MOVING: u32 = 64;

static RING: [AtomicU8; RING_BYTES] = [const { AtomicU8::new(0) }; RING_BYTES];
/// Wakes the reader.
static RECEIVED: AtomicWaker = AtomicWaker::new();

bind_interrupts!(struct Interrupts {
    UARTE0 => buffered_uarte::InterruptHandler<UARTE0>, ByteHandler;
});

/// Handler of a byte that was received: wakes the reader, once.
struct ByteHandler;

#[expect(
    unsafe_code,
    reason = "embassy-nrf makes the handler of an interrupt an unsafe fn"
)]
// SAFETY: the trait demands nothing of an implementation. Only the interrupt's vector calls it; it may interrupt any code,
// and touches two registers that are written whole and a waker that is made for it.
impl typelevel::Handler<typelevel::UARTE0> for ByteHandler {
    unsafe fn on_interrupt() {
        let uart = pac::UARTE0;
        if uart.inten().read().rxdrdy() && uart.events_rxdrdy().read() != 0 {
            uart.intenclr().write(|events| events.set_rxdrdy(true));
            RECEIVED.wake();
        }
    }
}

pub struct Parts {
    pub uart: Peri<'static, UARTE0>,
    pub tx: Peri<'static, AnyPin>,
    pub rx: Peri<'static, AnyPin>,
    /// Counts received bytes.
    pub counter: Peri<'static, TIMER2>,
    /// Connect the UART to the counter.
    pub links: [Peri<'static, AnyConfigurableChannel>; 2],
}

/// Starts both directions, 115200 8N1.
pub fn start(parts: Parts) -> (LabelPort, CommandPort) {
    static SENT: ConstStaticCell<[u8; SEND_BYTES]> = ConstStaticCell::new([0; SEND_BYTES]);
    interrupt::UARTE0.set_priority(Priority::P3);
    let mut config = Config::default();
    config.baudrate = Baudrate::Baud115200;
    config.parity = Parity::Excluded;
    let sender = BufferedUarteTx::new(parts.uart, parts.tx, Interrupts, config, SENT.take());
    let receiver = CommandPort::start(parts.rx, parts.counter, &parts.links);
    (LabelPort(sender), receiver)
}

/// The UART's transmitter.
pub struct LabelPort(BufferedUarteTx<'static>);

impl LabelPort {
    /// Sends a line; 115200 baud take 9 ms for the longest.
    pub async fn send(&mut self, line: &[u8]) {
        #[cfg(feature = "uf2")]
        crate::messages::usb::LINES.push(line);
        let mut rest = line;
        while !rest.is_empty() {
            let Ok(count) = self.0.write(rest).await else {
                return defmt::error!("the UART refused a line");
            };
            rest = rest.get(count..).unwrap_or_default();
        }
        // Then the task that waits for the line knows that the UART takes lines.
        if self.0.flush().await.is_err() {
            defmt::error!("the UART did not send a line");
        }
    }
}

/// The UART's receiver.
pub struct CommandPort {
    /// Pulled up: unconnected, it would receive noise.
    _rx: Input<'static>,
    /// Counts bytes; its channel 0 is read, and channel 1 holds the count at the end of the ring.
    counter: timer::Timer<'static>,
    /// Count of the bytes that were taken.
    taken: u32,
    /// Place of the next one in the ring.
    place: usize,
    /// True while the receiver is being stopped.
    stops: bool,
}

impl CommandPort {
    fn start(
        rx: Peri<'static, AnyPin>,
        counter: Peri<'static, TIMER2>,
        links: &[Peri<'static, AnyConfigurableChannel>; 2],
    ) -> Self {
        let uart = pac::UARTE0;
        let counter = timer::Timer::new_counter(counter);
        counter.start();
        let [counts, ends] = links;
        let timer = pac::TIMER2;
        let tasks = [
            (counts, uart.events_rxdrdy(), timer.tasks_count().as_ptr()),
            (
                ends,
                uart.events_dma().rx().end(),
                timer.tasks_capture(1).as_ptr(),
            ),
        ];
        for (link, event, task) in tasks {
            let channel = pac::PPI.ch(link.number());
            channel.eep().write_value(event.as_ptr() as u32);
            channel.tep().write_value(task as u32);
            pac::PPI
                .chenset()
                .write(|channels| channels.set_ch(link.number(), true));
        }
        let pin = rx.psel_bits();
        let rx = Input::new(rx, Pull::Up);
        // Pins are chosen while it is disabled. Nothing is sent yet.
        uart.enable()
            .write(|uart| uart.set_enable(Enable::Disabled));
        uart.psel().rxd().write_value(pin);
        uart.enable().write(|uart| uart.set_enable(Enable::Enabled));
        let mut port = Self {
            _rx: rx,
            counter,
            taken: 0,
            place: 0,
            stops: false,
        };
        port.begin();
        port
    }

    /// Waits for bytes and takes some; returns the line that they came by and their number.
    #[cfg(not(feature = "uf2"))]
    pub async fn read(&mut self, buffer: &mut [u8]) -> (usize, Result<usize, BytesLost>) {
        (0, self.receive(buffer).await)
    }

    /// Waits for bytes and takes some; returns the line that they came by, 1 for USB, and their number.
    #[cfg(feature = "uf2")]
    pub async fn read(&mut self, buffer: &mut [u8]) -> (usize, Result<usize, BytesLost>) {
        let mut received = [0; 32];
        let by_usb = super::usb::RECEIVED.read(&mut received);
        // The dropped future loses nothing: its bytes stay in their buffer until they are copied at its end.
        match select(self.receive(buffer), by_usb).await {
            Either::First(count) => (0, count),
            Either::Second(count) => {
                for (byte, received) in buffer.iter_mut().zip(received) {
                    *byte = received;
                }
                (1, Ok(count.min(buffer.len())))
            }
        }
    }

    /// Waits for bytes of the UART and takes some; returns their number.
    async fn receive(&mut self, buffer: &mut [u8]) -> Result<usize, BytesLost> {
        loop {
            if self.stops {
                Self::stopped().await;
                self.begin();
                return Err(BytesLost);
            }
            if self.has_failed() {
                self.stop();
                continue;
            }
            match self.take(buffer)? {
                0 => {
                    self.received().await;
                    // Others follow it: a turn of the task for each byte would take half of the core.
                    Timer::after(GATHERING).await;
                }
                count => return Ok(count),
            }
        }
    }

    fn waiting(&self) -> u32 {
        self.counter.cc(0).capture().wrapping_sub(self.taken)
    }

    fn take(&mut self, buffer: &mut [u8]) -> Result<usize, BytesLost> {
        let waiting = usize::try_from(self.waiting()).unwrap_or(usize::MAX);
        let count = buffer.len().min(waiting);
        if count == 0 {
            return Ok(0);
        }
        cortex_m::asm::delay(MOVING);
        let mut place = self.place;
        for byte in buffer.iter_mut().take(count) {
            let received = RING.get(place);
            *byte = received.map_or(0, |received| received.load(Ordering::Relaxed));
            place = (place + 1) % RING_BYTES;
        }
        compiler_fence(Ordering::SeqCst);
        // The ring was written meanwhile.
        let waiting = usize::try_from(self.waiting()).unwrap_or(usize::MAX);
        if waiting > RING_BYTES {
            self.pass(waiting);
            return Err(BytesLost);
        }
        self.pass(count);
        Ok(count)
    }

    fn pass(&mut self, count: usize) {
        self.taken = self.taken.wrapping_add(count as u32);
        self.place = (self.place + count) % RING_BYTES;
    }

    /// Waits for a byte.
    async fn received(&self) {
        let uart = pac::UARTE0;
        poll_fn(|context| {
            RECEIVED.register(context.waker());
            uart.events_rxdrdy().write_value(0);
            uart.intenset().write(|events| events.set_rxdrdy(true));
            // One that came before is counted; one that comes from here on interrupts.
            if self.waiting() == 0 {
                Poll::Pending
            } else {
                Poll::Ready(())
            }
        })
        .await;
    }

    /// Returns true after an error on the line, a byte without a place, or an end of the ring that does not fit the count.
    fn has_failed(&self) -> bool {
        let uart = pac::UARTE0;
        let errors = uart.errorsrc().read();
        uart.errorsrc().write_value(errors);
        let end = uart.events_dma().rx().end();
        if end.read() == 0 {
            return errors.0 != 0;
        }
        end.write_value(0);
        // From the next byte that is taken; it may be behind.
        let distance = self.counter.cc(1).read().wrapping_sub(self.taken);
        let place = i64::from(distance.cast_signed()) + self.place as i64;
        errors.0 != 0 || place.rem_euclid(RING_BYTES as i64) != 0
    }

    fn stop(&mut self) {
        let uart = pac::UARTE0;
        uart.shorts().write(|_| {});
        uart.events_rxto().write_value(0);
        uart.tasks_dma().rx().stop().write_value(1);
        self.stops = true;
    }

    /// Waits until it has stopped. One that does not say so is begun anew all the same.
    async fn stopped() {
        for _ in 0..STOPPING_MS {
            // Before the first look: noise without an end would otherwise take all of the core.
            Timer::after_millis(1).await;
            if pac::UARTE0.events_rxto().read() != 0 {
                return;
            }
        }
    }

    /// Begins anew, with a receiver that does not run.
    fn begin(&mut self) {
        let uart = pac::UARTE0;
        let end = uart.events_dma().rx().end();
        let receiver = uart.dma().rx();
        receiver.ptr().write_value(RING.as_ptr() as u32);
        receiver
            .maxcnt()
            .write(|bytes| bytes.set_maxcnt(RING_BYTES as _));
        // What it still holds would come first and was counted before.
        end.write_value(0);
        uart.tasks_flushrx().write_value(1);
        for _ in 0..FLUSHING {
            if end.read() != 0 {
                break;
            }
        }
        end.write_value(0);
        let errors = uart.errorsrc().read();
        uart.errorsrc().write_value(errors);
        self.counter.clear();
        (self.taken, self.place, self.stops) = (0, 0, false);
        uart.shorts().write(|ends| ends.set_endrx_startrx(true));
        uart.tasks_dma().rx().start().write_value(1);
    }
}
