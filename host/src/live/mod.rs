//! `myointent live`: muscles, scores and labels as they come, on a page in a browser.
//!
//! ```text
//! source (a thread)            hub                  server (a thread)
//! board, recording   events -> newest of each  -->  a page, a websocket for each viewer
//!                    <- requests -----------------  align, cancel
//!                                                   or: a terminal
//! ```
//!
//! Whatever a viewer does, the source never waits for it. The page brings everything with it and asks for nothing from
//! elsewhere.

mod event;
mod hub;
mod scores;
mod server;
mod source;
mod tui;

use std::net::{IpAddr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{self, SyncSender};
use std::thread::JoinHandle;

use anyhow::Context as _;
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;

use self::event::Event;
use self::hub::Hub;
use self::server::Server;
use self::server::access::Access;
use self::source::board::Board;
use self::source::{Context, Recorded, Request, Stop};
use crate::dataset::Recording;
use crate::dataset::synthetic::{self, SynthOptions};

/// The shipped model.
const SHIPPED: &[u8] = include_bytes!("../../../models/three-class.intent");

/// Of the source's thread: a state of the largest model that is accepted, and what is called with it.
const STACK: usize = 16 << 20;

/// Where the stream comes from.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Source {
    /// A synthetic recording, in real time and again and again.
    Demo,
    /// A recording, likewise.
    Replay(Box<Recording>),
    /// A board on this serial port or pseudo-terminal.
    Port(PathBuf),
}

/// What to show, and to whom.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Options {
    /// Where the stream comes from.
    pub source: Source,
    /// A model file's bytes. Without one, recordings run through the shipped model, and a board has no scores.
    pub model: Option<Vec<u8>>,
    /// Where the page is served; port 0 takes any free one. Not on this machine alone: with a token.
    pub listen: SocketAddr,
}

/// A source that runs, and what it is told and asked through.
#[derive(Debug)]
struct Stream {
    hub: Arc<Hub>,
    stop: Stop,
    requests: SyncSender<Request>,
    source: JoinHandle<anyhow::Result<()>>,
}

impl Stream {
    fn start(source: Source, model: Option<Vec<u8>>) -> anyhow::Result<Self> {
        if let Some(bytes) = &model {
            let model = Model::parse(bytes).context("the model is refused")?;
            HostEncoder::new(&model).context("the model is refused")?;
        }
        let hub = Arc::new(Hub::new());
        let stop = Stop::default();
        let (requests, received) = mpsc::sync_channel(16);
        let context = Context {
            hub: hub.clone(),
            requests: received,
            stop: stop.clone(),
        };
        let source = std::thread::Builder::new()
            .name("source".to_owned())
            .stack_size(STACK)
            .spawn(move || run(source, model, &context))?;
        Ok(Self {
            hub,
            stop,
            requests,
            source,
        })
    }

    /// Ends the source; gives what ended it before.
    fn stop(self) -> anyhow::Result<()> {
        self.stop.request();
        match self.source.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

/// The page while it is served.
#[derive(Debug)]
pub struct Live {
    stream: Stream,
    server: Server,
    url: String,
}

/// Serves a page until it is stopped.
///
/// # Errors
/// When the model is refused or the address cannot be listened on.
pub fn start(options: Options) -> anyhow::Result<Live> {
    let listener = TcpListener::bind(options.listen)
        .with_context(|| format!("{}: cannot be listened on", options.listen))?;
    let access = Access::new(listener.local_addr()?);
    let url = access.url();
    let stream = Stream::start(options.source, options.model)?;
    let (hub, requests) = (stream.hub.clone(), stream.requests.clone());
    let server = Server::start(listener, access, hub, requests)?;
    Ok(Live {
        stream,
        server,
        url,
    })
}

/// Shows a stream in the terminal until the user leaves or `over`.
///
/// # Errors
/// When the model is refused, or standard output is no terminal.
pub fn show(source: Source, model: Option<Vec<u8>>, over: impl Fn() -> bool) -> anyhow::Result<()> {
    let stream = Stream::start(source, model)?;
    let ended = || over() || stream.source.is_finished();
    let shown = tui::show(&stream.hub, &stream.requests, ended);
    stream.stop()?;
    shown.context("the terminal cannot be drawn on")
}

impl Live {
    /// The address of the page, with its token if there is one.
    #[must_use]
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Whether the source has ended by itself, which only an error makes it do.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.stream.source.is_finished()
    }

    /// Ends source and server; viewers are told.
    ///
    /// # Errors
    /// What ended the source before.
    pub fn stop(self) -> anyhow::Result<()> {
        let hub = self.stream.hub.clone();
        let result = self.stream.stop();
        hub.publish(&Event::End);
        self.server.stop();
        result
    }
}

/// Whether an address is of this machine alone.
#[must_use]
pub const fn is_local(address: IpAddr) -> bool {
    address.is_loopback()
}

fn run(source: Source, model: Option<Vec<u8>>, context: &Context) -> anyhow::Result<()> {
    let recorded = |kind, name, recording: Recording, model: Option<Vec<u8>>| Recorded {
        kind,
        name,
        model: model.unwrap_or_else(|| SHIPPED.to_vec()),
        samples: recording.samples,
        labels: recording.labels,
    };
    match source {
        Source::Port(path) => Board { path, model }.run(context),
        Source::Replay(recording) => {
            let name = recording.full_name();
            recorded("replay", name, *recording, model).run(context)
        }
        Source::Demo => {
            let name = "synthetic, of nobody".to_owned();
            recorded("demo", name, demo(), model).run(context)
        }
    }
}

/// A minute of a simulated forearm.
fn demo() -> Recording {
    let options = SynthOptions {
        subjects: 1,
        recordings: 1,
        ..SynthOptions::default()
    };
    synthetic::generate(&options).remove(0)
}
