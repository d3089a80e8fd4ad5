//! `myointent live`: the stream of a board or a recording, on a page or as lines of JSON.

use std::io::{IsTerminal as _, Write};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, TcpListener};
use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context as _, bail};
use clap::Args;
use qrcode::QrCode;
use qrcode::render::unicode;
use shared::myo::Address;

use super::arguments::AS_RECORDED;
use super::read_model;
use super::replay::recording_of;
use crate::live::osc::Osc;
use crate::live::{self, Options, Source, is_local};
use execution::interrupt::Interrupt;
use execution::progress;

const PORT: u16 = 8377;

#[derive(Debug, Args)]
#[command(
    after_help = "Give one source: --demo, --replay, --port or --bluetooth. The address of the page is printed on standard output; Ctrl-C ends it.\n\
    A recording plays in real time and begins again at its end; its labels are shown beside the emitted ones. A board on\n\
    --port is asked for its raw stream, and looked for again when it is lost. The page has pause, marks and a csv of what was\n\
    seen, which `myointent data inspect` reads. docs/live.md explains it.\n\n\
    Examples:\n  myointent live --demo                                              no hardware, no recording\n  \
    myointent live --demo --json                                       a line of JSON for each event, no page\n  \
    myointent live --replay recordings/s1/s1_grasp.csv\n  \
    myointent live --port /dev/ttyACM0 --model models/three-class.intent"
)]
pub struct Arguments {
    #[command(flatten)]
    stream: StreamArguments,
    /// Model file.
    ///
    /// Without it, recordings run through the shipped three-class model, and a board shows no scores.
    #[arg(long, value_name = "FILE.intent")]
    model: Option<PathBuf>,
    /// Write every event as a line of JSON on standard output, for other programs; serve a page only with --listen.
    ///
    /// Exit code 0 when the reader closes the pipe.
    #[arg(long)]
    json: bool,
    /// Send labels, scores and samples as packets of Open Sound Control to an address or a name, such as localhost:9000; serve a
    /// page only with --listen.
    #[arg(long, value_name = "HOST:PORT", conflicts_with = "json", value_parser = receiver)]
    osc: Option<String>,
    /// Where the page is served: an address, or address:port.
    ///
    /// Beyond this machine the address that is printed has a token; the connection is not encrypted.
    #[arg(long, value_name = "ADDR", value_parser = listen)]
    listen: Option<(IpAddr, Option<u16>)>,
}

/// Help of `--imu`.
const IMU: &str = "Ask for the armband's movement too: orientation, acceleration and turn rate, 50 times a second. A board sends it over \
    its own USB alone: a UART has no room for it.";

/// Stream to show or to record.
#[derive(Debug, Args)]
pub(super) struct StreamArguments {
    #[command(flatten)]
    source: SourceArguments,
    /// Recording to play, if the path of --replay holds several, as `data inspect` prints it: data-set/person/name.
    #[arg(long, requires = "replay")]
    name: Option<String>,
    #[arg(hide_short_help = true, long, help = AS_RECORDED, requires = "replay")]
    as_recorded: bool,
    #[arg(long, help = IMU, conflicts_with_all = ["demo", "replay"])]
    pub(super) imu: bool,
}

#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct SourceArguments {
    /// A simulated forearm and the shipped model: needs nothing else.
    #[arg(long)]
    demo: bool,
    /// A recording: any format that `data inspect` reads.
    #[arg(long, value_name = "RECORDING")]
    replay: Option<PathBuf>,
    /// A board's serial port, such as /dev/ttyACM0 or COM3, or a pseudo-terminal.
    #[arg(long, value_name = "PATH")]
    port: Option<PathBuf>,
    /// An armband over this computer's own Bluetooth, without a board: its address, or `any` for the strongest signal.
    ///
    /// Needs a program that was built with `--features bluetooth`.
    #[arg(long, value_name = "ADDRESS|any", value_parser = armband)]
    bluetooth: Option<Followed>,
}

/// Address of the armband to follow; none for any.
#[derive(Clone, Copy, Debug)]
pub struct Followed(Option<Address>);

fn armband(text: &str) -> Result<Followed, String> {
    if text == "any" {
        return Ok(Followed(None));
    }
    let address = Address::parse(text).map_err(|error| format!("{error}; or `any`"))?;
    Ok(Followed(Some(address)))
}

