//! Runs the Myo session on a Bluetooth stack: carries out its actions and reports their outcome.
//!
//! The session decides everything and knows no stack; nothing is decided here. One operation runs
//! at a time, notifications arrive beside it, and the session gets a tick every 50 ms.

mod request;

use core::cell::{Cell, RefCell};
use core::future::pending;

use embassy_futures::select::{Either, Either3, select, select3};
use embassy_sync::{blocking_mutex::raw::NoopRawMutex, signal::Signal};
use embassy_time::{Duration, Ticker};
use shared::myo::{Action, Address, MyoEvent, MyoSession, RadioProgress};
use shared::stream::link_sequence::Sequencer;
use shared::uart_line::answer::{Binding, Refusal};
use shared::uart_line::command::BindCommand;
#[cfg(feature = "uf2")]
use shared::uart_line::imu::ImuReport;
use shared::units::Millis;

use super::{ConnectionHandler, Link, Pace, Radio, Scanned, handles::Handles};
use crate::binding_region;
use crate::clock::now;
use crate::flash::{Flash, SharedFlash};
#[cfg(feature = "uf2")]
use crate::messages::imu;
use crate::messages::{
    heartbeat, model,
    packets::Packets,
    requests,
    uart::{self, UartMessage},
};
use request::Request;

const TICK: Duration = Duration::from_millis(50);
/// Milliseconds after which a scan that has found no armband receives seldom.
const SOUGHT_MS: u32 = 60_000;

/// Use of the radio that the session wants.
#[derive(Clone, Copy)]
enum Use {
    /// Neither a scan nor a connection.
    Nothing,
    Scan,
    Connect(Address),
}

/// The session, and what connects it to the stack and to the inference.
pub struct SessionDriver<'q> {
    session: RefCell<MyoSession>,
    /// Evidence for feeding the watchdog.
    progress: Cell<RadioProgress>,
    sequencer: RefCell<Sequencer>,
    packets: &'q Packets,
    /// Use of the radio that is wanted from now on: the newest takes the place of one that was not begun, and ends one that was.
    wanted: Signal<NoopRawMutex, Use>,
    /// Request to the armband that is connected: the session has one outstanding at most.
    request: Signal<NoopRawMutex, Request>,
    /// Notifications are taken from here on.
    listens: Signal<NoopRawMutex, ()>,
    connected: Cell<bool>,
    /// Time since which an armband is sought: the start, the last connection, a person's wish.
    sought: Cell<Millis>,
    /// Whether an armband's preferred parameters were said.
    has_said_preferred: Cell<bool>,
    handles: Cell<Handles>,
    /// Address to keep, until that was tried.
    keep: Signal<NoopRawMutex, Option<Address>>,
    kept: Cell<Option<Address>>,
    /// Called after every event.
    observe: &'q dyn Fn(&MyoSession),
}

impl<'q> SessionDriver<'q> {
    /// A driver before the first event; `kept` is the bound armband that outlasts a restart.
    pub fn new(
        session: MyoSession,
        kept: Option<Address>,
        packets: &'q Packets,
        observe: &'q dyn Fn(&MyoSession),
    ) -> Self {
        Self {
            session: RefCell::new(session),
            progress: Cell::new(RadioProgress::default()),
            sequencer: RefCell::new(Sequencer::default()),
            packets,
            wanted: Signal::new(),
            request: Signal::new(),
            listens: Signal::new(),
            connected: Cell::new(false),
            sought: Cell::new(now()),
            has_said_preferred: Cell::new(false),
            handles: Cell::default(),
            keep: Signal::new(),
            kept: Cell::new(kept),
            observe,
        }
    }

    /// Runs the session forever, from one connection to the next.
    pub async fn run<R: Radio>(&self, radio: &mut R, flash: &SharedFlash<impl Flash>) {
        // Neither returns, so neither is dropped.
        select(self.tick(), async {
            loop {
                if R::LEAVES_FLASH_TIME {
                    self.use_radio(radio, flash).await;
                } else {
                    // An erasure of flash waits until the radio is idle.
                    let _radio_turn = flash.radio_turn().await;
                    self.use_radio(radio, flash).await;
                    radio.silence().await;
                }
                self.wait_for_model().await;
            }
        })
        .await;
    }

    /// Carries out what the session asks for. Returns where a model is installed, if the radio leaves flash no time.
    async fn use_radio<R: Radio>(&self, radio: &mut R, flash: &SharedFlash<impl Flash>) {
        loop {
            // Dropped futures lose nothing: a signal stays until it is taken.
            let next = select3(self.keep.wait(), must_be_idle::<R>(), self.wanted.wait());
            match next.await {
                Either3::First(armband) => {
                    // Between two scans or connections: erasing a page holds the core up, for longer than a connection bears.
                    radio.silence().await;
                    self.keep(flash, armband).await;
                }
                Either3::Second(()) => return,
                // A connection that was not begun; or the session waits for nothing.
                Either3::Third(Use::Nothing) => self.handle(MyoEvent::ConnectFailed),
                Either3::Third(Use::Scan) => {
                    // The scan that is dropped ends; what it has heard was passed on.
                    let scan = select3(self.is_changed(), self.scan(radio), must_be_idle::<R>());
                    if !matches!(scan.await, Either3::First(())) {
                        self.handle(MyoEvent::ScanEnded);
                    }
                }
                Either3::Third(Use::Connect(address)) => {
                    self.listens.reset();
                    self.connected.set(false);
                    // A dropped connection ends, or is never established; an answer on its way is lost with it. The connection
                    // is polled first: one that was established just now is known, and ended.
                    let ended = select(self.is_changed(), must_be_idle::<R>());
                    select(radio.connect(address, self), ended).await;
                    self.request.reset();
                    self.sought.set(now());
                    self.handle(if self.connected.get() {
                        MyoEvent::Disconnected
                    } else {
                        MyoEvent::ConnectFailed
                    });
                }
            }
        }
    }

