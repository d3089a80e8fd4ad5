//! A person's wish at any moment of a binding, a connection, an installation: the armband that is wished for is followed, and nobody
//! holds another one.

use std::cell::{Cell, RefCell};
use std::pin::{Pin, pin};
use std::task::{Context, Poll, Waker};

use embassy_sync::{blocking_mutex::raw::NoopRawMutex, mutex::MutexGuard};
use embassy_time::{Duration, Instant, MockDriver, Timer};
use shared::myo::{Address, AddressKind, Following, MyoSession, Settings, binding};
use shared::uart_line::command::BindCommand::{self, Begin, Forget, Set};
use virtual_armband::Armband;

use super::radio::SimulatedRadio;
use crate::binding_region;
use crate::clock::alone;
use crate::flash::{self, Flash, FlashFailed, PAGE_BYTES, Region, SharedFlash};
use crate::messages::{model, packets::Packets, requests::BIND};
use crate::radio::driver::SessionDriver;
use crate::radio::{ConnectFailed, ConnectionHandler, Pace, Radio, Scanned};

/// Milliseconds between two moments: no multiple of what the simulated radio takes.
const STEP_MS: usize = 7;
/// Milliseconds in which a scan, a connection and its set-up are over.
const SETTLED_MS: u64 = 6_000;
/// Milliseconds of a pairing.
const PAIRING_MS: u64 = 30_000;

/// The armband that is bound at first, and one with a stronger signal.
const WORN: Address = address(1);
const OTHER: Address = address(2);

const fn address(last: u8) -> Address {
    Address {
        kind: AddressKind::Public,
        bytes: [last, 0, 0, 0, 0, 0xfa],
    }
}

/// Flash that takes the times of a chip's.
struct Slow;

impl Flash for Slow {
    async fn erase(&mut self, page: u32) -> Result<(), FlashFailed> {
        Timer::after_millis(85).await;
        flash::erase(page, PAGE_BYTES);
        Ok(())
    }

    async fn write(&mut self, address: u32, words: &[u8]) -> Result<(), FlashFailed> {
        Timer::after_micros(41 * words.len() as u64 / 4).await;
        flash::program(address, words);
        Ok(())
    }
}

/// A radio beside which nothing is erased, as a SoftDevice's.
struct Exclusive<R>(R);

impl<R: Radio> Radio for Exclusive<R> {
    const LEAVES_FLASH_TIME: bool = false;

