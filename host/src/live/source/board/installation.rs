//! Installation of a model on the board, started from the page.

use std::path::Path;

use super::{Context, Request};
use crate::board::{ModelFile, install as send};
use crate::live::event::Event;
use crate::live::outcome::Installing;

/// Takes the model to install that was asked for before there was a connection. Drops all other requests.
pub(super) fn asked_before(context: &Context) -> Option<Vec<u8>> {
    let installs = |request: &Request| matches!(request, Request::Install(_));
    match context.requests.try_iter().filter(installs).last() {
        Some(Request::Install(model)) => Some(model),
        _ => None,
    }
}

/// Installs a model and tells viewers its progress and result. Returns whether it is in use now.
pub(super) fn install(path: &Path, model: &[u8], context: &Context) -> bool {
    let tell = |told| context.hub.publish(&Event::Installing(told));
    let running = Installing::running("outputs are safe until the board has all of it");
    tell(running.clone());
    let sent = ModelFile::new(model)
        .map_err(anyhow::Error::from)
        .and_then(|file| {
            let stopped = || context.stop.requested();
            let of = file.blocks();
            let mut told = None;
            send(path, file, stopped, |blocks| {
                // Viewers need the progress in percent only.
                let hundredths = 100 * blocks / of.max(1);
                if told.replace(hundredths) != Some(hundredths) {
                    let running = running.clone();
                    tell(Installing {
                        blocks,
                        of,
                        ..running
                    });
                }
            })?;
            Ok(file.checksum())
        });
    let is_installed = sent.is_ok();
    tell(match sent {
        Ok(checksum) => Installing {
            state: "done",
            text: format!("model {checksum:08x} is on the board and in use"),
            ..running
        },
        Err(error) => Installing {
            state: "failed",
            text: format!("{error:#}. Install again: it goes on where this one ended"),
            ..running
        },
    });
    is_installed
}
