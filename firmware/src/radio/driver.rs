//! Runs the Myo session on a Bluetooth stack: carries out its actions and reports their outcome.
//!
//! The session decides everything and knows no stack; nothing is decided here. One operation runs
//! at a time, notifications arrive beside it, and the session gets a tick every 50 ms.

use core::cell::{Cell, RefCell};

use core::future::pending;

use embassy_futures::{
    join::join,
    select::{Either, Either3, select, select3},
    yield_now,
};
use embassy_sync::{blocking_mutex::raw::NoopRawMutex, channel::Channel, signal::Signal};
use embassy_time::{Duration, Ticker};
use shared::myo::{
    Action, Address, ConnectionParameters, Discovery, Event, Following, MyoSession, Progress,
};
use shared::stream::link_sequence::Sequencer;
use shared::uart_line::answer::{Binding, Refusal};
use shared::uart_line::command::BindCommand;
use shared::units::Millis;

use super::{
    ConnectionHandler, ENABLE_NOTIFICATIONS, Link, MAX_VALUE_BYTES, OperationFailed, Pace, Radio,
    Scanned, handles::Handles,
};
use crate::binding_region;
use crate::clock::now;
use crate::flash::{Flash, SharedFlash};
use crate::messages::{
    heartbeat, model,
    packets::Packets,
    requests,
    uart::{self, UartMessage},
};

const TICK: Duration = Duration::from_millis(50);
/// Milliseconds after which a scan that has found nobody receives seldom.
const SOUGHT_MS: u32 = 60_000;
/// First byte of the command that starts a stream (`myohw_command_set_mode` of Thalmic's header).
const SET_MODE: u8 = 1;
/// UUID of the preferred connection parameters, as in the declaration of their characteristic.
const PREFERRED: [u8; 2] = [0x04, 0x2a];

