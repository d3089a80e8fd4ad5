//! Sources of an engine, as they are opened.

use std::path::Path;

use recordings::labels::motion::Motion;
use recordings::{DataSet, LoadOptions, Recording, load_bytes};
use serde::Deserialize;
use shared::myo::{self, Address};

use super::{Engine, Output, Running, Simulated, millis, source};
use crate::armband::Armband;
use crate::board::{self, Board};
use crate::event::Event;
use crate::person::{Cues, DemoPerson};
use crate::playback::{PERIOD, Playback, SampleSource};
use crate::said::Said;
use crate::scored_pipeline::{Refused, ScoredPipeline};
use crate::simulated_board::SimulatedBoard;
use crate::{SHIPPED, demo};

/// Address that stands for the armband that the wearer has chosen: a browser names none.
const CHOSEN: [u8; 6] = [1, 0, 0, 0, 0, 0xc0];

/// Name of the port that the user has chosen: a browser names none.
const PORT: &str = "USB";

/// Port of the simulated board.
const SIMULATED: &str = "simulated USB";

/// Source that a page asks for.
#[derive(Clone, PartialEq, Eq, Debug, Deserialize)]
#[serde(tag = "source", rename_all = "snake_case", deny_unknown_fields)]
pub enum Wanted {
    /// Simulated person.
    Demo,
    /// File of a recording.
    Recording {
        /// Name of the file.
        name: String,
    },
    /// Board on a serial port.
    Port,
    /// Simulated board.
    SimulatedBoard,
    /// Armband.
    Bluetooth {
        /// Name of the armband.
        name: String,
    },
}

/// Settings of a source.
#[derive(Clone, Copy, Debug)]
pub struct Settings<'m> {
    /// Present time in ms.
    pub now: f64,
    /// Bytes of a model file. Without one, a board has no scores, and the others run the shipped one.
    pub model: Option<&'m [u8]>,
    /// Whether the armband's movement is asked for too.
    pub imu: bool,
    /// Speed-up of a demo or a recording, at least 1.
    pub speed: u32,
}

impl Settings<'_> {
    fn scored(&self) -> Result<ScoredPipeline, Refused> {
        ScoredPipeline::open(self.model.unwrap_or(SHIPPED))
    }
}

impl Engine {
    /// Opens the source that a page asks for. `file` is the content of a recording's file, and `model` that of a model file; none
    /// for the shipped one.
    pub fn open(now: f64, wanted: &Wanted, file: &[u8], model: Option<&[u8]>) -> Self {
        let mut engine = Self::default();
        engine
            .outputs
            .event(now, Event::hello(now, 1, false, false));
        let settings = Settings {
            now,
            model: model.or(Some(SHIPPED)),
            imu: true,
            speed: 1,
        };
        if let Err(why) = engine.run(&settings, wanted, file) {
            let (kind, name) = match wanted {
                Wanted::Demo => ("demo", ""),
                Wanted::Recording { name } => ("replay", &**name),
                Wanted::Port => ("port", PORT),
                Wanted::SimulatedBoard => ("port", SIMULATED),
                Wanted::Bluetooth { name } => ("bluetooth", &**name),
            };
            let state = source(kind, name, false, Some(why), Vec::new());
            engine.outputs.event(now, state);
        }
        engine
    }

    fn run(&mut self, settings: &Settings<'_>, wanted: &Wanted, file: &[u8]) -> Result<(), Said> {
        let opened = match wanted {
            Wanted::Demo => self.demo(settings, None),
            Wanted::Recording { name } => self.replay(settings, read(name, file)?),
            Wanted::Port => {
                let leave = board::leave(true);
                self.outputs.waiting.push(Output::Leave { leave });
                let opened = self.board(settings, PORT.to_owned(), false);
                self.port(settings.now, Ok(()));
                opened
            }
            Wanted::SimulatedBoard => return self.simulated_board(settings),
            Wanted::Bluetooth { name } => {
                let here = ("this browser", Some(name.clone()));
                self.follow(settings, Some(chosen()), here, Some(false))
            }
        };
        opened.map_err(|error| Said::of("model", &error))
    }

    /// Plays a simulated person; `earlier` is the number of files of earlier sessions, with which the person never does the same
    /// twice, and none for a person who follows no session.
    ///
    /// # Errors
    /// When the model is refused; so do the other sources.
    pub fn demo(&mut self, settings: &Settings<'_>, earlier: Option<u64>) -> Result<(), Refused> {
        self.source = ("demo".to_owned(), true);
        let person = match earlier {
            Some(earlier) => {
                let follower = demo::follower().another_time(earlier);
                DemoPerson::new(follower, Cues::Session(Motion::RELAX))
            }
            None => DemoPerson::new(demo::follower(), Cues::List(demo::cues())),
        };
        let named = ("demo", "simulated arm".to_owned());
        self.play(settings, named, SampleSource::Person(Box::new(person)))
    }

