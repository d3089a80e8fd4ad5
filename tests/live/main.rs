//! `myointent live`: the page and its messages, lines of JSON, a board on a pseudo-terminal, and the page in a browser.

/// Starts Chromium; without it, the test is booked as skipped and ends.
macro_rules! start {
    () => {
        match $crate::browser::Browser::start($crate::browser::BrowserKind::Chromium) {
            Some(browser) => browser,
            None => return,
        }
    };
}

/// Opens a page in Chromium, in a window of 1440 x 900 that is light and moves.
macro_rules! open {
    ($live:expr) => {{
        let mut browser = start!();
        let live = $live;
        browser.look(1440, 900, "light", "no-preference");
        browser.open(live.url());
        (browser, live)
    }};
}

// Tests start by name: this one, which takes minutes, comes first, and the others run beside it.
#[cfg(target_os = "linux")]
#[path = "owner.rs"]
mod a_whole_loop;
mod align;
#[cfg(target_os = "linux")]
mod ask;
#[cfg(target_os = "linux")]
mod board;
mod browser;
mod demo;
#[cfg(target_os = "linux")]
mod empty;
mod firefox;
mod guided;
#[cfg(target_os = "linux")]
mod install;
mod languages;
#[cfg(target_os = "linux")]
mod port;
#[cfg(unix)]
mod process;
mod record;
mod replay;
#[cfg(target_os = "linux")]
mod scripted;
mod server;
mod session;
mod sessions;
mod sizes;
#[cfg(target_os = "linux")]
mod steps;
mod viewer;
#[cfg(target_os = "linux")]
mod worker;

use myointent::live::{self, Live, Options, Source};
use myointent_tests::model_file;
use recordings::Recording;
use recordings::synthetic::{self, SynthOptions};

/// Options of a page of a source, on any free port of this machine.
fn options(source: Source) -> Options {
    Options {
        listen: Some("127.0.0.1:0".parse().unwrap()),
        ..Options::of(source)
    }
}

/// Starts the page of a source.
fn serve(source: Source) -> Live {
    live::start(options(source)).unwrap()
}

fn shipped() -> Vec<u8> {
    model_file("three-class")
}

/// Generates a synthetic recording.
fn synthetic(seconds: usize) -> Recording {
    let options = SynthOptions {
        subjects: 1,
        recordings: 1,
        seconds,
        ..SynthOptions::default()
    };
    synthetic::generate(&options).remove(0)
}
