//! Requests of the control task to another task, which answers each.

use embassy_sync::{
    blocking_mutex::raw::CriticalSectionRawMutex, channel::Channel, signal::Signal,
};
use embassy_time::{Duration, with_timeout};
use shared::installation::{Block, Progress, Transfer};
use shared::stream::alignment::Alignment;
use shared::stream::smoother::Gate;
use shared::uart_line::answer::{Binding, Refusal};
use shared::uart_line::command::{AlignCommand, BindCommand};
use shared::uart_line::gate::GateCommand;

use crate::model_region::ModelRefused;

/// To the inference.
pub static INFERENCE: Requests<InferenceRequest, InferenceAnswer> = Requests::new();

/// What the inference is asked for.
#[derive(Clone, Copy)]
pub enum InferenceRequest {
    /// An alignment.
    Align(AlignCommand),
    /// The confidence gate.
    Gate(GateCommand),
    /// Enter the safe state, and read the model's region no more.
    Suspend,
    /// The region holds no model, for this reason.
    Refuse(ModelRefused),
    /// Put the region's model in use.
    Resume,
}

/// What the inference answers.
#[derive(Clone, Copy)]
pub enum InferenceAnswer {
    /// This is accepted.
    Align(AlignCommand),
    /// This alignment is in force.
    Alignment(Alignment),
    /// This gate is in force from now on.
    Gate(Gate),
    /// It is done.
    Done,
}

/// To the task that exchanges the model.
pub static INSTALLATION: Requests<InstallationRequest, Progress> = Requests::new();

/// What it is asked for.
#[derive(Clone, Copy)]
pub enum InstallationRequest {
    /// Begin, or go on.
    Begin(Transfer),
    /// Take a block.
    Block(u32, Block),
}

/// To the radio.
pub static BIND: Requests<BindCommand, Binding> = Requests::new();

/// A task that does not answer for so long is busy, or does not run.
const PATIENCE: Duration = Duration::from_secs(1);

/// Requests of one task to one other, one at a time.
pub struct Requests<Q, A> {
    asked: Channel<CriticalSectionRawMutex, Q, 1>,
    answered: Signal<CriticalSectionRawMutex, Result<A, Refusal>>,
}

impl<Q, A> Requests<Q, A> {
    const fn new() -> Self {
        Self {
            asked: Channel::new(),
            answered: Signal::new(),
        }
    }

    /// Asks, and waits for the answer.
    ///
    /// # Errors
    /// What the other task answers, or that it does not answer in time.
    pub async fn ask(&self, request: Q) -> Result<A, Refusal> {
        self.asked.clear();
        self.answered.reset();
        self.asked.send(request).await;
        let answer = with_timeout(PATIENCE, self.answered.wait()).await;
        answer.unwrap_or(Err(Refusal::Busy))
    }

    /// Waits for a request.
    pub async fn receive(&self) -> Q {
        self.asked.receive().await
    }

    /// Answers the request received last.
    pub fn answer(&self, answer: Result<A, Refusal>) {
        self.answered.signal(answer);
    }
}
