//! `myointent live`: muscles, scores and labels as they come, on a page in a browser.
//!
//! ```text
//! source (a thread)            hub                  server (a thread)
//! board, recording   events -> newest of each  -->  a page, a websocket for each viewer
//!                    <- requests -----------------  align, cancel
//! ```
//!
//! Whatever a viewer does, the source never waits for it. The page brings everything with it and asks for nothing from
//! elsewhere.

mod event;
mod hub;
mod scores;
mod server;
mod source;

use std::net::{IpAddr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc;
use std::thread::JoinHandle;

use anyhow::Context as _;
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;

use self::event::Event;
use self::hub::Hub;
use self::server::Server;
use self::server::access::Access;
use self::source::board::Board;
use self::source::{Context, Recorded, Stop};
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

/// The page while it is served.
#[derive(Debug)]
pub struct Live {
    hub: Arc<Hub>,
    stop: Stop,
    server: Server,
    source: JoinHandle<anyhow::Result<()>>,
    url: String,
}

/// Serves a page until it is stopped.
///
/// # Errors
/// When the model is refused, the recording is empty or the address cannot be listened on.
pub fn start(options: Options) -> anyhow::Result<Live> {
    if let Some(bytes) = &options.model {
        let model = Model::parse(bytes).context("the model is refused")?;
        HostEncoder::new(&model).context("the model is refused")?;
    }
    let listener = TcpListener::bind(options.listen)
        .with_context(|| format!("{}: cannot be listened on", options.listen))?;
    let address = listener.local_addr()?;
    let access = Access::new(address);
    let url = access.url();

    let hub = Arc::new(Hub::new());
    let stop = Stop::default();
    let (sender, requests) = mpsc::sync_channel(16);
    let context = Context {
        hub: hub.clone(),
        requests,
        stop: stop.clone(),
    };
    let server = Server::start(listener, access, hub.clone(), sender)?;
    let source = std::thread::Builder::new()
        .name("source".to_owned())
        .stack_size(STACK)
        .spawn(move || run(options.source, options.model, &context))?;
    Ok(Live {
        hub,
        stop,
        server,
        source,
        url,
    })
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
        self.source.is_finished()
    }

    /// Ends source and server; viewers are told.
    ///
    /// # Errors
    /// What ended the source before.
    pub fn stop(self) -> anyhow::Result<()> {
        self.stop.request();
        let result = self.source.join();
        self.hub.publish(&Event::End);
        self.server.stop();
        match result {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        }
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