pub(super) fn listen(text: &str) -> Result<(IpAddr, Option<u16>), String> {
    let address = text.parse().map(|address: IpAddr| (address, None));
    let socket = |_| {
        text.parse()
            .map(|at: SocketAddr| (at.ip(), Some(at.port())))
    };
    address.or_else(socket).map_err(|_| {
        "expected an address such as 0.0.0.0 or 192.168.0.2:8377; names are not looked up"
            .to_owned()
    })
}

/// Checks the form of a host and its port; the name is looked up once the command runs.
fn receiver(text: &str) -> Result<String, String> {
    let is_host = |host: &str| match host.strip_prefix('[') {
        Some(rest) => rest
            .strip_suffix(']')
            .is_some_and(|address| address.parse::<Ipv6Addr>().is_ok()),
        None => !host.is_empty() && !host.contains([':', '/']),
    };
    let is_port = |port: &str| port.parse().is_ok_and(|port: u16| port != 0);
    match text.rsplit_once(':') {
        Some((host, port)) if is_host(host) && is_port(port) => Ok(text.to_owned()),
        _ => Err(
            "expected an address or a name, and a port, such as 192.168.0.2:9000, [::1]:9000 or localhost:9000"
                .to_owned(),
        ),
    }
}

/// Serves the page, or writes lines of JSON, until Ctrl-C.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let model = arguments.model.as_deref().map(read_model).transpose()?;
    let mut options = Options {
        model,
        imu: arguments.stream.imu,
        ..Options::of(arguments.stream.source()?)
    };
    if arguments.json || arguments.osc.is_some() {
        options.listen = arguments
            .listen
            .map(|(address, port)| SocketAddr::new(address, port.unwrap_or_else(|| free(address))));
        let listen = options.listen;
        let interrupt = Interrupt::listen();
        let opened = |url: &str| {
            if let Some(listen) = listen {
                progress::log(&format!("page: {}", urls(url, listen.ip()).join(" ")));
                warn(listen.ip());
            }
        };
        let output: Box<dyn Write + Send> = match &arguments.osc {
            Some(target) => Box::new(Osc::to(target).with_context(|| {
                format!("--osc {target}: expected an address, or a name that this computer knows")
            })?),
            None => Box::new(std::io::stdout()),
        };
        return live::print(options, output, opened, || interrupt.requested());
    }
    serve(arguments.listen, options)
}

impl StreamArguments {
    pub(super) fn source(&self) -> anyhow::Result<Source> {
        if let Some(path) = &self.source.replay {
            let recording = recording_of(path, self.name.as_deref(), self.as_recorded)?;
            return Ok(Source::Replay(Box::new(recording)));
        }
        if let Some(path) = &self.source.port {
            return Ok(Source::Port(path.clone()));
        }
        match self.source.bluetooth {
            Some(_) if cfg!(not(feature = "bluetooth")) => bail!(
                "this program was built without Bluetooth: build it with  cargo build --release --features bluetooth"
            ),
            Some(Followed(address)) => Ok(Source::Bluetooth(address)),
            None => Ok(Source::Demo),
        }
    }
}

/// Serves a page until Ctrl-C, by default on this machine alone.
pub(super) fn serve(
    listen: Option<(IpAddr, Option<u16>)>,
    mut options: Options,
) -> anyhow::Result<()> {
    let (address, port) = listen.unwrap_or((Ipv4Addr::LOCALHOST.into(), None));
    let port = port.unwrap_or_else(|| free(address));
    options.listen = Some(SocketAddr::new(address, port));
    let interrupt = Interrupt::listen();
    let live = live::start(options)?;
    for url in urls(live.url(), address) {
        writeln!(std::io::stdout(), "{url}")?;
        if !is_local(address) && std::io::stdout().is_terminal() {
            let code = QrCode::new(&url)?.render::<unicode::Dense1x2>().build();
            writeln!(std::io::stdout(), "{code}")?;
        }
    }
    progress::log("open this address in a browser; Ctrl-C ends it");
    warn(address);
    while !interrupt.requested() && !live.is_over() {
        std::thread::sleep(Duration::from_millis(50));
    }
    live.stop()
}

/// Warns who can open the page, beyond this machine.
fn warn(address: IpAddr) {
    if is_local(address) {
        return;
    }
    progress::log(
        "whoever knows the whole address can look; it is not encrypted: use it on a network that you trust",
    );
}

