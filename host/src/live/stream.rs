//! Thread that runs the engine: requests of viewers, what devices send and what became of the journal go in; its outputs go
//! where they belong. It waits for nobody.

use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime};

use anyhow::{Context as _, bail};
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;
use shared::myo::Action;
use tokio::sync::mpsc::UnboundedSender;
use web::SHIPPED;
use web::engine::{Engine, Output, Settings, Stored};
use web::event::{Event, ViewerId};
use web::radio::RadioEvent;
use web::request::ViewerMessage;
use web::said::Said;

use super::hub::Hub;
use super::line::Line;
use super::storage::{Storage, Work};
use super::{Options, Source};

/// Stack size of the thread in bytes: room for the state of the largest accepted model.
const STACK: usize = 16 << 20;

/// Input of the engine's thread.
pub(crate) enum Input {
    /// Request of a viewer.
    Request(ViewerId, ViewerMessage),
    /// A viewer has left.
    Left(ViewerId),
    /// The board's port is open, or cannot be used: the reason, and steps that help.
    Port(Result<(), (Said, Vec<Said>)>),
    /// Bytes of the board.
    Heard(Vec<u8>),
    /// Event of the Bluetooth stack.
    #[cfg_attr(
        not(any(test, feature = "bluetooth")),
        expect(dead_code, reason = "of the adapter")
    )]
    Radio(RadioEvent),
    /// Outcome of the journal's lines.
    Stored(Stored),
    /// Model that was tuned on the recordings.
    #[cfg_attr(not(feature = "train"), expect(dead_code, reason = "of the tune step"))]
    Tuned(Vec<u8>),
    /// Event of a tuning.
    Event(Event),
    /// End of the program.
    Stop,
}

/// Device of the source.
enum Device {
    /// None: samples are played.
    None,
    Board(Line),
    /// Bluetooth stack, which ends with the channel.
    Radio(UnboundedSender<Action>),
}

/// Running engine.
#[derive(Debug)]
pub(super) struct Stream {
    pub(super) hub: Arc<Hub>,
    pub(super) inputs: Sender<Input>,
    thread: JoinHandle<anyhow::Result<()>>,
}

impl Stream {
    /// Starts the thread.
    ///
    /// # Errors
    /// When the model is refused.
    pub(super) fn start(hub: Arc<Hub>, options: Options) -> anyhow::Result<Self> {
        if let Some(bytes) = &options.model {
            let model = Model::parse(bytes).context("the model is refused")?;
            HostEncoder::new(&model).context("the model is refused")?;
        }
        let (inputs, received) = mpsc::channel();
        let (own, sender) = (hub.clone(), inputs.clone());
        let thread = std::thread::Builder::new()
            .name("engine".to_owned())
            .stack_size(STACK)
            .spawn(move || Running::begin(own, options, &sender)?.run(&received))?;
        Ok(Self {
            hub,
            inputs,
            thread,
        })
    }

    /// Whether the source has ended by an error, or an unattended session is over.
    pub(super) fn is_finished(&self) -> bool {
        self.thread.is_finished()
    }

