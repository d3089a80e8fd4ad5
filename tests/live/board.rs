//! Board at the other end of a pseudo-terminal: answers commands, streams samples and the pipeline's labels.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

pub use myointent_tests::bench::terminal;
use serial2::SerialPort;
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;
use shared::model::noise::Noise;
use shared::myo::{Address, Counters, Following};
use shared::pipeline::Pipeline;
use shared::stream::smoother::Gate;
use shared::uart_line::answer::{Accepted, Answer, Binding, Counts, Identity, Refusal};
use shared::uart_line::calibration::CalibrationReport;
use shared::uart_line::command::{AlignCommand, BindCommand, Command, CommandReader};
use shared::uart_line::emg::EmgReport;
use shared::uart_line::gate::GateCommand;
use shared::units::{Millis, Sample, SampleIndex};

use super::worker::Worker;
use super::{shipped, synthetic};

/// Time between two notifications: a quarter of an armband's period.
const PACE: Duration = Duration::from_micros(2500);
/// Number of notifications that a pairing lasts: 5 s, so that a busy machine sees it.
const PAIRING: usize = 2000;

/// Number of times that a test pulls the line.
pub const CUTS: usize = 100;

/// Board that runs until it is dropped.
pub struct Board {
    raw: Arc<AtomicBool>,
    cuts: Arc<AtomicUsize>,
    _worker: Worker,
}

impl Board {
    /// Plays a board whose terminal is at the path `link`.
    pub fn start(link: &Path) -> Self {
        Self::pulled(link, Vec::new())
    }

    /// Plays a board to which no armband is bound yet. A first pairing hears no armband, a second one does. Its wearer rests,
    /// so that no alignment succeeds.
    pub fn unbound(link: &Path) -> Self {
        Self::play(link, Vec::new(), Following::Nobody)
    }

    /// Plays a board that stays on while its line is pulled and put back, once for each of `dialogues`. Each gives the
    /// bytes in both directions after which the line is pulled, counted from the first byte that a PC sends. The
    /// machine's load therefore moves no cut.
    pub fn pulled(link: &Path, dialogues: Vec<usize>) -> Self {
        Self::play(link, dialogues, Following::Pinned(armband()))
    }

    fn play(link: &Path, dialogues: Vec<usize>, following: Following) -> Self {
        let raw = Arc::<AtomicBool>::default();
        let cuts = Arc::default();
        let wire = Wire {
            terminal: Terminal::new(link),
            link: link.to_owned(),
            dialogues: dialogues.into_iter(),
            left: None,
            cuts: Arc::clone(&cuts),
        };
        let is_raw = raw.clone();
        Self {
            raw,
            cuts,
            _worker: Worker::start(move |stop| run(wire, following, stop, &is_raw)),
        }
    }

    /// Returns true if the raw stream is on.
    pub fn is_raw(&self) -> bool {
        self.raw.load(Ordering::Relaxed)
    }

    /// Returns the number of times that the line was pulled.
    pub fn cuts(&self) -> usize {
        self.cuts.load(Ordering::Relaxed)
    }
}

/// Both ends of a pseudo-terminal, and a link to it that outlasts it.
pub struct Terminal {
    pub master: SerialPort,
    _slave: SerialPort,
}

impl Terminal {
    pub fn new(link: &Path) -> Self {
        let (mut master, slave) = SerialPort::pair().unwrap();
        // A read sets the pace, and a write never waits for long.
        master.set_read_timeout(PACE).unwrap();
        master.set_write_timeout(8 * PACE).unwrap();
        let _ = std::fs::remove_file(link);
        std::os::unix::fs::symlink(terminal(&slave), link).unwrap();
        Self {
            master,
            _slave: slave,
        }
    }
}

/// Returns the address of the armband that is bound, or heard in a pairing.
fn armband() -> Address {
    Address::parse("FA:12:34:56:78:9A").unwrap()
}

/// Returns a minute of a hand at rest.
fn rest() -> Vec<Sample> {
    let mut noise = Noise(5);
    (0..12_000).map(|_| noise.sample(3.0)).collect()
}