/// URLs under which a page can be opened: of a page for all addresses one for each address of this machine that others reach.
fn urls(url: &str, address: IpAddr) -> Vec<String> {
    if !address.is_unspecified() {
        return vec![url.to_owned()];
    }
    let own = if_addrs::get_if_addrs().unwrap_or_default();
    let own = own.iter().filter(|own| !own.is_loopback());
    let mut hosts: Vec<_> = own.map(|own| own.ip()).filter(IpAddr::is_ipv4).collect();
    if hosts.is_empty() {
        hosts.push(Ipv4Addr::LOCALHOST.into());
    }
    let any = if address.is_ipv4() { "0.0.0.0" } else { "[::]" };
    let named = hosts
        .iter()
        .map(|host| url.replacen(any, &host.to_string(), 1));
    named.collect()
}

/// Default port, or 0 (any) if another program uses it.
fn free(address: IpAddr) -> u16 {
    TcpListener::bind((address, PORT)).map_or(0, |_| PORT)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Cli, Command};
    use clap::Parser as _;

    #[test]
    fn a_page_for_all_addresses_names_those_of_this_machine() {
        let url = "http://192.168.0.2:8377/token/";
        assert_eq!(urls(url, "192.168.0.2".parse().unwrap()), [url]);
        for (any, url) in [
            ("0.0.0.0", "http://0.0.0.0:80/t/"),
            ("::", "http://[::]:80/t/"),
        ] {
            for found in urls(url, any.parse().unwrap()) {
                let host = found.strip_prefix("http://").unwrap();
                let host: SocketAddr = host.strip_suffix("/t/").unwrap().parse().unwrap();
                assert!(!host.ip().is_unspecified(), "{found}");
            }
        }
    }

    /// Arguments of a line.
    fn live(line: &[&str]) -> Arguments {
        let line = ["myointent", "live"].iter().chain(line);
        let Command::Live(arguments) = Cli::parse_from(line).command else {
            panic!("the command is live");
        };
        arguments
    }

    fn refusal(line: &[&str]) -> String {
        let line = ["myointent", "live"].iter().chain(line);
        Cli::try_parse_from(line).unwrap_err().to_string()
    }

    #[test]
    fn without_a_source_all_of_them_are_listed() {
        let error = refusal(&[]);
        assert!(
            error.contains("<--demo|--replay <RECORDING>|--port <PATH>|--bluetooth <ADDRESS|any>>"),
            "{error}"
        );
        assert!(refusal(&["--demo", "--port", "x"]).contains("cannot be used with"));
    }

    #[cfg(not(feature = "bluetooth"))]
    #[test]
    fn without_bluetooth_in_the_program_no_page_is_opened() {
        let error = run(&live(&["--bluetooth", "any"])).unwrap_err().to_string();
        assert!(error.contains("--features bluetooth"), "{error}");
    }

    #[test]
    fn an_address_may_have_a_port_and_no_name() {
        let any = IpAddr::from([0, 0, 0, 0]);
        assert_eq!(listen("0.0.0.0"), Ok((any, None)));
        assert_eq!(listen("0.0.0.0:81"), Ok((any, Some(81))));
        assert_eq!(listen("::1").unwrap().1, None);
        assert_eq!(listen("[::1]:81").unwrap().1, Some(81));
        assert!(listen("localhost").is_err());
    }

    #[test]
    fn packets_go_to_a_name_or_an_address_with_a_port() {
        let right = "localhost:9000 my-computer.local:1 127.0.0.1:9000 [::1]:65535";
        for right in right.split(' ') {
            assert_eq!(receiver(right), Ok(right.to_owned()));
        }
        // The last one is empty.
        let wrong = "localhost localhost: :9000 localhost:0 localhost:65536 ::1 ::1:9000 [::1] [x]:9000 \
                     http://localhost:9000 ";
        for wrong in wrong.split(' ') {
            let error = receiver(wrong).unwrap_err();
            assert!(error.contains("localhost:9000"), "{wrong}: {error}");
        }
        let long = format!("{}:9000", "x".repeat(64));
        let error = run(&live(&["--demo", "--osc", &long]))
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(&long) && error.contains("a name that this computer knows"),
            "{error}"
        );
    }
}
