//! Sources of a stream: a recording in real time, a board, or an armband. Each runs on its own thread until it is stopped.

#[cfg(any(feature = "bluetooth", test))]
pub(crate) mod bluetooth;
mod board;
mod playback;

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;

use shared::myo::Address;
use web::person::{Cues, Person};
use web::playback::SampleSource;
use web::request::SourceRequest;
use web::{SHIPPED, SharedCue, demo};

use self::board::BoardSource;
pub(crate) use self::board::no_port;
use self::playback::PlaybackSource;

/// Session that a demo follows, or a replay plays for.
#[derive(Debug)]
pub(crate) struct Guide {
    pub(crate) cue: SharedCue,
    /// Speed-up, at least 1.
    pub(crate) speed: u32,
    /// Number of files that earlier sessions of the person left: with it the simulated person never does the same twice.
    pub(crate) earlier: u64,
}
use super::hub::Hub;
use recordings::{DataSet, Recording};

/// Source of a stream.
#[derive(Clone, PartialEq, Debug)]
pub enum Source {
    /// Synthetic recording, repeated in real time.
    Demo,
    /// Recording, repeated in real time.
    Replay(Box<Recording>),
    /// Board on this serial port or pseudo-terminal.
    Port(PathBuf),
    /// Armband over this computer's own Bluetooth: the one of the address, or the one with the strongest signal.
    Bluetooth(Option<Address>),
}

impl Source {
    /// Describes the source in words, and whether its samples are synthetic.
    pub(super) fn described(&self) -> (String, bool) {
        match self {
            Self::Demo => ("demo".to_owned(), true),
            Self::Replay(recording) => (
                format!("replay of {}", recording.full_name()),
                recording.data_set == DataSet::SYNTHETIC,
            ),
            Self::Port(path) => (format!("port {}", path.display()), false),
            Self::Bluetooth(None) => ("any armband over Bluetooth".to_owned(), false),
            Self::Bluetooth(Some(address)) => (format!("{address} over Bluetooth"), false),
        }
    }

    /// Command-line option that selects this kind of source again.
    pub(super) fn option(&self) -> String {
        match self {
            Self::Port(path) => format!("--port {}", path.display()),
            Self::Bluetooth(None) => "--bluetooth any".to_owned(),
            Self::Bluetooth(Some(address)) => format!("--bluetooth {address}"),
            Self::Demo | Self::Replay(_) => "--demo".to_owned(),
        }
    }

    /// Streams until it is stopped.
    ///
    /// # Errors
    /// When the model is refused, or the source cannot be used.
    pub(super) fn run(
        self,
        model: Option<Vec<u8>>,
        guide: Option<Guide>,
        context: &Context,
    ) -> anyhow::Result<()> {
        let speed = guide.as_ref().map_or(1, |guide| guide.speed);
        let playback = |kind, name, samples, model: Option<Vec<u8>>| PlaybackSource {
            named: (kind, name),
            model: model.unwrap_or_else(|| SHIPPED.to_vec()),
            samples,
            speed,
        };
        let of = |recording: Recording| SampleSource::Recording {
            samples: recording.samples,
            labels: recording.labels,
        };
        match self {
            Self::Port(path) => BoardSource { path, model }.run(context),
            Self::Bluetooth(address) => follow(address, model, context),
            Self::Replay(recording) => {
                let name = recording.full_name();
                playback("replay", name, of(*recording), model).run(context)
            }
            Self::Demo => {
                let name = "simulated arm".to_owned();
                let follower = demo::follower();
                let person = match guide {
                    Some(Guide { cue, earlier, .. }) => {
                        Person::new(follower.another_time(earlier), Cues::Session(cue))
                    }
                    None => Person::new(follower, Cues::List(demo::cues())),
                };
                let emg = SampleSource::Person(Box::new(person));
                playback("demo", name, emg, model).run(context)
            }
        }
    }
}

/// Channels of a source.
#[derive(Debug)]
pub(crate) struct Context {
    pub(crate) hub: Arc<Hub>,
    pub(crate) requests: Receiver<SourceRequest>,
    pub(crate) stop: Stop,
    /// Whether the armband's movement is wanted too.
    pub(crate) imu: bool,
}

/// Stop request, shared by all clones.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stop(Arc<AtomicBool>);

impl Stop {
    pub(crate) fn request(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    pub(crate) fn requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Follows an armband over Bluetooth.
#[cfg(feature = "bluetooth")]
fn follow(
    address: Option<Address>,
    model: Option<Vec<u8>>,
    context: &Context,
) -> anyhow::Result<()> {
    let model = model.unwrap_or_else(|| SHIPPED.to_vec());
    self::bluetooth::ArmbandSource { address, model }.run(context)
}

/// Fails: the program was built without Bluetooth.
#[cfg(not(feature = "bluetooth"))]
fn follow(_: Option<Address>, _: Option<Vec<u8>>, _: &Context) -> anyhow::Result<()> {
    anyhow::bail!("this program was built without Bluetooth")
}