/// Streams a recording with labels at four times its speed, until it is stopped.
fn run(mut wire: Wire, mut following: Following, stop: &AtomicBool, raw: &AtomicBool) {
    let bytes = shipped();
    let model = Model::parse(&bytes).unwrap();
    let encoder = HostEncoder::new(&model).unwrap();
    let mut state = shared::model::Encode::fresh(&encoder);
    let mut pipeline = Pipeline::of_model(&model, encoder, &mut state).unwrap();
    let samples = match following {
        Following::Nobody => rest(),
        _ => synthetic(60).samples,
    };
    let mut reader = CommandReader::default();
    wire.write("# myointent 0.1.0 0123456789ab, image test, started by power or reset\r\n");
    wire.write(&pipeline.state_report().without_strength().to_string());
    let (pairs, _) = samples.as_chunks::<2>();
    let (mut pairing, mut pairings) = (0, 0);
    let mut streamed = pairs.iter().cycle().enumerate();
    loop {
        if stop.load(Ordering::Relaxed) {
            return;
        }
        let mut buffer = [0; 256];
        let began = Instant::now();
        let length = wire.read(&mut buffer);
        std::thread::sleep(PACE.saturating_sub(began.elapsed()));
        for &byte in &buffer[..length] {
            let Some(command) = reader.push(byte) else {
                continue;
            };
            if let Ok(Command::Raw(on)) = command {
                raw.store(on, Ordering::Relaxed);
            }
            match command {
                Ok(Command::Align(AlignCommand::Begin(arm))) => pipeline.begin_alignment(arm),
                Ok(Command::Align(AlignCommand::Cancel)) => pipeline.cancel_alignment(),
                Ok(Command::Align(AlignCommand::Set(known))) => pipeline.set_alignment(known),
                _ => {}
            }
            let may_bind = following.address().is_none();
            if may_bind && command == Ok(Command::Bind(BindCommand::Begin)) {
                following = Following::Pairing;
                pairing = PAIRING;
                pairings += 1;
            }
            wire.write(&answer(command, following).to_string());
        }
        if following == Following::Pairing {
            pairing -= 1;
            if pairing == 0 {
                following = match pairings {
                    1 => Following::Nobody,
                    _ => Following::Bound(armband()),
                };
            }
        }
        let Some(_) = following.address() else {
            continue;
        };
        let Some((place, pair)) = streamed.next() else {
            return;
        };
        let first = SampleIndex(2 * place as u32);
        let now = Millis(10 * place as u32);
        for &sample in pair {
            for report in pipeline.sample(now, sample) {
                wire.write(&report.without_strength().to_string());
            }
            if let Some(report) = pipeline.take_alignment_report() {
                wire.write(&report.to_string());
            }
        }
        if raw.load(Ordering::Relaxed) {
            let samples: [Sample; 2] = *pair;
            wire.write(&EmgReport { first, samples }.to_string());
        }
    }
}

fn answer(command: Result<Command, Refusal>, following: Following) -> Answer<'static> {
    match command {
        Ok(Command::Identify) => Answer::Identity(Identity {
            version: "0.1.0",
            revision: "0123456789ab",
            image: "test",
            model: Some(7),
            armband: following.address(),
            firmware: None,
            battery: Some(80),
        }),
        Ok(Command::Counters) => Answer::Counts(Counts {
            session: Counters {
                connections: 1,
                notifications: 1000,
                ..Counters::default()
            },
            ..Counts::default()
        }),
        Ok(Command::Align(command)) => {
            Accepted::of(command).map_or(Answer::Refused(Refusal::Busy), Answer::Align)
        }
        Ok(Command::Raw(on)) => Answer::Raw(on),
        Ok(Command::Bind(command))
            if matches!(following, Following::Pinned(_)) && command != BindCommand::State =>
        {
            Answer::Refused(Refusal::BuiltIn)
        }
        Ok(Command::Bind(_)) => Answer::Binding(Binding {
            following,
            is_kept: true,
        }),
        Ok(Command::Gate(GateCommand::State)) => Answer::Gate(Gate::default()),
        Ok(Command::Calibrate(_)) => Answer::Calibration(CalibrationReport::default(), false),
        Ok(_) => Answer::Refused(Refusal::Unknown),
        Err(refusal) => Answer::Refused(refusal),
    }
}

/// Connection of the board to a PC.
struct Wire {
    terminal: Terminal,
    link: PathBuf,
    dialogues: std::vec::IntoIter<usize>,
    /// Bytes until the line is pulled; `None` before a dialogue, and once all dialogues are over.
    left: Option<usize>,
    cuts: Arc<AtomicUsize>,
}

impl Wire {
    fn read(&mut self, buffer: &mut [u8]) -> usize {
        let length = self.terminal.master.read(buffer).unwrap_or(0);
        if length > 0 && self.left.is_none() {
            self.left = self.dialogues.next();
        }
        self.carried(length)
    }

    fn write(&mut self, text: &str) {
        let bytes = text.as_bytes();
        let length = self.left.map_or(bytes.len(), |left| left.min(bytes.len()));
        // If nobody reads, or reads slowly, bytes are lost, as on a real line.
        let _ = self.terminal.master.write_all(&bytes[..length]);
        self.carried(bytes.len());
    }

    /// Counts bytes, and pulls the line once its limit has passed. Returns the number of these bytes that passed
    /// before.
    fn carried(&mut self, bytes: usize) -> usize {
        let Some(left) = self.left else {
            return bytes;
        };
        if bytes < left {
            self.left = Some(left - bytes);
            return bytes;
        }
        // The old terminal is closed last: its reader learns of the cut only then, and a name that is free again at
        // once could be opened by a program that meant the old one.
        self.terminal = Terminal::new(&self.link);
        self.left = None;
        self.cuts.fetch_add(1, Ordering::Relaxed);
        left
    }
}
