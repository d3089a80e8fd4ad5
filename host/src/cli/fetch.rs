//! `myointent data fetch`: published recordings, downloaded or from an archive at hand.

use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;

use super::contents::{Recordings, tables};
use evaluation::report::Table;
use execution::progress;
use recordings::catalogue::{Address, Source, source, sources};
pub use recordings::printable;
use recordings::source::{Download, Plan, Received, ZENODO, download, free, plan, put_in_place};
use recordings::{LoadOptions, load};

#[derive(Args, Debug)]
#[command(
    // Not in `long_about`, which the one line of the subcommand hides.
    after_help = "Without NAME, lists the data sets. The licence is shown first, and nothing is downloaded until it is agreed to. A download that\n\
        breaks off is continued by the same command. Checksums are compared where the publisher states them; of every download\n\
        its SHA-256 is printed.\n\n\
        Without a network: download the archive elsewhere, from the page that the list names, and give it with --archive. zip, tar\n\
        and tar.gz are told by content. An archive without a recording of the set is refused, and nothing of it is kept.\n\n\
        Examples:\n  myointent data fetch\n  \
        myointent data fetch ss-stm\n  \
        myointent data fetch roshambo --to recordings --accept-licence\n  \
        myointent data fetch myoup --archive ~/Downloads/MyoUP_dataset-main.zip"
)]
pub struct Arguments {
    /// The data set, by its name in `myointent data fetch`
    name: Option<String>,
    /// Folder of all recordings; the set gets a folder of its name in it
    #[arg(long, value_name = "DIR", default_value = "data")]
    to: PathBuf,
    /// Archive that was downloaded before; several if the set is published in parts
    #[arg(long, value_name = "FILE", requires = "name")]
    archive: Vec<PathBuf>,
    /// Agree to the licence without being asked, for scripts
    #[arg(long, requires = "name")]
    accept_licence: bool,
}

/// Fetches a data set, or lists all of them.
pub(super) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Some(name) = &arguments.name else {
        return Ok(std::io::stdout().write_all(published().plain().as_bytes())?);
    };
    let Some(own) = source(name) else {
        let names: Vec<&str> = sources().map(|own| &own.name[..]).collect();
        bail!(
            "no data set is named {}: expected one of {}",
            printable(name),
            names.join(", ")
        );
    };
    let place = arguments.to.join(name);
    free(&place)?;
    if !arguments.archive.is_empty() {
        agree(own, None, arguments.accept_licence)?;
        put(own, &arguments.archive, &place)?;
        return Ok(());
    }
    if let Address::ByHand(why) = &own.address {
        bail!(
            "{name} cannot be downloaded by a program: {why}\n{}",
            by_hand(own, &[])
        );
    }
    let planned = plan(own, ZENODO).with_context(|| by_hand(own, &[]))?;
    agree(
        own,
        planned.stated_licence.as_deref(),
        arguments.accept_licence,
    )?;
    let parts = arguments.to.join(format!(".{name}.download"));
    let received =
        download(&planned, own, &parts).with_context(|| by_hand(own, &planned.downloads))?;
    report(&planned, &received)?;
    let files: Vec<PathBuf> = received.into_iter().map(|own| own.path).collect();
    put(own, &files, &place)?;
    let _ = std::fs::remove_dir_all(&parts);
    Ok(())
}

/// Shows the licence and waits for a yes.
fn agree(own: &Source, stated: Option<&str>, accepted: bool) -> anyhow::Result<()> {
    let name = &own.name;
    progress::log(&format!("{name}: {}", own.page));
    progress::log(&format!("licence: {}", own.licence));
    if let Some(stated) = stated {
        progress::log(&format!(
            "licence, as the publisher states it now: {}",
            printable(stated)
        ));
    }
    if accepted {
        return Ok(());
    }
    if !std::io::stdin().is_terminal() {
        bail!(
            "the licence needs agreement, and there is no terminal to ask at: read the page, then give --accept-licence"
        );
    }
    let mut err = std::io::stderr().lock();
    write!(err, "agree to it, and download? yes / no: ")?;
    err.flush()?;
    let mut line = String::new();
    std::io::stdin().read_line(&mut line)?;
    if line.trim().eq_ignore_ascii_case("yes") {
        Ok(())
    } else {
        bail!("not agreed to: nothing was downloaded")
    }
}

