//! An armband over this computer's own Bluetooth, without a board.
//!
//! ```text
//! web::armband  -- actions -->  adapter (btleplug; feature `bluetooth`)  -- radio -->  armband
//!               <-- heard ----
//! ```

#[cfg(feature = "bluetooth")]
mod adapter;
#[cfg(feature = "bluetooth")]
mod link;
#[cfg(test)]
mod tests;

use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use anyhow::bail;
use shared::myo::{self, Action, Address};
use tokio::sync::mpsc::UnboundedSender;
use web::armband::{Armband, Now, Output};
use web::radio::RadioEvent;
use web::scored_pipeline::ScoredPipeline;

use super::Context;

/// Pause between two ticks of the session, as on a board.
const TICK: Duration = Duration::from_millis(50);

/// Armband to follow, and the model that labels its samples.
#[derive(Debug)]
pub(crate) struct ArmbandSource {
    /// Address of the armband; none for the one with the strongest signal.
    pub(crate) address: Option<Address>,
    pub(crate) model: Vec<u8>,
}

impl ArmbandSource {
    /// Follows the armband until it is stopped.
    ///
    /// # Errors
    /// When the model is refused, or there is no Bluetooth adapter or it is lost.
    #[cfg(feature = "bluetooth")]
    pub(crate) fn run(&self, context: &Context) -> anyhow::Result<()> {
        self.run_on(&adapter::open()?, context)
    }

    fn run_on(&self, radio: &Radio, context: &Context) -> anyhow::Result<()> {
        let hub = &context.hub;
        let scored = ScoredPipeline::open(&self.model)?;
        let here = ("this computer", None);
        let emit = &mut |event| hub.publish(&event);
        let settings = myo::Settings {
            pinned: self.address,
            imu: context.imu,
            ..myo::Settings::default()
        };
        let mut armband = Armband::begin(settings, here, scored, hub.now(), emit);
        let output = &mut |output| match output {
            Output::Event(event) => hub.publish(&event),
            Output::Radio(Action::StreamEnded) => hub.forget_stream(),
            // An adapter that is gone reports that.
            Output::Radio(action) => drop(radio.actions.send(action)),
        };
        let mut due = Instant::now();
        while !context.stop.requested() {
            let now = || Now {
                session: hub.millis(),
                at: hub.now(),
            };
            while let Ok(request) = context.requests.try_recv() {
                armband.request(now(), &request, emit);
            }
            let wait = due.saturating_duration_since(Instant::now());
            match radio.events.recv_timeout(wait) {
                Ok(RadioEvent::Gone(why)) => bail!("Bluetooth: {why}"),
                Ok(event) => armband.handle(now(), event.as_event(), output),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => bail!("Bluetooth has ended"),
            }
            if Instant::now() >= due {
                armband.handle(now(), myo::Event::Tick, output);
                due = Instant::now() + TICK;
            }
        }
        // The adapter ends with its channel; the connection ends first.
        let _ = radio.actions.send(Action::Disconnect);
        Ok(())
    }
}

/// Session's ends of the channels to a Bluetooth stack, which has a thread of its own.
#[derive(Debug)]
struct Radio {
    /// Actions for the stack, in order. Closing the channel ends the stack.
    actions: UnboundedSender<Action>,
    /// Results of actions, and events of the stack.
    events: Receiver<RadioEvent>,
}