    /// Waits until another use of the radio is wanted, and leaves that to whoever begins it.
    async fn is_changed(&self) {
        let wanted = self.wanted.wait().await;
        self.wanted.signal(wanted);
    }

    /// Waits until there is a model. What the session wants meanwhile waits too.
    async fn wait_for_model(&self) {
        model::until(true).await;
        self.sought.set(now());
        // Nothing was heard meanwhile.
        self.progress.set(RadioProgress::default());
    }

    async fn keep(&self, flash: &SharedFlash<impl Flash>, armband: Option<Address>) {
        if !binding_region::keep(&mut *flash.lock().await, armband).await {
            uart::enqueue(UartMessage::NotKept);
        }
        self.kept.set(binding_region::load());
    }

    /// Carries out what a person asks for.
    fn bind(&self, command: BindCommand) -> Result<Binding, Refusal> {
        let following = self.session.borrow().following();
        if let Some(event) = command.event(following, self.kept.get())? {
            self.sought.set(now());
            self.handle(event);
        }
        let session = self.session.borrow();
        Ok(Binding {
            following: session.following(),
            is_kept: session.bound() == self.kept.get(),
        })
    }

    async fn tick(&self) {
        let mut ticker = Ticker::every(TICK);
        loop {
            #[cfg(feature = "uf2")]
            self.session.borrow_mut().set_imu(imu::is_wanted());
            self.handle(MyoEvent::Tick);
            // Without a model nothing is asked of the radio.
            if model::current().is_none() || self.progress.get().is_alive(now()) {
                heartbeat::RADIO.beat();
            }
            // A dropped future loses nothing: the ticker knows its next time, the request stays until it is taken.
            let next = select(ticker.next(), requests::BIND.receive()).await;
            if let Either::Second((ticket, command)) = next {
                requests::BIND.answer(ticket, self.bind(command));
            }
        }
    }

    async fn scan(&self, radio: &mut impl Radio) {
        let pace = || match now().elapsed_since(self.sought.get()) {
            SOUGHT_MS.. => Pace::Seldom,
            _ => Pace::Always,
        };
        let report = |scanned: Scanned<'_>| {
            self.handle(match scanned {
                Scanned::Answered => MyoEvent::Answered,
                Scanned::Advertisement(advertisement) => MyoEvent::Advertisement {
                    address: advertisement.address,
                    rssi: advertisement.rssi,
                    data: advertisement.data(),
                },
            });
        };
        radio.scan(pace, report).await;
    }

    /// Passes an event to the session, and the session's actions on.
    fn handle(&self, event: MyoEvent<'_>) {
        let mut session = self.session.borrow_mut();
        let now = now();
        session.handle(now, event, &mut |action| self.act(action));
        let mut progress = self.progress.get();
        progress.handled(now, event, &session);
        self.progress.set(progress);
        (self.observe)(&session);
    }

    fn act(&self, action: Action) {
        match action {
            Action::Scan => self.wanted.signal(Use::Scan),
            Action::Connect(address) => self.wanted.signal(Use::Connect(address)),
            Action::StopScan | Action::Disconnect => self.wanted.signal(Use::Nothing),
            Action::Discover => self.request.signal(Request::Discover),
            Action::Read(one) => self.request.signal(Request::Read(one)),
            Action::Subscribe(one) => self.request.signal(Request::Subscribe(one)),
            Action::Write(one, payload) => self.request.signal(Request::Write(one, payload)),
            Action::Deliver(samples) => self
                .packets
                .push(self.sequencer.borrow_mut().samples(samples)),
            Action::Keep(armband) => self.keep.signal(armband),
            Action::Gap { missing } => self.sequencer.borrow_mut().gap(missing),
            Action::StreamEnded => self.packets.push(self.sequencer.borrow_mut().end()),
            #[cfg(feature = "uf2")]
            Action::Imu(imu) => {
                let sample = self.sequencer.borrow().due();
                imu::send(ImuReport { sample, imu });
            }
            // Never asked for: a UART has no room for it.
            #[cfg(not(feature = "uf2"))]
            Action::Imu(_) => {}
        }
    }
}

/// Resolves when an installation starts, if this radio must be idle while flash is erased; otherwise never.
async fn must_be_idle<R: Radio>() {
    if R::LEAVES_FLASH_TIME {
        pending::<()>().await;
    }
    model::until(false).await;
}

impl ConnectionHandler for SessionDriver<'_> {
    async fn run(&self, link: &impl Link) {
        self.connected.set(true);
        self.handles.take();
        self.handle(MyoEvent::Connected);
        let ask = async {
            loop {
                let request = self.request.wait().await;
                self.carry_out(link, request).await;
            }
        };
        let listen = async {
            self.listens.wait().await;
            let handles = self.handles.get();
            link.listen(|handle, bytes| {
                // No other characteristic of the armband is subscribed to.
                if let Some(characteristic) = handles.characteristic(handle) {
                    self.handle(MyoEvent::Notification {
                        characteristic,
                        bytes,
                    });
                }
            })
            .await
        };
        // Returns once the connection has ended: the session learns that, and waits for no answer.
        select(ask, listen).await;
    }
}
