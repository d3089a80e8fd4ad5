//! `myointent live`: EMG, scores and labels in real time, on a page in a browser.
//!
//! ```text
//! device (a thread)      stream (a thread)      hub                server (a thread)
//! board, armband  bytes  web::engine  events -> newest of each --> a page, a websocket for each viewer
//!                 <----               <- requests ---------------
//!                          | journal                           --> or lines of JSON (a thread)
//!                        storage (a thread)
//! ```
//!
//! `myointent record` adds a session to the engine, and the storage of what is recorded.
//!
//! The engine never waits for a viewer or a disk. The page needs nothing from other servers.

#[cfg(feature = "bluetooth")]
mod bluetooth;
mod hub;
mod json_lines;
mod line;
pub(crate) mod osc;
mod server;
mod storage;
mod stream;

use std::io::Write;
use std::net::{IpAddr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use anyhow::Context as _;
use recordings::Recording;
use shared::myo::Address;
#[cfg(feature = "train")]
use training::backend::Device;
use web::SHIPPED;
use web::event::Event;
use web::record::protocol::Protocol;

use self::hub::Hub;
use self::json_lines::JsonLines;
pub(crate) use self::line::no_port;
use self::server::Server;
use self::server::access::Access;
use self::stream::Stream;
use crate::record::HistoryOf;

/// Source of a stream.
#[derive(Clone, PartialEq, Debug)]
pub enum Source {
    /// Simulated person, in real time.
    Demo,
    /// Recording, repeated in real time.
    Replay(Box<Recording>),
    /// Board on this serial port or pseudo-terminal.
    Port(PathBuf),
    /// Armband over this computer's own Bluetooth: the one of the address, or the one with the strongest signal.
    Bluetooth(Option<Address>),
}

impl Source {
    /// Command-line option that selects this kind of source again.
    fn option(&self) -> String {
        match self {
            Self::Port(path) => format!("--port {}", path.display()),
            Self::Bluetooth(None) => "--bluetooth any".to_owned(),
            Self::Bluetooth(Some(address)) => format!("--bluetooth {address}"),
            Self::Demo | Self::Replay(_) => "--demo".to_owned(),
        }
    }
}

/// Source, and the page that is served of it.
#[derive(Clone, Debug)]
pub struct Options {
    /// Source of the stream.
    pub source: Source,
    /// Bytes of a model file. Without one, recordings run through the shipped model, and a board has no scores.
    pub model: Option<Vec<u8>>,
    /// Address of the page, none for no page; port 0 takes any free one. An address beyond this machine needs a token.
    pub listen: Option<SocketAddr>,
    /// Whether the armband's movement is asked for too.
    pub imu: bool,
    /// Settings of a recording session; none for `live`.
    pub record: Option<RecordOptions>,
}

impl Options {
    /// A source alone: with the shipped model, and without a page.
    pub const fn of(source: Source) -> Self {
        Self {
            source,
            model: None,
            listen: None,
            imu: false,
            record: None,
        }
    }
}

/// Settings of a recording session.
#[derive(Clone, Debug)]
pub struct RecordOptions {
    /// Folder with a folder for each person.
    pub folder: PathBuf,
    /// Name of the person.
    pub person: String,
    /// Protocol of the session.
    pub protocol: Protocol,
    /// Path of the model file to tune afterwards, for the commands that are shown.
    pub model: PathBuf,
    /// Device for tuning.
    #[cfg(feature = "train")]
    pub device: Device,
    /// Speed-up of a demo or a replay, to try a protocol out.
    pub speed: u32,
    /// Whether the session begins by itself and its end ends the program; nobody looks at the cues.
    pub unattended: bool,
}

/// Source that runs, and the page that is served of it.
#[derive(Debug)]
pub struct Live {
    stream: Stream,
    /// Server of the page, and its URL.
    server: Option<(Server, String)>,
}

/// Runs a source, and serves its page, until it is stopped.
///
/// # Errors
/// When the model is refused or the address cannot be listened on.
pub fn start(options: Options) -> anyhow::Result<Live> {
    run(Arc::new(Hub::new()), options)
}

fn run(hub: Arc<Hub>, options: Options) -> anyhow::Result<Live> {
    let page = options.listen.map(bind).transpose()?;
    let model = options.model.as_deref().unwrap_or(SHIPPED);
    let history = options.record.as_ref().map(|record| HistoryOf {
        folder: record.folder.clone(),
        person: record.person.clone(),
        model: model.to_vec(),
    });
    let stream = Stream::start(hub.clone(), options)?;
    let inputs = stream.inputs.clone();
    let server = page.map(|(listener, access)| {
        let url = access.url();
        let server = Server::start(listener, access, hub, inputs, history)?;
        anyhow::Ok((server, url))
    });
    Ok(Live {
        stream,
        server: server.transpose()?,
    })
}

/// Opens the listening socket of a page.
fn bind(address: SocketAddr) -> anyhow::Result<(TcpListener, Access)> {
    let listener =
        TcpListener::bind(address).with_context(|| format!("{address}: cannot be listened on"))?;
    let access = Access::new(listener.local_addr()?);
    Ok((listener, access))
}

/// Writes every event of a source as a line of JSON, until `over` returns true or the reader closes `output`.
///
/// With an address, also serves a page, whose URL is passed to `opened`.
///
/// # Errors
/// When the model is refused, the address cannot be listened on, the source ends by an error or the output cannot be
/// written. An output that its reader has closed is a [`std::io::ErrorKind::BrokenPipe`].
pub(crate) fn print(
    options: Options,
    output: impl Write + Send + 'static,
    opened: impl FnOnce(&str),
    over: impl Fn() -> bool,
) -> anyhow::Result<()> {
    let hub = Arc::new(Hub::new());
    // Started before the source, so that no event is missed.
    let lines = JsonLines::start(hub.clone(), output)?;
    let live = run(hub, options)?;
    if let Some((_, url)) = &live.server {
        opened(url);
    }
    while !(over() || live.is_over() || lines.is_finished()) {
        std::thread::sleep(Duration::from_millis(50));
    }
    let result = live.stop();
    result.and(lines.stop().context("standard output"))
}

impl Live {
    /// URL of the page, with its token if there is one; empty without a page.
    #[must_use]
    pub fn url(&self) -> &str {
        self.server.as_ref().map_or("", |(_, url)| url)
    }

    /// Whether the source has ended by an error, or an unattended session is over.
    pub(crate) fn is_over(&self) -> bool {
        self.stream.is_finished()
    }

    /// Ends source and server; viewers are told.
    ///
    /// # Errors
    /// The error that ended the source before, or that kept an unattended session from being written.
    pub fn stop(self) -> anyhow::Result<()> {
        let hub = self.stream.hub.clone();
        let result = self.stream.stop();
        hub.send(None, &Event::End);
        if let Some((server, _)) = self.server {
            server.stop();
        }
        result
    }
}

/// Whether an address is reachable from this machine alone.
pub(crate) const fn is_local(address: IpAddr) -> bool {
    address.to_canonical().is_loopback()
}
