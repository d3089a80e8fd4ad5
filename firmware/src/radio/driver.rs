//! Runs the Myo session on a Bluetooth stack: carries out its actions and reports their outcome.
//!
//! The session decides everything and knows no stack; nothing is decided here. One operation runs
//! at a time, notifications arrive beside it, and the session gets a tick every 50 ms.

use core::cell::{Cell, RefCell};

use embassy_futures::select::{Either, select};
use embassy_sync::{blocking_mutex::raw::NoopRawMutex, channel::Channel, signal::Signal};
use embassy_time::{Duration, Ticker};
use shared::myo::{Action, Address, Discovery, Event, Following, MyoSession, Phase, Progress};
use shared::stream::link_sequence::Sequencer;
use shared::uart_line::answer::{Binding, Refusal};
use shared::uart_line::command::BindCommand;

use super::{
    ConnectionHandler, ENABLE_NOTIFICATIONS, Link, MAX_VALUE_BYTES, OperationFailed, Radio,
    Scanned, handles::Handles,
};
use crate::binding_region;
use crate::clock::now;
use crate::flash::{Flash, SharedFlash};
use crate::messages::{
    heartbeat,
    packets::Packets,
    requests,
    uart::{self, UartMessage},
};

const TICK: Duration = Duration::from_millis(50);

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
    streaming: Signal<NoopRawMutex, ()>,
    connected: Cell<bool>,
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
            streaming: Signal::new(),
            connected: Cell::new(false),
            handles: Cell::default(),
            keep: Signal::new(),
            kept: Cell::new(kept),
            observe,
        }
    }

    /// Runs the session forever, from one connection to the next.
    pub async fn run(&self, radio: &mut impl Radio, flash: &SharedFlash<impl Flash>) {
        select(self.tick(), async {
            loop {
                // Between two scans or connections: erasing a page holds the core up, for longer than a connection bears.
                let operation = match select(self.keep.wait(), self.operations.receive()).await {
                    Either::First(armband) => {
                        self.keep(flash, armband).await;
                        continue;
                    }
                    Either::Second(operation) => operation,
                };
                match operation {
                    Action::Scan => self.scan(radio).await,
                    Action::Connect(address) => {
                        self.disconnect.reset();
                        self.streaming.reset();
                        self.connected.set(false);
                        select(radio.connect(address, self), self.disconnect.wait()).await;
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
        })
        .await;
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
            if self.progress.get().is_alive(now()) {
                heartbeat::RADIO.beat();
            }
            let next = select(ticker.next(), requests::BIND.receive()).await;
            if let Either::Second((ticket, command)) = next {
                requests::BIND.answer(ticket, self.bind(command));
            }
        }
    }

    async fn scan(&self, radio: &mut impl Radio) {
        let scan = radio.scan(|scanned| {
            self.handle(match scanned {
                Scanned::Answered => Event::Answered,
                Scanned::Advertisement(advertisement) => Event::Advertisement {
                    address: advertisement.address,
                    rssi: advertisement.rssi,
                    data: advertisement.data(),
                },
            });
        });
        let stopped =
            async { while !matches!(self.operations.receive().await, Action::StopScan) {} };
        if let Either::First(()) = select(scan, stopped).await {
            self.handle(Event::ScanEnded);
        }
    }

    /// Passes an event to the session, and the session's actions on.
    fn handle(&self, event: Event<'_>) {
        let mut session = self.session.borrow_mut();
        let now = now();
        session.handle(now, event, &mut |action| self.act(action));
        let mut progress = self.progress.get();
        progress.handled(now, event, &session);
        self.progress.set(progress);
        if session.phase() == Phase::Streaming {
            self.streaming.signal(());
        }
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
                let handles = discover(link).await;
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
            Action::Write(characteristic, payload) => match handles.value(characteristic) {
                Some(handle) => link.write(handle, payload.as_slice()).await,
                None => Err(OperationFailed),
            },
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
}

/// Reads attributes until every characteristic is found, or to the end.
async fn discover(link: &impl Link) -> Handles {
    let mut handles = Handles::default();
    let mut discovery = Discovery::new();
    let mut value = [0; MAX_VALUE_BYTES];
    while let Some(handle) = discovery.handle() {
        let read = link.read(handle, &mut value).await;
        let bytes = read.ok().and_then(|length| value.get(..length));
        if let Some(attribute) = discovery.answered(bytes) {
            handles.insert(attribute);
        }
    }
    handles
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
            self.streaming.wait().await;
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