/// The session, and what connects it to the stack and to the inference.
pub struct SessionDriver<'q> {
    session: RefCell<MyoSession>,
    /// Evidence for feeding the watchdog.
    progress: Cell<Progress>,
    sequencer: RefCell<Sequencer>,
    packets: &'q Packets,
    /// Actions for the stack, in order. The session has at most one operation outstanding, and may
    /// stop a scan before it.
    operations: Channel<NoopRawMutex, Action, 4>,
    disconnect: Signal<NoopRawMutex, ()>,
    /// Notifications are taken from here on.
    listens: Signal<NoopRawMutex, ()>,
    connected: Cell<bool>,
    /// Time since which an armband is sought: the start, the last connection, a person's wish.
    sought: Cell<Millis>,
    /// Whether an armband's preferred parameters were said.
    has_said_preferred: Cell<bool>,
    /// Handles of the current connection.
    handles: Cell<Handles>,
    /// Address to keep, until that was tried.
    keep: Signal<NoopRawMutex, Option<Address>>,
    /// Address that is kept.
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
            progress: Cell::new(Progress::new()),
            sequencer: RefCell::new(Sequencer::new()),
            packets,
            operations: Channel::new(),
            disconnect: Signal::new(),
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
        select(self.tick(), async {
            loop {
                if R::LEAVES_FLASH_TIME {
                    self.use_radio(radio, flash).await;
                } else {
                    // Whoever erases flash waits for it.
                    let _air = flash.air().await;
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
            // Between two scans or connections: erasing a page holds the core up, for longer than a connection bears.
            let next = select3(self.keep.wait(), unused::<R>(), self.operations.receive());
            let operation = match next.await {
                Either3::First(armband) => {
                    self.keep(flash, armband).await;
                    continue;
                }
                Either3::Second(()) => return,
                Either3::Third(operation) => operation,
            };
            match operation {
                Action::Scan => {
                    let stopped = async {
                        while !matches!(self.operations.receive().await, Action::StopScan) {}
                    };
                    let scan = select3(stopped, self.scan(radio), unused::<R>());
                    if !matches!(scan.await, Either3::First(())) {
                        self.handle(Event::ScanEnded);
                    }
                }
                Action::Connect(address) => {
                    self.disconnect.reset();
                    self.listens.reset();
                    self.connected.set(false);
                    let ended = select(self.disconnect.wait(), unused::<R>());
                    select(radio.connect(address, self), ended).await;
                    self.sought.set(now());
                    self.handle(if self.connected.get() {
                        Event::Disconnected
                    } else {
                        Event::ConnectFailed
                    });
                }
                // Of a link that has ended; the session has handled that already.
                _ => {}
            }
        }
    }

    /// Waits until there is a model. A scan waits with it; nothing else comes of what the session asks for.
    async fn wait_for_model(&self) {
        let scan_is_wanted = async {
            loop {
                match self.operations.receive().await {
                    Action::Scan => return,
                    Action::Connect(_) => self.handle(Event::ConnectFailed),
                    _ => {}
                }
            }
        };
        join(scan_is_wanted, async {
            model::until(true).await;
            self.sought.set(now());
            // Nothing was heard meanwhile.
            self.progress.set(Progress::new());
        })
        .await;
        self.act(Action::Scan);
    }

    async fn keep(&self, flash: &SharedFlash<impl Flash>, armband: Option<Address>) {
        if !binding_region::keep(&mut *flash.lock().await, armband).await {
            uart::enqueue(UartMessage::NotKept);
        }
        self.kept.set(binding_region::load());
    }

    /// Carries out what a person asks for.
    fn bind(&self, command: BindCommand) -> Result<Binding, Refusal> {
        let event = match command {
            BindCommand::Begin => Some(Event::Pair),
            BindCommand::Set(armband) => Some(Event::Bind(Some(armband))),
            BindCommand::Forget => Some(Event::Bind(None)),
            BindCommand::State => None,
        };
        let following = self.session.borrow().following();
        if let Some(event) = event {
            if let Following::Pinned(_) = following {
                return Err(Refusal::BuiltIn);
            }
            // To bind the armband that is followed and kept changes nothing, and would end its stream.
            let is_so = matches!(following, Following::Bound(armband)
                if command == BindCommand::Set(armband) && self.kept.get() == Some(armband));
            if !is_so {
                self.sought.set(now());
                self.handle(event);
            }
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
            self.handle(Event::Tick);
            // Without a model nothing is asked of the radio.
            if model::current().is_none() || self.progress.get().is_alive(now()) {
                heartbeat::RADIO.beat();
            }
            let next = select(ticker.next(), requests::BIND.receive()).await;
            if let Either::Second((ticket, command)) = next {
                requests::BIND.answer(ticket, self.bind(command));
            }
        }
    }

    /// Scans until the radio ends that.
    async fn scan(&self, radio: &mut impl Radio) {
        let pace = || match now().elapsed_since(self.sought.get()) {
            SOUGHT_MS.. => Pace::Seldom,
            _ => Pace::Always,
        };
        let report = |scanned: Scanned<'_>| {
            self.handle(match scanned {
                Scanned::Answered => Event::Answered,
                Scanned::Advertisement(advertisement) => Event::Advertisement {
                    address: advertisement.address,
                    rssi: advertisement.rssi,
                    data: advertisement.data(),
                },
            });
        };
        radio.scan(pace, report).await;
    }

    /// Passes an event to the session, and the session's actions on.
    fn handle(&self, event: Event<'_>) {
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
            Action::Disconnect => self.disconnect.signal(()),
            Action::Deliver(samples) => self
                .packets
                .push(self.sequencer.borrow_mut().samples(samples)),
            Action::Keep(armband) => self.keep.signal(armband),
            Action::Gap { missing } => self.sequencer.borrow_mut().gap(missing),
            Action::StreamEnded => self.packets.push(self.sequencer.borrow_mut().end()),
            // It has room: at most one operation is outstanding.
            operation => drop(self.operations.try_send(operation)),
        }
    }

    async fn operate(&self, link: &impl Link, operation: Action) {
        let mut value = [0; MAX_VALUE_BYTES];
        let handles = self.handles.get();
        let outcome = match operation {
            Action::Discover => {
                let handles = self.discover(link).await;
                self.handles.set(handles);
                return self.handle(Event::Discovered(handles.found()));
            }
            Action::Read(characteristic) => match handles.value(characteristic) {
                Some(handle) => match link.read(handle, &mut value).await {
                    Ok(length) => {
                        return self.handle(Event::Read(&value[..length.min(MAX_VALUE_BYTES)]));
                    }
                    Err(failed) => Err(failed),
                },
                None => Err(OperationFailed),
            },
            Action::Write(characteristic, payload) => {
                if payload.as_slice().first() == Some(&SET_MODE) {
                    // Before it: the first notification may come with the response.
                    self.listens.signal(());
                    yield_now().await;
                }
                match handles.value(characteristic) {
                    Some(handle) => link.write(handle, payload.as_slice()).await,
                    None => Err(OperationFailed),
                }
            }
            Action::Subscribe(characteristic) => match handles.subscription(characteristic) {
                Some(handle) => link.write(handle, &ENABLE_NOTIFICATIONS).await,
                None => Err(OperationFailed),
            },
            _ => return,
        };
        self.handle(match outcome {
            Ok(()) => Event::Done,
            Err(_) => Event::Failed,
        });
    }

    /// Reads attributes until every characteristic is found, or to the end.
    async fn discover(&self, link: &impl Link) -> Handles {
        let mut handles = Handles::default();
        let mut discovery = Discovery::new();
        let mut value = [0; MAX_VALUE_BYTES];
        while let Some(handle) = discovery.handle() {
            let read = link.read(handle, &mut value).await;
            let bytes = read.ok().and_then(|length| value.get(..length));
            if let Some(attribute) = discovery.answered(bytes) {
                handles.insert(attribute);
            }
            if let Some([_, low, high, uuid @ ..]) = bytes
                && *uuid == PREFERRED
            {
                let handle = u16::from_le_bytes([*low, *high]);
                self.say_preferred(link, handle).await;
            }
        }
        handles
    }

    /// Says which connection parameters the armband prefers, once: nobody has seen them.
    async fn say_preferred(&self, link: &impl Link, handle: u16) {
        let mut value = [0; MAX_VALUE_BYTES];
        if self.has_said_preferred.replace(true)
            || !matches!(link.read(handle, &mut value).await, Ok(8..))
        {
            return;
        }
        let [a, b, c, d, e, f, g, h, ..] = value;
        let [min_interval, max_interval, latency, supervision_timeout] =
            [[a, b], [c, d], [e, f], [g, h]].map(u16::from_le_bytes);
        uart::enqueue(UartMessage::Preferred(ConnectionParameters {
            min_interval,
            max_interval,
            latency,
            supervision_timeout,
        }));
    }
}

/// Waits until a model is installed, which a radio that leaves flash no time is not used beside.
async fn unused<R: Radio>() {
    if R::LEAVES_FLASH_TIME {
        pending::<()>().await;
    }
    model::until(false).await;
}

impl ConnectionHandler for SessionDriver<'_> {
    async fn run(&self, link: &impl Link) {
        self.connected.set(true);
        self.handles.take();
        self.handle(Event::Connected);
        let operate = async {
            loop {
                let operation = self.operations.receive().await;
                self.operate(link, operation).await;
            }
        };
        let listen = async {
            self.listens.wait().await;
            let handles = self.handles.get();
            link.listen(|handle, bytes| {
                // No other characteristic of the armband is subscribed to.
                if let Some(characteristic) = handles.characteristic(handle) {
                    self.handle(Event::Notification {
                        characteristic,
                        bytes,
                    });
                }
            })
            .await
        };
        select(operate, listen).await;
    }
}
