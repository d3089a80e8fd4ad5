//! `myointent record`: a guided recording session on a page.

use std::net::IpAddr;
use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::Args;

use super::live::{StreamArguments, listen, serve};
use super::read_model;
use crate::live::{Options, RecordOptions};
use crate::record::{self, Conversion};
use execution::progress;
#[cfg(feature = "train")]
use training::backend::BackendArguments;
use web::record::protocol::{Course, Protocol};

#[derive(Debug, Args)]
#[command(
    after_help = "Give one source: --port, --bluetooth, --replay or --demo.\n\nExamples:\n  myointent record --person anna --port /dev/ttyACM0\n  myointent record --person test --demo --speed 4",
    after_long_help = "Give one source: --port, --bluetooth, --replay or --demo. The page shows what to do now, what comes next and for how long, beside the\n\
    traces; keys are on it. A trial that went wrong is repeated with R. Everything is written as it comes: after a break, a kill or\n\
    a full disk the next start for the same person makes recordings of what was written. At the end the page says whether they are\n\
    good enough and leads on to `myointent personalize`. docs/record.md explains it.\n\n\
    Examples:\n  myointent record --person anna --port /dev/ttyACM0\n  \
    myointent record --person anna --port /dev/ttyACM0 --protocol paper --out recordings\n  \
    myointent record --person test --demo --speed 4                    no hardware: a simulated person follows the cues\n  \
    myointent protocols quick > mine.toml && myointent record --person anna --port COM3 --protocol mine.toml"
)]
pub struct Arguments {
    #[command(flatten)]
    stream: StreamArguments,
    /// Name of the person who is recorded: letters, digits and hyphens.
    ///
    /// The name of the folder and the beginning of the files' names.
    #[arg(long, value_parser = person)]
    person: String,
    /// Folder that has a folder for each person.
    #[arg(long, value_name = "DIR", default_value = "recordings")]
    out: PathBuf,
    /// Gestures to ask for: a built-in protocol, as `myointent protocols` lists them, or a TOML file.
    #[arg(long, value_name = "NAME|FILE", default_value = "quick")]
    protocol: String,
    /// Model file that is tuned on the recordings, and whose labels the page shows.
    ///
    /// Without it, the shipped three-class model.
    #[arg(long, value_name = "FILE.intent")]
    model: Option<PathBuf>,
    /// Play a demo or a replay so many times as fast, to try a protocol out.
    #[arg(hide_short_help = true, long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=16), conflicts_with = "port")]
    speed: u32,
    /// Begin by itself and end with the session, to try a protocol out with --demo or --replay; nobody has to look.
    #[arg(hide_short_help = true, long, conflicts_with_all = ["port", "bluetooth"])]
    unattended: bool,
    /// Where the page is served: an address, or address:port.
    ///
    /// Beyond this machine the address that is printed has a token; the connection is not encrypted.
    #[arg(hide_short_help = true, long, value_name = "ADDR", value_parser = listen)]
    listen: Option<(IpAddr, Option<u16>)>,
    #[cfg(feature = "train")]
    #[command(flatten)]
    backend: BackendArguments,
}

/// Parses a person's name: letters, digits and hyphens, as readers of the files expect.
fn person(name: &str) -> Result<String, String> {
    let allowed = |letter: char| letter.is_ascii_alphanumeric() || letter == '-';
    if name.is_empty() || name.len() > 40 || !name.chars().all(allowed) || name.starts_with('-') {
        return Err(
            "expected at most 40 letters, digits and hyphens, such as anna or s3".to_owned(),
        );
    }
    Ok(name.to_owned())
}

/// Serves the page until Ctrl-C. First makes recordings of the journals that earlier sessions of the person left behind.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let protocol = Protocol::find(&arguments.protocol)?;
    if arguments.unattended && matches!(protocol.course, Course::Free { .. }) {
        anyhow::bail!(
            "--unattended: a free session has no end; leave it out, or give another protocol"
        );
    }
    let model = arguments.model.as_deref().map(read_model).transpose()?;
    let source = arguments.stream.source()?;
    #[cfg(feature = "train")]
    let device = arguments.backend.device()?;
    let whole = recover(&arguments.out.join(&arguments.person))?;
    let record = RecordOptions {
        folder: arguments.out.clone(),
        person: arguments.person.clone(),
        protocol,
        model: arguments
            .model
            .clone()
            .unwrap_or_else(|| Path::new("models/three-class.intent").to_owned()),
        #[cfg(feature = "train")]
        device,
        speed: arguments.speed,
        unattended: arguments.unattended,
    };
    let options = Options {
        source,
        model,
        listen: None,
        imu: arguments.stream.imu,
        record: Some(record),
    };
    serve(arguments.listen, options)?;
    anyhow::ensure!(
        whole,
        "not everything of an earlier session could be kept: the first lines above say what is lost"
    );
    Ok(())
}

/// Makes recordings of earlier sessions. Returns whether all of them are kept whole.
fn recover(folder: &Path) -> anyhow::Result<bool> {
    let found = record::recover(folder).with_context(|| folder.display().to_string())?;
    let mut whole = true;
    for (journal, kept) in found {
        let journal = journal.display();
        match kept {
            Ok(kept) => {
                progress::log(&format!("{journal}: an earlier session, {}", told(&kept)));
                whole &= kept.damage().is_none();
            }
            // A bad journal stops neither the others nor this session.
            Err(error) => {
                progress::log(&format!("warning: {journal}: {error}"));
                whole = false;
            }
        }
    }
    Ok(whole)
}

fn told(kept: &Conversion) -> String {
    let mut text = format!(
        "{:.0} s are kept in {} files",
        kept.quality.seconds,
        kept.files.len()
    );
    if kept.left_off > 0 {
        text += &format!(
            "; {} bytes of a line that was being written are left off, at most {:.1} s",
            kept.left_off,
            kept.seconds_left_off()
        );
    }
    for finding in &kept.quality.findings {
        text += &format!("\n    {finding}: {}", finding.advice());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_person_is_a_name_that_readers_take_back() {
        for name in ["anna", "s3", "Anna-2"] {
            assert_eq!(person(name), Ok(name.to_owned()));
        }
        for name in ["", "anna_2", "../anna", "a b", "-a", "ä"] {
            assert!(person(name).is_err(), "{name}");
        }
    }
}
