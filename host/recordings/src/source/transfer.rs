//! One file over HTTP: resumed after a break, and bounded.
//!
//! Received bytes are kept as `FILE.partial`, with what the server said of the file beside it. A later command
//! continues where this one stopped, unless the file has changed.

use std::fs::{self, File, OpenOptions};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

use indicatif::ProgressBar;
use serde::{Deserialize, Serialize};
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

/// Notes on a file that was received in part.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct PartialDownload {
    url: String,
    /// `ETag` or `Last-Modified`: the file is unchanged as long as this is.
    version: Option<String>,
    /// Length of the whole file in bytes.
    total: Option<u64>,
}

/// Download of one file.
pub(super) struct Transfer<'a> {
    of: &'a Download,
    page: &'a str,
    /// Path of the complete file.
    whole: PathBuf,
    partial: PathBuf,
    notes: PathBuf,
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
            notes: path(".partial.json"),
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
                Err(error @ (FetchError::Broken { .. } | FetchError::Status { .. })) => {
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
        let _ = fs::remove_file(&self.notes);
        Ok(self.whole.clone())
    }

    /// Number of bytes that are kept.
    fn received(&self) -> u64 {
        fs::metadata(&self.partial).map_or(0, |metadata| metadata.len())
    }

    /// Notes on the kept bytes; none if they are of another address.
    fn known(&self) -> Option<PartialDownload> {
        let text = fs::read_to_string(&self.notes).ok()?;
        let known: PartialDownload = serde_json::from_str(&text).ok()?;
        (known.url == self.of.url).then_some(known)
    }

    fn attempt(&self) -> Result<(), FetchError> {
        let known = self.known();
        let kept = if known.is_some() { self.received() } else { 0 };
        if let Some((response, from)) = self.ask(kept, known.as_ref())? {
            return self.receive(response, from);
        }
        let _ = fs::remove_file(&self.notes);
        let (response, from) = self
            .ask(0, None)?
            .ok_or_else(|| self.broken("no file is sent"))?;
        self.receive(response, from)
    }

    /// Asks for the bytes after those that are kept: an answer, and the byte that it begins with. None if what was kept is
    /// no part of the file.
    fn ask(
        &self,
        kept: u64,
        known: Option<&PartialDownload>,
    ) -> Result<Option<(Response<ureq::Body>, u64)>, FetchError> {
        let url = &self.of.url;
        let mut request = agent(url).get(url);
        if kept > 0 {
            request = request.header("Range", format!("bytes={kept}-"));
            if let Some(version) = known.and_then(|own| own.version.as_ref()) {
                request = request.header("If-Range", version);
            }
        }
        let response = request.call().map_err(|error| {
            if kept > 0 || is_break(&error) {
                self.broken(error.to_string())
            } else {
                request_error(url, &error)
            }
        })?;
        match response.status().as_u16() {
            200 => Ok(Some((response, 0))),
            // A range other than the one asked for is not used.
            206 if kept > 0 && starts_at(&response) == Some(kept) => Ok(Some((response, kept))),
            206 | 416 => Ok(None),
            status @ (404 | 410) => Err(FetchError::NotFound {
                url: url.clone(),
                status,
                page: self.page.to_owned(),
            }),
            status => Err(FetchError::Status {
                url: url.clone(),
                status,
            }),
        }
    }

    /// Writes a body behind the first `kept` bytes.
    fn receive(&self, mut response: Response<ureq::Body>, kept: u64) -> Result<(), FetchError> {
        let length = header(&response, "content-length").and_then(|own| own.parse::<u64>().ok());
        let total = self.of.size.or(length.map(|length| kept + length));
        let most = self.of.size.unwrap_or(MOST);
        let known = PartialDownload {
            url: self.of.url.clone(),
            version: header(&response, "etag")
                // A weak tag promises no equal bytes.
                .filter(|own| !own.starts_with("W/"))
                .or_else(|| header(&response, "last-modified")),
            total,
        };
        let notes = serde_json::to_vec(&known).unwrap_or_default();
        fs::write(&self.notes, notes).map_err(|source| FetchError::io(&self.notes, source))?;
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
                    return Err(self.broken(error.to_string()));
                }
            };
            received += read as u64;
            if received > most {
                self.discard(file);
                return Err(FetchError::TooLong {
                    url: self.of.url.clone(),
                    most,
                });
            }
            file.write_all(&piece[..read]).map_err(io)?;
            self.bar.set_position(received);
        }
        file.sync_all().map_err(io)?;
        match total {
            Some(total) if received < total => Err(self.broken("the connection was closed")),
            _ => Ok(()),
        }
    }

    fn discard(&self, file: File) {
        drop(file);
        let _ = fs::remove_file(&self.partial);
        let _ = fs::remove_file(&self.notes);
    }

    fn broken(&self, reason: impl Into<String>) -> FetchError {
        let total = self.known().and_then(|known| known.total);
        FetchError::Broken {
            url: self.of.url.clone(),
            received: self.received(),
            of: total.map_or_else(String::new, |total| format!(" of {total}")),
            reason: reason.into(),
        }
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
