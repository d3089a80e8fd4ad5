//! The board's program, as far as it goes: it starts, takes the safe state, judges the model file,
//! tells on the UART what it found, and stays safe.
//!
//! No radio and no inference yet, so no label is ever valid. What it proves is that `shared` fits a
//! core without operating system or heap, and that the memory map holds.
#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(target_os = "none", no_main)]
#![deny(missing_docs)]
#![deny(unsafe_code)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod model_region;

#[cfg(target_os = "none")]
mod device {
    //! Start on the board.

    use core::fmt::Write as _;

    use embassy_executor::Spawner;
    use embassy_time::{Duration, Ticker};
    use panic_probe as _;
    use shared::{
        model_file::Model,
        report_line::{Counters, Kind, Report},
        safe_state::{Event, SafeState, Start},
        units::{Millis, SampleIndex},
    };

    use crate::{board::Board, model_region};

    /// Long enough to read, short enough for whoever connects late.
    const REPORT_PERIOD: Duration = Duration::from_secs(1);

    #[embassy_executor::main]
    async fn main(_spawner: Spawner) {
        // The outputs come first: from reset to here every pin floats.
        let mut board = Board::start();
        let mut guard = SafeState::new(Start::Boot);
        match Model::parse(model_region::bytes()) {
            Ok(model) => defmt::info!(
                "model of {} bytes, width {}",
                model.length,
                model.header.dimensions.width
            ),
            Err(error) => {
                guard.handle(Millis(0), Event::ModelRefused);
                defmt::error!("{}", defmt::Display2Format(&error));
                // A comment for whoever reads along; parsers skip what does not start with $.
                let _ = write!(board.uart, "# {error}\r\n");
            }
        }

        let mut every = Ticker::every(REPORT_PERIOD);
        for sequence in 0.. {
            let report = Report {
                kind: Kind::State,
                sequence,
                instant: SampleIndex(0),
                emitted: SampleIndex(0),
                status: guard.status(),
                counters: Counters::default(),
            };
            let _ = write!(board.uart, "{report}");
            every.next().await;
        }
    }
}

/// On a PC there is no board to start; the crate still compiles, so that checks reach it.
#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this program runs on the board: build its image with `cargo xtask build-firmware`");
}
