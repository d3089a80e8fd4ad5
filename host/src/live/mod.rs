//! `myointent live`: EMG, scores and labels in real time, on a page in a browser.
//!
//! ```text
//! source (a thread)            hub                  server (a thread)
//! board, recording   events -> newest of each  -->  a page, a websocket for each viewer
//!                    <- requests -----------------  align, cancel
//!                                              -->  or lines of JSON (a thread)
//! ```
//!
//! `myointent record` adds a recorder, which hears all samples and leads through a session. A simulated person follows its
//! cues.
//!
//! The source never waits for a viewer. The page needs nothing from other servers.

mod hub;
mod json_lines;
pub(crate) mod osc;
mod recorder;
mod server;
mod source;

use std::io::Write;
use std::net::{IpAddr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread::JoinHandle;
use std::time::Duration;

use anyhow::Context as _;
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;
use web::event::Event;
use web::request::SourceRequest;
use web::{SHIPPED, SharedCue};

use self::hub::Hub;
use self::json_lines::JsonLines;
pub use self::recorder::RecordOptions;
use self::recorder::{Recorder, RecorderRequest};
use self::server::access::Access;
use self::server::{Requests, Server};
pub use self::source::Source;
pub(crate) use self::source::no_port;
use self::source::{Context, Guide, Stop};
use crate::record::HistoryOf;

/// Number of requests that may wait for the source, and for the recorder.
const REQUESTS: usize = 16;
/// Stack size of the source's thread in bytes: room for the state of the largest accepted model.
const STACK: usize = 16 << 20;

/// Settings of the page.
#[derive(Clone, Debug)]
pub struct Options {
    /// Source of the stream.
    pub source: Source,
    /// Bytes of a model file. Without one, recordings run through the shipped model, and a board has no scores.
    pub model: Option<Vec<u8>>,
    /// Address of the page; port 0 takes any free one. An address beyond this machine needs a token.
    pub listen: SocketAddr,
    /// Whether the armband's movement is asked for too.
    pub imu: bool,
    /// Settings of a recording session; none for `live`.
    pub record: Option<RecordOptions>,
}

/// Running source, and the handles to control it.
#[derive(Debug)]
struct Stream {
    hub: Arc<Hub>,
    stop: Stop,
    requests: SyncSender<SourceRequest>,
    source: JoinHandle<anyhow::Result<()>>,
}

impl Stream {
    fn start(
        hub: Arc<Hub>,
        source: Source,
        model: Option<Vec<u8>>,
        guide: Option<Guide>,
        imu: bool,
        (requests, received): (SyncSender<SourceRequest>, Receiver<SourceRequest>),
    ) -> anyhow::Result<Self> {
        if let Some(bytes) = &model {
            let model = Model::parse(bytes).context("the model is refused")?;
            HostEncoder::new(&model).context("the model is refused")?;
        }
        let stop = Stop::default();
        let context = Context {
            hub: hub.clone(),
            requests: received,
            stop: stop.clone(),
            imu,
        };
        let source = std::thread::Builder::new()
            .name("source".to_owned())
            .stack_size(STACK)
            .spawn(move || source.run(model, guide, &context))?;
        Ok(Self {
            hub,
            stop,
            requests,
            source,
        })
    }

    /// Ends the source and returns the error that ended it before.
    fn stop(self) -> anyhow::Result<()> {
        self.stop.request();
        match self.source.join() {
            Ok(result) => result,
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }
}

/// Running recorder, and its stop handle.
type RecorderThread = (Stop, JoinHandle<anyhow::Result<()>>);

/// Page that is being served.
#[derive(Debug)]
pub struct Live {
    stream: Stream,
    server: Server,
    recorder: Option<RecorderThread>,
    url: String,
}

/// Serves a page until it is stopped.
///
/// # Errors
/// When the model is refused or the address cannot be listened on.
pub fn start(options: Options) -> anyhow::Result<Live> {
    let (listener, access) = bind(options.listen)?;
    let url = access.url();
    let hub = Arc::new(Hub::new());
    let requests = mpsc::sync_channel(REQUESTS);
    let has_board = matches!(options.source, Source::Port(_));
    let (mut recorder_thread, mut recorder_requests, mut guide) = (None, None, None);
    let mut history = None;
    if let Some(record) = options.record {
        let model = options.model.clone().unwrap_or_else(|| SHIPPED.to_vec());
        history = Some(HistoryOf {
            folder: record.folder.clone(),
            person: record.person.clone(),
            model: model.clone(),
        });
        let cue = SharedCue::default();
        let earlier = std::fs::read_dir(record.folder.join(&record.person));
        guide = Some(Guide {
            cue: cue.clone(),
            speed: record.speed,
            earlier: earlier.map_or(0, |entries| entries.count() as u64),
        });
        let recorder = Recorder {
            source: options.source.described(),
            port: match &options.source {
                Source::Port(path) => Some(path.clone()),
                _ => None,
            },
            source_requests: requests.0.clone(),
            option: options.source.option(),
            model,
            options: record,
            hub: hub.clone(),
            cue,
        };
        let (thread, sender) = start_recorder(&hub, recorder)?;
        recorder_thread = Some(thread);
        recorder_requests = Some(sender);
    }
    let Options {
        source, model, imu, ..
    } = options;
    let stream = Stream::start(hub.clone(), source, model, guide, imu, requests)?;
    let requests = Requests {
        source: stream.requests.clone(),
        recorder: recorder_requests,
    };
    let server = Server::start(listener, access, has_board, hub, requests, history)?;
    Ok(Live {
        stream,
        server,
        recorder: recorder_thread,
        url,
    })
}

/// Starts a recorder; the returned sender takes requests to it.
fn start_recorder(
    hub: &Hub,
    recorder: Recorder,
) -> anyhow::Result<(RecorderThread, SyncSender<RecorderRequest>)> {
    let stop = Stop::default();
    let stopped = stop.clone();
    let (events, received) = mpsc::channel();
    let (sender, requests) = mpsc::sync_channel(REQUESTS);
    hub.attach_recorder(events);
    let thread = std::thread::Builder::new()
        .name("recorder".to_owned())
        .spawn(move || recorder.run(&received, &requests, &stopped))?;
    Ok(((stop, thread), sender))
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
/// With an address in `listen`, also serves a page, whose URL is passed to `opened`.
///
/// # Errors
/// When the model is refused, the address cannot be listened on, the source ends by an error or the output cannot be
/// written. An output that its reader has closed is a [`std::io::ErrorKind::BrokenPipe`].
pub(crate) fn print(
    source: Source,
    model: Option<Vec<u8>>,
    imu: bool,
    listen: Option<SocketAddr>,
    output: impl Write + Send + 'static,
    opened: impl FnOnce(&str),
    over: impl Fn() -> bool,
) -> anyhow::Result<()> {
    let page = listen.map(bind).transpose()?;
    let hub = Arc::new(Hub::new());
    // Started before the source, so that no event is missed.
    let lines = JsonLines::start(hub.clone(), output)?;
    let has_board = matches!(source, Source::Port(_));
    let requests = mpsc::sync_channel(REQUESTS);
    let stream = Stream::start(hub.clone(), source, model, None, imu, requests)?;
    let server = page.map(|(listener, access)| {
        opened(&access.url());
        let requests = Requests {
            source: stream.requests.clone(),
            recorder: None,
        };
        Server::start(listener, access, has_board, hub.clone(), requests, None)
    });
    let server = server.transpose()?;
    while !(over() || stream.source.is_finished() || lines.is_finished()) {
        std::thread::sleep(Duration::from_millis(50));
    }
    let result = stream.stop();
    hub.publish(&Event::End);
    if let Some(server) = server {
        server.stop();
    }
    result.and(lines.stop().context("standard output"))
}

impl Live {
    /// URL of the page, with its token if there is one.
    #[must_use]
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Whether the source has ended by an error, or an unattended session is over.
    pub(crate) fn is_over(&self) -> bool {
        let recorder = self.recorder.as_ref();
        self.stream.source.is_finished() || recorder.is_some_and(|(_, thread)| thread.is_finished())
    }

    /// Ends source and server; viewers are told.
    ///
    /// # Errors
    /// The error that ended the source before, or that kept an unattended session from being written.
    pub fn stop(self) -> anyhow::Result<()> {
        let hub = self.stream.hub.clone();
        let mut result = self.stream.stop();
        // The source has stopped: the recorder gets its last sample.
        if let Some((stop, thread)) = self.recorder {
            stop.request();
            // The panic was printed already.
            let recorded = thread.join().unwrap_or_else(|_| {
                Err(anyhow::anyhow!(
                    "the recorder ended; what was recorded is in the journal"
                ))
            });
            result = result.and(recorded);
        }
        hub.publish(&Event::End);
        self.server.stop();
        result
    }
}

/// Whether an address is reachable from this machine alone.
pub(crate) const fn is_local(address: IpAddr) -> bool {
    address.to_canonical().is_loopback()
}
