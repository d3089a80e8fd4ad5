//! Lets a radio do what the Myo session asks for, and tells the session what became of it.
//!
//! The session decides everything and knows no radio; here nothing is decided. One operation runs
//! at a time, notifications come in beside it, and the session hears of time every 50 ms.

use core::cell::{Cell, RefCell};

use embassy_futures::select::{Either, select};
use embassy_sync::{blocking_mutex::raw::NoopRawMutex, channel::Channel, signal::Signal};
use embassy_time::{Duration, Instant, Ticker};
use shared::myo::{Action, Event, MyoSession, Phase};
use shared::stream::link_sequence::Sequencer;
use shared::units::Millis;

use super::{Conversation, Link, MOST_BYTES, OperationFailed, Radio, SUBSCRIBE, handles::Handles};
use crate::tasks::{Packets, watchdog};

const TICK: Duration = Duration::from_millis(50);

/// The session, and what connects it to the radio and to the inference.
pub struct Follower<'q> {
    session: RefCell<MyoSession>,
    sequencer: RefCell<Sequencer>,
    packets: &'q Packets,
    /// What the radio is to do next. The session has one operation under way at most, and may stop a
    /// scan before it.
    orders: Channel<NoopRawMutex, Action, 4>,
    hang_up: Signal<NoopRawMutex, ()>,
    streaming: Signal<NoopRawMutex, ()>,
    connected: Cell<bool>,
    /// Of the connection under way.
    handles: Cell<Handles>,
    /// Told of the phase whenever it may have changed.
    watch: &'q dyn Fn(&MyoSession),
}

/// The time as the session counts it.
pub fn now() -> Millis {
    #[expect(clippy::cast_possible_truncation, reason = "wraps, as `Millis` does")]
    Millis(Instant::now().as_millis() as u32)
}

impl<'q> Follower<'q> {
    /// Before anything was heard.
    pub fn new(session: MyoSession, packets: &'q Packets, watch: &'q dyn Fn(&MyoSession)) -> Self {
        Self {
            session: RefCell::new(session),
            sequencer: RefCell::new(Sequencer::new()),
            packets,
            orders: Channel::new(),
            hang_up: Signal::new(),
            streaming: Signal::new(),
            connected: Cell::new(false),
            handles: Cell::default(),
            watch,
        }
    }

    /// Follows armbands for ever.
    pub async fn follow(&self, radio: &mut impl Radio) {
        select(self.tick(), async {
            loop {
                match self.orders.receive().await {
                    Action::Scan => self.scan(radio).await,
                    Action::Connect(address) => {
                        self.hang_up.reset();
                        self.streaming.reset();
                        self.connected.set(false);
                        select(radio.connect(address, self), self.hang_up.wait()).await;
                        self.tell(if self.connected.get() {
                            Event::Disconnected
                        } else {
                            Event::ConnectFailed
                        });
                    }
                    // Of a link that is gone already: its end was told.
                    _ => {}
                }
            }
        })
        .await;
    }

    async fn tick(&self) {
        let mut every = Ticker::every(TICK);
        loop {
            self.tell(Event::Tick);
            watchdog::RADIO.alive();
            every.next().await;
        }
    }

    async fn scan(&self, radio: &mut impl Radio) {
        let hear = radio.scan(|heard| {
            self.tell(Event::Advertisement {
                address: heard.address,
                rssi: heard.rssi,
                data: heard.data(),
            });
        });
        let stopped = async { while !matches!(self.orders.receive().await, Action::StopScan) {} };
        if let Either::First(()) = select(hear, stopped).await {
            self.tell(Event::ScanEnded);
        }
    }

    /// Tells the session, and passes on what it wants.
    fn tell(&self, event: Event<'_>) {
        let mut session = self.session.borrow_mut();
        session.handle(now(), event, &mut |action| self.act(action));
        if session.phase() == Phase::Streaming {
            self.streaming.signal(());
        }
        (self.watch)(&session);
    }

    fn act(&self, action: Action) {
        match action {
            Action::Disconnect => self.hang_up.signal(()),
            Action::Deliver(samples) => self
                .packets
                .push(self.sequencer.borrow_mut().samples(samples)),
            Action::Gap { missing } => self.sequencer.borrow_mut().gap(missing),
            Action::StreamEnded => self.packets.push(self.sequencer.borrow_mut().end()),
            // It has room: one operation is under way at a time.
            order => drop(self.orders.try_send(order)),
        }
    }

    async fn perform(&self, link: &impl Link, order: Action) {
        let mut value = [0; MOST_BYTES];
        let handles = self.handles.get();
        let done = match order {
            Action::Discover => match link.discover().await {
                Ok(handles) => {
                    self.handles.set(handles);
                    return self.tell(Event::Discovered(handles.found()));
                }
                Err(failed) => Err(failed),
            },
            Action::Read(characteristic) => match handles.value(characteristic) {
                Some(handle) => match link.read(handle, &mut value).await {
                    Ok(length) => return self.tell(Event::Read(&value[..length.min(MOST_BYTES)])),
                    Err(failed) => Err(failed),
                },
                None => Err(OperationFailed),
            },
            Action::Write(characteristic, payload) => match handles.value(characteristic) {
                Some(handle) => link.write(handle, payload.as_slice()).await,
                None => Err(OperationFailed),
            },
            Action::Subscribe(characteristic) => match handles.subscription(characteristic) {
                Some(handle) => link.write(handle, &SUBSCRIBE).await,
                None => Err(OperationFailed),
            },
            _ => return,
        };
        self.tell(match done {
            Ok(()) => Event::Done,
            Err(_) => Event::Failed,
        });
    }
}

impl Conversation for Follower<'_> {
    async fn talk(&self, link: &impl Link) {
        self.connected.set(true);
        self.handles.take();
        self.tell(Event::Connected);
        let operate = async {
            loop {
                let order = self.orders.receive().await;
                self.perform(link, order).await;
            }
        };
        let listen = async {
            self.streaming.wait().await;
            let handles = self.handles.get();
            link.listen(|handle, bytes| {
                // Of anything else that the armband offers, nobody asked for notifications.
                if let Some(characteristic) = handles.characteristic(handle) {
                    self.tell(Event::Notification {
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
