//! One file over HTTP: resumed after a break, and bounded.
//!
//! Received bytes are kept as `FILE.partial`, with the version of the server's file beside it. A later command continues
//! where this one stopped, unless that version has changed.

use std::fmt::Display;
use std::fs::{self, OpenOptions};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

use indicatif::ProgressBar;
use ureq::http::Response;

use super::client::{agent, request_error};
use super::error::FetchError;
use super::plan::Download;

/// Maximum size of one file, in bytes.
const MOST: u64 = 32 << 30;
/// Consecutive attempts without new bytes after which the command ends.
const TRIES: usize = 4;
/// Pause before the next attempt, times the number of these attempts.
const PAUSE: Duration = Duration::from_millis(if cfg!(test) { 5 } else { 500 });

/// Download of one file.
pub(super) struct Transfer<'a> {
    of: &'a Download,
    page: &'a str,
    /// Path of the complete file.
    whole: PathBuf,
    partial: PathBuf,
    /// File of two lines: the address of what is kept, and its `ETag` or `Last-Modified`, empty where the server gave neither.
    /// The server's file is unchanged as long as that is.
    version: PathBuf,
    bar: &'a ProgressBar,
}

impl<'a> Transfer<'a> {
    pub(super) fn new(
        of: &'a Download,
        page: &'a str,
        folder: &Path,
        bar: &'a ProgressBar,
    ) -> Self {
        let path = |ending: &str| folder.join(format!("{}{ending}", of.file));
        Self {
            of,
            page,
            whole: path(""),
            partial: path(".partial"),
            version: path(".version"),
            bar,
        }
    }

    /// Downloads the file, or the rest of it, and returns its path.
    ///
    /// # Errors
    /// When the server cannot be reached, has no such file, sends too much, or breaks off again and again; what has
    /// come is kept.
    pub(super) fn run(&self) -> Result<PathBuf, FetchError> {
        if self.whole.exists() {
            return Ok(self.whole.clone());
        }
        let mut fruitless = 0;
        loop {
            let before = self.received();
            match self.attempt() {
                Ok(()) => break,
                Err(error) if error.may_pass => {
                    // An attempt that brings new bytes starts the count anew.
                    fruitless = if self.received() > before {
                        1
                    } else {
                        fruitless + 1
                    };
                    if fruitless >= TRIES {
                        return Err(error);
                    }
                    std::thread::sleep(PAUSE * fruitless as u32);
                }
                Err(error) => return Err(error),
            }
        }
        let io = |source| FetchError::io(&self.whole, source);
        fs::rename(&self.partial, &self.whole).map_err(io)?;
        let _ = fs::remove_file(&self.version);
        Ok(self.whole.clone())
    }

    /// Number of bytes that are kept.
    fn received(&self) -> u64 {
        fs::metadata(&self.partial).map_or(0, |metadata| metadata.len())
    }

    /// The version of what is kept; none if that is damaged, or of another address.
    fn kept_version(&self) -> Option<String> {
        let text = fs::read_to_string(&self.version).ok()?;
        let (url, version) = text.strip_suffix('\n')?.split_once('\n')?;
        let is_whole = url == self.of.url && !version.contains(char::is_control);
        is_whole.then(|| version.to_owned())
    }

    fn attempt(&self) -> Result<(), FetchError> {
        let url = &self.of.url;
        let version = self.kept_version();
        let kept = version.as_ref().map_or(0, |_| self.received());
        let mut request = agent(url).get(url);
        if kept > 0 {
            request = request.header("Range", format!("bytes={kept}-"));
            if let Some(version) = version.filter(|own| !own.is_empty()) {
                request = request.header("If-Range", version);
            }
        }
        let response = request.call().map_err(|error| {
            if kept > 0 || is_break(&error) {
                self.broken(&error)
            } else {
                request_error(url, &error)
            }
        })?;
        match response.status().as_u16() {
            200 => self.receive(response, 0),
            206 if kept > 0 && starts_at(&response) == Some(kept) => self.receive(response, kept),
            // What is kept is no part of the file.
            206 | 416 => {
                self.discard();
                Err(self.broken(&"no file is sent"))
            }
            status => Err(FetchError::status(url, status, self.page)),
        }
    }

    /// Writes a body behind the first `kept` bytes.
    fn receive(&self, mut response: Response<ureq::Body>, kept: u64) -> Result<(), FetchError> {
        let length = header(&response, "content-length").and_then(|own| own.parse::<u64>().ok());
        let total = self.of.size.or(length.map(|length| kept + length));
        let most = self.of.size.unwrap_or(MOST);
        let tag = header(&response, "etag");
        // A weak tag promises no equal bytes.
        let tag = tag.filter(|own| !own.starts_with("W/"));
        let version = tag.or_else(|| header(&response, "last-modified"));
        let version = format!("{}\n{}\n", self.of.url, version.unwrap_or_default());
        fs::write(&self.version, version)
            .map_err(|source| FetchError::io(&self.version, source))?;
        let io = |source| FetchError::io(&self.partial, source);
        let mut file = OpenOptions::new()
            .create(true)
            .write(true)
            .truncate(kept == 0)
            .append(kept > 0)
            .open(&self.partial)
            .map_err(io)?;
        if let Some(total) = total {
            self.bar.set_length(total);
        }
        self.bar.set_position(kept);
        let mut received = kept;
        let mut body = response.body_mut().as_reader();
        let mut piece = vec![0; 1 << 16];
        loop {
            let read = match body.read(&mut piece) {
                Ok(0) => break,
                Ok(read) => read,
                Err(error) => {
                    let _ = file.flush();
                    return Err(self.broken(&error));
                }
            };
            received += read as u64;
            if received > most {
                drop(file);
                self.discard();
                let url = &self.of.url;
                let fault = format!("{url}: sends more than {most} bytes; nothing of it is kept");
                return Err(FetchError::new(fault));
            }
            file.write_all(&piece[..read]).map_err(io)?;
            self.bar.set_position(received);
        }
        file.sync_all().map_err(io)?;
        match total {
            Some(total) if received < total => Err(self.broken(&"the connection was closed")),
            _ => Ok(()),
        }
    }

    fn discard(&self) {
        let _ = fs::remove_file(&self.partial);
        let _ = fs::remove_file(&self.version);
    }

    fn broken(&self, reason: &dyn Display) -> FetchError {
        let (url, received) = (&self.of.url, self.received());
        let total = self.bar.length().map(|total| format!(" of {total}"));
        let of = total.unwrap_or_default();
        FetchError::passing(format!(
            "{url}: broke off after {received} bytes{of}: {reason}; the same command continues there"
        ))
    }
}

/// The first byte of a partial answer, by its `Content-Range`.
fn starts_at(response: &Response<ureq::Body>) -> Option<u64> {
    let range = header(response, "content-range")?;
    let (start, _) = range.strip_prefix("bytes ")?.split_once('-')?;
    start.parse().ok()
}

fn header(response: &Response<ureq::Body>, name: &str) -> Option<String> {
    let value = response.headers().get(name)?;
    Some(value.to_str().ok()?.to_owned())
}

/// Whether the connection broke off after the server was reached.
const fn is_break(error: &ureq::Error) -> bool {
    matches!(error, ureq::Error::Protocol(_))
}
