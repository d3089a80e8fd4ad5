//! Requests of one task to another, which answers each.

use core::sync::atomic::{AtomicU8, Ordering};

use embassy_sync::{blocking_mutex::raw::CriticalSectionRawMutex, signal::Signal};
use embassy_time::{Duration, with_timeout};
use shared::installation::{Block, InstallationProgress, Transfer};
use shared::pipeline::Done;
use shared::uart_line::answer::{Binding, Refusal};
use shared::uart_line::calibration::CalibrateCommand;
use shared::uart_line::command::{AlignCommand, BindCommand};
use shared::uart_line::gate::GateCommand;
use shared::uart_line::lock::LockCommand;

/// Requests from the control task to the inference.
pub static INFERENCE: Requests<InferenceRequest, Done> = Requests::new();

#[derive(Clone, Copy)]
pub enum InferenceRequest {
    Align(AlignCommand),
    Gate(GateCommand),
    Lock(LockCommand),
    Calibrate(CalibrateCommand),
    /// The button was pressed: end a calibration, unlock labels that are locked, or begin an alignment.
    Press,
}

/// Requests from the installation to the inference. A channel of its own: flash is erased on the strength of its answer.
pub static MODEL: Requests<ModelRequest, ()> = Requests::new();

#[derive(Clone, Copy)]
pub enum ModelRequest {
    /// Enter the safe state, and read the model's region no more.
    Suspend,
    /// Check that the region holds a model that can be run, and say why not.
    Verify,
    /// Put the region's model in use.
    Resume,
}

/// Requests from the control task to the installation.
pub static INSTALLATION: Requests<InstallationRequest, InstallationProgress> = Requests::new();

#[derive(Clone, Copy)]
pub enum InstallationRequest {
    /// Begin, or go on.
    Begin(Transfer),
    /// Take a block.
    Block(u32, Block),
}

/// Requests from the control task to the task that keeps the outputs to a computer.
#[cfg(feature = "uf2")]
pub static HID: Requests<shared::hid::HidCommand, shared::hid::Settings> = Requests::new();

/// Requests from the control task to the radio.
pub static BIND: Requests<BindCommand, Binding> = Requests::new();

/// Time without an answer after which a task counts as busy.
const PATIENCE: Duration = Duration::from_secs(1);

/// Number of a request, which its answer carries too.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Ticket(u8);

/// Requests of one task to one other, one at a time.
pub struct Requests<Q, A> {
    tickets: AtomicU8,
    asked: Signal<CriticalSectionRawMutex, (Ticket, Q)>,
    /// The newest answer, and whose it is.
    answer: Signal<CriticalSectionRawMutex, Result<A, Refusal>>,
    answered: Signal<CriticalSectionRawMutex, Ticket>,
}

impl<Q, A> Requests<Q, A> {
    const fn new() -> Self {
        Self {
            tickets: AtomicU8::new(0),
            asked: Signal::new(),
            answer: Signal::new(),
            answered: Signal::new(),
        }
    }

    /// Asks, and waits for the answer. To be called by one task alone.
    pub async fn ask(&self, request: Q) -> Result<A, Refusal> {
        let own = Ticket(self.tickets.fetch_add(1, Ordering::Relaxed));
        self.asked.signal((own, request));
        if is_answered(&self.answered, own).await {
            return self.answer.try_take().unwrap_or(Err(Refusal::Busy));
        }
        // Otherwise it would be carried out after its caller has gone.
        self.asked.reset();
        Err(Refusal::Busy)
    }

    /// Waits for a request, which is answered with its ticket.
    pub async fn receive(&self) -> (Ticket, Q) {
        self.asked.wait().await
    }

    pub fn answer(&self, ticket: Ticket, answer: Result<A, Refusal>) {
        self.answer.signal(answer);
        self.answered.signal(ticket);
    }
}

/// Waits until a request is answered; false if that takes too long. The same code for all requests: it is long on a board.
async fn is_answered(answered: &Signal<CriticalSectionRawMutex, Ticket>, own: Ticket) -> bool {
    // Answers to earlier requests, which were given up, are passed over.
    let answer = async { while answered.wait().await != own {} };
    with_timeout(PATIENCE, answer).await.is_ok()
}

#[cfg(test)]
mod tests {
    use core::pin::pin;
    use core::task::{Context, Poll, Waker};

    use embassy_time::MockDriver;

    use shared::stream::smoother::Gate;

    use super::*;
    use crate::clock::alone;

    /// The result of a future that is polled once.
    macro_rules! now {
        ($future:expr) => {
            $future
                .as_mut()
                .poll(&mut Context::from_waker(Waker::noop()))
        };
    }

    /// The request that waits, if any.
    fn taken<Q, A>(requests: &Requests<Q, A>) -> Option<(Ticket, Q)> {
        let mut receiving = pin!(requests.receive());
        match now!(receiving) {
            Poll::Ready(request) => Some(request),
            Poll::Pending => None,
        }
    }

    #[test]
    fn control_and_installation_ask_the_inference_at_once_and_each_gets_its_own_answer() {
        let _alone = alone();
        let mut installation = pin!(MODEL.ask(ModelRequest::Suspend));
        let mut control = pin!(INFERENCE.ask(InferenceRequest::Gate(GateCommand::State)));
        assert!(now!(installation).is_pending() && now!(control).is_pending());
        // The gate is answered first. Flash would be erased under a model in use.
        let (ticket, _) = taken(&INFERENCE).unwrap();
        INFERENCE.answer(ticket, Ok(Done::Gate(Gate::default())));
        assert!(now!(installation).is_pending(), "not suspended");
        assert!(matches!(now!(control), Poll::Ready(Ok(Done::Gate(_)))));
        let (ticket, request) = taken(&MODEL).unwrap();
        assert!(matches!(request, ModelRequest::Suspend));
        MODEL.answer(ticket, Ok(()));
        assert_eq!(now!(installation), Poll::Ready(Ok(())));
    }

    #[test]
    fn a_late_answer_is_not_taken_for_that_of_the_next_request() {
        let _alone = alone();
        let requests = Requests::<u8, u8>::new();
        let mut first = pin!(requests.ask(1));
        assert!(now!(first).is_pending());
        let (late, _) = taken(&requests).unwrap();
        MockDriver::get().advance(PATIENCE);
        assert_eq!(now!(first), Poll::Ready(Err(Refusal::Busy)));
        let mut second = pin!(requests.ask(2));
        assert!(now!(second).is_pending());
        requests.answer(late, Ok(10));
        assert!(now!(second).is_pending(), "the answer to the first");
        let (ticket, request) = taken(&requests).unwrap();
        assert_eq!(request, 2);
        requests.answer(ticket, Ok(20));
        assert_eq!(now!(second), Poll::Ready(Ok(20)));
    }

    #[test]
    fn a_request_that_was_given_up_is_not_carried_out_later() {
        let _alone = alone();
        let requests = Requests::<u8, u8>::new();
        let mut asking = pin!(requests.ask(1));
        assert!(now!(asking).is_pending());
        MockDriver::get().advance(PATIENCE);
        assert_eq!(now!(asking), Poll::Ready(Err(Refusal::Busy)));
        assert!(taken(&requests).is_none());
    }
}