    async fn scan(&mut self, pace: impl Fn() -> Pace, report: impl FnMut(Scanned<'_>)) {
        self.0.scan(pace, report).await;
    }

    async fn silence(&mut self) {
        self.0.silence().await;
    }

    async fn connect(
        &mut self,
        address: Address,
        handler: &impl ConnectionHandler,
    ) -> Result<(), ConnectFailed> {
        self.0.connect(address, handler).await
    }
}

#[derive(Clone, Copy, Debug)]
enum Act {
    Wish(BindCommand),
    /// An installation takes the model away, or gives one.
    Model(bool),
}

/// Outcome of the events: which armband is followed, which of the two stream, which advertise.
type Outcome = (Following, [bool; 2], [bool; 2]);

/// Runs a board until its armbands have settled after the last event. Times are milliseconds since the start.
fn run(acts: &[(u64, Act)], is_exclusive: bool) -> Outcome {
    flash::insert(Region::Binding, &binding::to_record(WORN));
    model::set(Some(1));
    let armband = |address, rssi| RefCell::new(Armband::new(address, rssi, vec![[0; 8]; 20_000]));
    let armbands = [armband(WORN, -50), armband(OTHER, -30)];
    let following = Cell::new(Following::Nobody);
    let observe = |session: &MyoSession| following.set(session.following());
    let packets = Packets::new();
    let session = MyoSession::new(Settings {
        bound: Some(WORN),
        ..Settings::default()
    });
    let driver = SessionDriver::new(session, Some(WORN), &packets, &observe);
    let shared = SharedFlash::new(Slow);
    let mut radio = SimulatedRadio {
        armbands: &armbands,
    };
    // Before the board is dropped, and its connection with it.
    let outcome = || {
        let now = Instant::now().as_micros();
        let all = armbands.each_ref();
        let streams = |one: &RefCell<Armband>| one.borrow().streams() && !one.borrow().is_lost();
        let is_free = |one: &RefCell<Armband>| one.borrow().advertisement(now).is_some();
        (following.get(), all.map(streams), all.map(is_free))
    };
    if is_exclusive {
        let mut radio = Exclusive(radio);
        play(
            pin!(driver.run(&mut radio, &shared)),
            &shared,
            acts,
            outcome,
        )
    } else {
        play(
            pin!(driver.run(&mut radio, &shared)),
            &shared,
            acts,
            outcome,
        )
    }
}

/// Poll of a task without a wake-up.
fn poll<F: Future>(future: Pin<&mut F>) -> Poll<F::Output> {
    future.poll(&mut Context::from_waker(Waker::noop()))
}

/// Lets time pass and events happen; returns their results.
fn play(
    mut board: Pin<&mut impl Future<Output = ()>>,
    flash: &SharedFlash<Slow>,
    acts: &[(u64, Act)],
    outcome: impl FnOnce() -> Outcome,
) -> Outcome {
    let start = Instant::now();
    let run_until = |board: &mut Pin<&mut _>, end_ms: u64| {
        while start.elapsed().as_millis() < end_ms {
            let left = end_ms - start.elapsed().as_millis();
            MockDriver::get().advance(Duration::from_millis(left.min(5)));
            assert!(poll(Pin::as_mut(board)).is_pending());
        }
    };
    let mut radio_turn: Option<MutexGuard<'_, NoopRawMutex, ()>> = None;
    for &(at_ms, act) in acts {
        run_until(&mut board, at_ms);
        match act {
            Act::Wish(command) => {
                let mut answer = pin!(BIND.ask(command));
                assert!(poll(answer.as_mut()).is_pending());
                assert!(poll(board.as_mut()).is_pending());
                assert!(poll(answer).is_ready(), "{command:?} is not answered");
            }
            Act::Model(true) => {
                radio_turn = None;
                model::set(Some(2));
            }
            Act::Model(false) => {
                model::set(None);
                let mut free = pin!(flash.radio_turn());
                while radio_turn.is_none() {
                    // The page may be written just now.
                    MockDriver::get().advance(Duration::from_millis(1));
                    assert!(poll(board.as_mut()).is_pending());
                    if let Poll::Ready(guard) = poll(free.as_mut()) {
                        radio_turn = Some(guard);
                    }
                }
            }
        }
    }
    let last_ms = acts.last().map_or(0, |(at_ms, _)| *at_ms);
    let pairs = acts.iter().any(|(_, act)| matches!(act, Act::Wish(Begin)));
    let pairing_ms = if pairs { PAIRING_MS } else { 0 };
    run_until(&mut board, last_ms + pairing_ms + SETTLED_MS);
    outcome()
}

#[test]
fn a_wish_at_any_moment_is_fulfilled_and_nobody_holds_another_armband() {
    let _alone = alone();
    let binding = &[(500, Act::Wish(Set(OTHER)))][..];
    let pairing = &[(0, Act::Wish(Begin))][..];
    let exchange = &[(600, Act::Model(false)), (1_600, Act::Model(true))][..];
    for (what, before, is_exclusive, moments) in [
        ("a connection", &[][..], false, 0..2_500),
        ("a binding", binding, false, 500..2_500),
        ("a pairing", pairing, false, 29_900..32_000),
        ("a pairing", pairing, true, 29_900..31_000),
        ("an installation", exchange, true, 500..3_000),
    ] {
        for at_ms in moments.step_by(STEP_MS) {
            for (wish, followed) in [
                (Forget, None),
                (Set(WORN), Some(WORN)),
                (Set(OTHER), Some(OTHER)),
                (Begin, Some(OTHER)),
            ] {
                let mut acts = before.to_vec();
                acts.push((at_ms, Act::Wish(wish)));
                acts.sort_by_key(|(at_ms, _)| *at_ms);
                let (follows, streams, free) = run(&acts, is_exclusive);
                let moment = format!("{wish:?} {at_ms} ms after the start of {what}");
                let expected = followed.map_or(Following::Nobody, Following::Bound);
                assert_eq!(follows, expected, "{moment}");
                assert_eq!(binding_region::load(), followed, "{moment}");
                let is_followed = [WORN, OTHER].map(|one| Some(one) == followed);
                assert_eq!(streams, is_followed, "{moment}");
                assert_eq!(free, is_followed.map(|is| !is), "{moment}");
            }
        }
    }
}