/// Instructions for a download by hand.
fn by_hand(own: &Source, downloads: &[Download]) -> String {
    let name = &own.name;
    let addresses: Vec<&str> = downloads.iter().map(|of| &of.url[..]).collect();
    let from = if addresses.is_empty() {
        own.page.clone()
    } else {
        format!("{} (page: {})", addresses.join(", "), own.page)
    };
    format!(
        "{name} was not fetched. By hand: download {from}, then `myointent data fetch {name} --archive FILE`"
    )
}

/// Prints the received files, and how each was checked.
fn report(planned: &Plan, received: &[Received]) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    for (own, of) in received.iter().zip(&planned.downloads) {
        let checked = match &of.checksum {
            Some(published) => format!("as published, {published}"),
            None => "published checksum: unknown".to_owned(),
        };
        writeln!(
            out,
            "{}: {checked}; computed: {}",
            printable(&of.file),
            own.sha256
        )?;
    }
    Ok(())
}

/// Puts archives in place and prints what was recognised.
fn put(own: &'static Source, files: &[PathBuf], place: &Path) -> anyhow::Result<()> {
    let done = put_in_place(files, place, own.data_set())?;
    let mut out = std::io::stdout().lock();
    let left_out = match done.left_out {
        0 => String::new(),
        count => format!(", {count} links and the like left out"),
    };
    writeln!(
        out,
        "{}: {} files, {:.1} MiB{left_out}\n",
        place.display(),
        done.files,
        done.bytes as f64 / (1024.0 * 1024.0)
    )?;
    let library = load(place, &LoadOptions::default())?;
    out.write_all(tables(&Recordings::new(&library)).as_bytes())?;
    Ok(())
}

/// Table of the data sets: names, addresses and licences.
fn published() -> Table {
    let caption =
        "myointent data fetch NAME downloads one; docs/recordings.md says what is in them.";
    let mut table = Table::new(caption, ["name", "page", "how", "licence"]);
    for own in sources() {
        let how = match &own.address {
            Address::ByHand(_) => "by hand",
            Address::Zenodo(_) => "download, checksum",
            Address::Archive(_) => "download",
        };
        let licence = own.licence.split([':', ';']).next().unwrap_or_default();
        table.push([&own.name, &own.page, how, licence]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tar of one file.
    fn tar(name: &str, content: &str) -> Vec<u8> {
        let mut header = [0; 512];
        header[..name.len()].copy_from_slice(name.as_bytes());
        header[124..135].copy_from_slice(format!("{:011o}", content.len()).as_bytes());
        header[148..156].fill(b' ');
        header[156] = b'0';
        header[257..265].copy_from_slice(b"ustar\x0000");
        let sum: u32 = header.iter().map(|&byte| u32::from(byte)).sum();
        header[148..154].copy_from_slice(format!("{sum:06o}").as_bytes());
        let mut bytes = [&header, content.as_bytes()].concat();
        bytes.resize(bytes.len().next_multiple_of(512) + 1024, 0);
        bytes
    }

    #[test]
    fn an_archive_at_hand_is_put_in_place_once_its_licence_is_agreed_to() {
        let folder = tempfile::tempdir().unwrap();
        let archive = folder.path().join("archive");
        let rows = "0,1,2,3,4,-3,-2,-1,0\n".repeat(700);
        std::fs::write(&archive, tar("12345-2/7.txt", &rows)).unwrap();
        let fetch = |accept_licence| {
            run(&Arguments {
                name: Some("myo-readings".to_owned()),
                to: folder.path().to_owned(),
                archive: vec![archive.clone()],
                accept_licence,
            })
        };
        let place = folder.path().join("myo-readings/12345-2/7.txt");
        assert!(fetch(false).is_err() && !place.exists());
        fetch(true).unwrap();
        assert_eq!(std::fs::read_to_string(&place).unwrap(), rows);
        let again = fetch(true).unwrap_err().to_string();
        assert!(again.contains("myo-readings"), "{again}");
    }
}