    /// Plays a recording again and again.
    ///
    /// # Errors
    /// When the model is refused.
    pub fn replay(&mut self, settings: &Settings<'_>, own: Recording) -> Result<(), Refused> {
        let name = own.full_name();
        self.source = (
            format!("replay of {name}"),
            own.data_set == DataSet::SYNTHETIC,
        );
        let (samples, labels) = (own.samples, own.labels);
        let samples = SampleSource::Recording { samples, labels };
        self.play(settings, ("replay", name), samples)
    }

    fn play(
        &mut self,
        settings: &Settings<'_>,
        named: (&'static str, String),
        samples: SampleSource,
    ) -> Result<(), Refused> {
        let (now, scored) = (settings.now, settings.scored()?);
        let outputs = &mut self.outputs;
        let emit = &mut |event| outputs.event(now, event);
        self.running = Running::Playback {
            playback: Playback::begin(named, samples, scored, now, emit),
            due: now,
            period: PERIOD.as_secs_f64() * 1000.0 / f64::from(settings.speed),
        };
        Ok(())
    }

    /// Reads a board on a port that is not open yet. Scores are those of a model, shown always, or once the board runs the same.
    ///
    /// # Errors
    /// When the model is refused.
    pub fn board(
        &mut self,
        settings: &Settings<'_>,
        port: String,
        always: bool,
    ) -> Result<(), Refused> {
        self.source = (format!("port {port}"), false);
        let now = settings.now;
        let scored = settings.model.map(ScoredPipeline::open).transpose()?;
        if let Some(scored) = scored.as_ref().filter(|_| always) {
            self.outputs.event(now, Event::of_model(scored.model()));
        }
        self.running = Running::Board {
            board: Board::new(millis(now), settings.imu, scored, always),
            port,
            is_open: false,
            simulated: None,
        };
        Ok(())
    }

    /// Reads a simulated board that runs the page's model.
    ///
    /// # Errors
    /// When no board can run the model.
    fn simulated_board(&mut self, settings: &Settings<'_>) -> Result<(), Said> {
        let person = DemoPerson::new(demo::follower(), Cues::List(demo::cues()));
        let started = SimulatedBoard::start(settings.model.unwrap_or(SHIPPED), person);
        let started = Box::new(started.map_err(|error| Said::of("board", &error))?);
        let opened = self.board(settings, SIMULATED.to_owned(), false);
        opened.map_err(|error| Said::of("model", &error))?;
        self.source = (SIMULATED.to_owned(), true);
        if let Running::Board { simulated, .. } = &mut self.running {
            *simulated = Some(Simulated {
                board: started,
                due: settings.now,
            });
        }
        self.port(settings.now, Ok(()));
        Ok(())
    }

    /// Follows an armband over a radio that scans itself: the one of the address, or the one with the strongest signal.
    ///
    /// # Errors
    /// When the model is refused.
    pub fn armband(
        &mut self,
        settings: &Settings<'_>,
        pinned: Option<Address>,
    ) -> Result<(), Refused> {
        self.follow(settings, pinned, ("this computer", None), None)
    }

    fn follow(
        &mut self,
        settings: &Settings<'_>,
        pinned: Option<Address>,
        here: (&'static str, Option<String>),
        scans: Option<bool>,
    ) -> Result<(), Refused> {
        let address = || pinned.map(|address| address.to_string());
        let name = here.1.clone().or_else(address);
        let name = name.unwrap_or_else(|| "any armband".to_owned());
        self.source = (format!("{name} over Bluetooth"), false);
        let session = myo::Settings {
            pinned,
            imu: settings.imu,
            ..myo::Settings::default()
        };
        let (now, scored) = (settings.now, settings.scored()?);
        let outputs = &mut self.outputs;
        let emit = &mut |event| outputs.event(now, event);
        self.running = Running::Armband {
            armband: Armband::begin(session, here, scored, now, emit),
            due: now,
            scans,
        };
        Ok(())
    }
}

/// The armband that the wearer has chosen.
pub(super) const fn chosen() -> Address {
    Address {
        bytes: CHOSEN,
        kind: myo::AddressKind::Random,
    }
}

/// Reads the first recording of a file.
fn read(name: &str, bytes: &[u8]) -> Result<Recording, Said> {
    let library = load_bytes(Path::new(name), bytes, &LoadOptions::default());
    let recordings = library.map_err(Said::plain)?.recordings;
    let first = recordings.into_iter().next();
    first.ok_or_else(|| Said::named("open.empty".to_owned(), "it has no recording"))
}
