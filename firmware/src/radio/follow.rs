//! Lets a radio do what the Myo session asks for, and tells the session what became of it.
//!
//! The session decides everything and knows no radio; here nothing is decided. One operation runs
//! at a time, notifications come in beside it, and the session hears of time every 50 ms.

use core::cell::{Cell, RefCell};

use embassy_futures::select::{Either, select};
use embassy_sync::{blocking_mutex::raw::NoopRawMutex, channel::Channel, signal::Signal};
use embassy_time::{Duration, Instant, Ticker};
use shared::{
    myo::{Action, Address, Characteristic, Event, MyoSession, Payload, Phase},
    numbering::Sender,
    units::Millis,
};

use super::{Conversation, Link, MOST_BYTES, Radio};
use crate::tasks::{Packets, watchdog};

const TICK: Duration = Duration::from_millis(50);

/// What the session wants the radio to do next.
enum Order {
    Scan,
    StopScan,
    Connect(Address),
    Discover,
    Read(Characteristic),
    Subscribe(Characteristic),
    Write(Characteristic, Payload),
}

/// The session, and what connects it to the radio and to the inference.
pub struct Follower<'q> {
    session: RefCell<MyoSession>,
    sender: RefCell<Sender>,
    packets: &'q Packets,
    /// The session has one operation under way at most, and may stop a scan before it.
    orders: Channel<NoopRawMutex, Order, 4>,
    hang_up: Signal<NoopRawMutex, ()>,
    streaming: Signal<NoopRawMutex, ()>,
    connected: Cell<bool>,
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
            sender: RefCell::new(Sender::new()),
            packets,
            orders: Channel::new(),
            hang_up: Signal::new(),
            streaming: Signal::new(),
            connected: Cell::new(false),
            watch,
        }
    }

    /// Follows armbands for ever.
    pub async fn follow(&self, radio: &mut impl Radio) {
        select(self.tick(), async {
            loop {
                match self.orders.receive().await {
                    Order::Scan => self.scan(radio).await,
                    Order::Connect(address) => {
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
            self.tell(Event::Heard {
                address: heard.address,
                rssi: heard.rssi,
                data: heard.data(),
            });
        });
        let stopped = async { while !matches!(self.orders.receive().await, Order::StopScan) {} };
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
        let order = match action {
            Action::Scan => Order::Scan,
            Action::StopScan => Order::StopScan,
            Action::Connect(address) => Order::Connect(address),
            Action::Discover => Order::Discover,
            Action::Read(characteristic) => Order::Read(characteristic),
            Action::Subscribe(characteristic) => Order::Subscribe(characteristic),
            Action::Write(characteristic, payload) => Order::Write(characteristic, payload),
            Action::Disconnect => return self.hang_up.signal(()),
            Action::Deliver(samples) => {
                let packet = self.sender.borrow_mut().samples(samples);
                return self.packets.push(packet);
            }
            Action::Gap { missing } => return self.sender.borrow_mut().gap(missing),
            Action::Lost => {
                let packet = self.sender.borrow_mut().over();
                return self.packets.push(packet);
            }
        };
        // It has room: one operation is under way at a time.
        let _ = self.orders.try_send(order);
    }

    async fn perform(&self, link: &impl Link, order: Order) {
        let mut value = [0; MOST_BYTES];
        let done = match order {
            Order::Discover => match link.discover().await {
                Ok(found) => return self.tell(Event::Discovered(found)),
                Err(failed) => Err(failed),
            },
            Order::Read(characteristic) => match link.read(characteristic, &mut value).await {
                Ok(length) => return self.tell(Event::Read(&value[..length.min(MOST_BYTES)])),
                Err(failed) => Err(failed),
            },
            Order::Write(characteristic, payload) => {
                link.write(characteristic, payload.as_slice()).await
            }
            Order::Subscribe(characteristic) => link.subscribe(characteristic).await,
            Order::Scan | Order::StopScan | Order::Connect(_) => return,
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
        self.tell(Event::Connected);
        let operate = async {
            loop {
                let order = self.orders.receive().await;
                self.perform(link, order).await;
            }
        };
        let listen = async {
            self.streaming.wait().await;
            link.listen(|characteristic, bytes| {
                self.tell(Event::Notification {
                    characteristic,
                    bytes,
                });
            })
            .await
        };
        select(operate, listen).await;
    }
}