    /// Ends the thread and returns the error that ended it before.
    pub(super) fn stop(self) -> anyhow::Result<()> {
        // It may have ended.
        let _ = self.inputs.send(Input::Stop);
        match self.thread.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

/// Engine, and where its outputs go.
struct Running {
    hub: Arc<Hub>,
    engine: Engine,
    device: Device,
    storage: Option<Storage>,
    /// Bytes of the newest tuned model file.
    tuned: Option<Vec<u8>>,
    unattended: bool,
}

impl Running {
    fn begin(hub: Arc<Hub>, options: Options, sender: &Sender<Input>) -> anyhow::Result<Self> {
        let Options {
            source,
            model,
            imu,
            record,
            ..
        } = options;
        let mut engine = Engine::default();
        let (now, option) = (hub.now(), source.option());
        let port = match &source {
            Source::Port(path) => Some(path.clone()),
            _ => None,
        };
        let settings = Settings {
            now,
            model: model.as_deref(),
            imu,
            speed: record.as_ref().map_or(1, |record| record.speed.max(1)),
        };
        let earlier = record.as_ref().map(|record| {
            let files = std::fs::read_dir(record.folder.join(&record.person));
            files.map_or(0, |files| files.count() as u64)
        });
        match &source {
            Source::Demo => engine.demo(&settings, earlier)?,
            Source::Replay(recording) => engine.replay(&settings, (**recording).clone())?,
            Source::Port(path) => engine.board(&settings, path.display().to_string(), true)?,
            Source::Bluetooth(address) => engine.armband(&settings, *address)?,
        }
        let device = match source {
            Source::Demo | Source::Replay(_) => Device::None,
            Source::Port(path) => Device::Board(Line::start(path, imu, sender.clone())?),
            Source::Bluetooth(_) => Device::Radio(radio(sender.clone())?),
        };
        let unattended = record.as_ref().is_some_and(|record| record.unattended);
        let storage = record.map(|record| {
            let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
            let time = since.unwrap_or_default().as_secs_f64() * 1000.0;
            engine.record(
                now,
                record.person.clone(),
                record.protocol.clone(),
                time,
                false,
            );
            let model = model.unwrap_or_else(|| SHIPPED.to_vec());
            Storage::start(record, model, port, option, sender.clone())
        });
        Ok(Self {
            hub,
            engine,
            device,
            storage: storage.transpose()?,
            tuned: None,
            unattended,
        })
    }

    /// Runs until it is stopped or an unattended session is over; then ends and keeps the session in progress.
    fn run(mut self, inputs: &Receiver<Input>) -> anyhow::Result<()> {
        let mut result = self.go_on(inputs);
        self.engine.finish(self.hub.now());
        self.deliver();
        match self.device {
            Device::None => {}
            Device::Board(line) => line.stop(),
            // The connection ends before its channel.
            Device::Radio(actions) => drop(actions.send(Action::Disconnect)),
        }
        self.device = Device::None;
        if let Some(storage) = self.storage.take() {
            result = result.and(storage.stop());
        }
        for input in inputs.try_iter() {
            if let Input::Stored(_) | Input::Event(_) = input {
                result = result.and(self.handle(input));
            }
        }
        self.deliver();
        result
    }

    fn go_on(&mut self, inputs: &Receiver<Input>) -> anyhow::Result<()> {
        loop {
            self.deliver();
            let wait = Duration::from_secs_f64(self.engine.wait(self.hub.now()) / 1000.0);
            match inputs.recv_timeout(wait) {
                Ok(Input::Stop) | Err(RecvTimeoutError::Disconnected) => return Ok(()),
                Ok(input) => self.handle(input)?,
                Err(RecvTimeoutError::Timeout) => {}
            }
            self.engine.tick(self.hub.now());
            if self.unattended {
                let over = self.engine.lead_unattended(self.hub.now());
                if over.map_err(anyhow::Error::msg)? {
                    return Ok(());
                }
            }
        }
    }

    fn handle(&mut self, input: Input) -> anyhow::Result<()> {
        let now = self.hub.now();
        let engine = &mut self.engine;
        match input {
            Input::Request(viewer, message) => engine.request_of(now, viewer, &message),
            Input::Left(viewer) => engine.left(now, viewer),
            Input::Port(opened) => engine.port(now, opened),
            Input::Heard(bytes) => engine.heard(now, &bytes),
            Input::Radio(RadioEvent::Gone(why)) => bail!("Bluetooth: {why}"),
            Input::Radio(event) => engine.radio(now, &event),
            Input::Stored(stored) => engine.stored(now, stored),
            Input::Tuned(model) => self.tuned = Some(model),
            Input::Event(event) => engine.event(now, event),
            Input::Stop => {}
        }
        Ok(())
    }

    fn deliver(&mut self) {
        for output in self.engine.take() {
            match output {
                Output::Event(event) => self.hub.send(None, &event),
                Output::Answer(viewer, event) => self.hub.send(Some(viewer), &event),
                Output::Journal(lines) => self.store(Work::Lines(lines)),
                Output::Remark(lines) => self.store(Work::Remark(lines)),
                Output::Tune => {
                    self.tuned = None;
                    self.store(Work::Tune);
                }
                Output::Install => {
                    if let Some(tuned) = &self.tuned {
                        // There is always a source.
                        let _ = self.engine.install(self.hub.now(), tuned);
                    }
                }
                Output::Line { line } => {
                    if let Device::Board(board) = &self.device {
                        board.send(line);
                    }
                }
                Output::Radio(action) => {
                    if let Device::Radio(actions) = &self.device {
                        // An adapter that is gone reports that.
                        let _ = actions.send(action);
                    }
                }
                // The line knows it.
                Output::Leave { .. } => {}
            }
        }
    }

    fn store(&self, work: Work) {
        if let Some(storage) = &self.storage {
            storage.send(work);
        }
    }
}

#[cfg(feature = "bluetooth")]
fn radio(inputs: Sender<Input>) -> anyhow::Result<UnboundedSender<Action>> {
    super::bluetooth::open(inputs)
}

/// Fails: the program was built without Bluetooth.
#[cfg(not(feature = "bluetooth"))]
fn radio(_: Sender<Input>) -> anyhow::Result<UnboundedSender<Action>> {
    bail!("this program was built without Bluetooth")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_adapter_that_is_gone_ends_the_stream_with_its_reason() {
        let hub = Arc::new(Hub::new());
        let stream = Stream::start(hub, Options::of(Source::Demo)).unwrap();
        let gone = RadioEvent::Gone("it is switched off".to_owned());
        stream.inputs.send(Input::Radio(gone)).unwrap();
        let error = stream.stop().unwrap_err();
        assert!(error.to_string().contains("switched off"), "{error}");
    }
}
