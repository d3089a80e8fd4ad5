//! A board on a PC, in virtual time: beside it an armband and a person that do what a scenario says. With a socket to a
//! simulated Bluetooth controller the armbands are another program's, and time is the PC's.
//!
//! The tasks are the board's, on the same executor; time passes by 20 us with each of its turns, so that a minute takes a second and
//! every run gives the same lines. What the program computes takes no time but what the scenario gives it.

mod clock;
mod fault;
mod flash;
mod hardware;
#[cfg(unix)]
mod hci;
#[cfg(test)]
mod moments;
mod person;
mod power;
mod radio;

use std::cell::RefCell;
#[cfg(unix)]
use std::os::unix::net::UnixStream;
use std::process::ExitCode;
use std::sync::OnceLock;
use std::sync::atomic::Ordering;

use anyhow::{Context as _, ensure};
use clap::Parser as _;
use embassy_executor::{Executor, Spawner};
use embassy_time::{Duration, Instant, Timer};
use shared::stream::strength::Percent;
use shared::units::Sample;
use static_cell::StaticCell;
use virtual_armband::{BoardFault, Scenario, armbands};

use super::{Board, BytesLost};
use crate::flash::Region;
use crate::installation;
use crate::messages::pin_state::PinState;
use crate::radio::driver::SessionDriver;
use crate::reset_reason::ResetReason;
use crate::settings::{DEAD_MAN_MS, WATCHDOG_MS};
use person::{BYTE_US, IS_DOWN, OVERRUN, RECEIVED, ScenarioPerson};
use power::Arguments;
use radio::SimulatedRadio;

/// Surroundings of the board, from its start on.
static SURROUNDINGS: OnceLock<Surroundings> = OnceLock::new();

struct Surroundings {
    arguments: &'static Arguments,
    #[cfg(unix)]
    controller: Option<UnixStream>,
    scenario: Scenario,
    samples: Vec<Sample>,
    /// Model file that the person installs.
    file: Vec<u8>,
}

/// Reads the arguments, and runs the program that `start` starts until the scenario is over.
pub fn main(start: fn(Spawner)) -> ExitCode {
    let arguments = power::keep(Arguments::parse());
    match prepare(arguments) {
        Ok(surroundings) => {
            let file = surroundings.file.clone();
            let person = ScenarioPerson::new(&surroundings.scenario.person, arguments.sent, file);
            let surroundings = SURROUNDINGS.set(surroundings);
            debug_assert!(surroundings.is_ok(), "started once");
            on_panic();
            static EXECUTOR: StaticCell<Executor> = StaticCell::new();
            EXECUTOR.init_with(Executor::new).run(|spawner| {
                if let Ok(clock) = clock::run(person, arguments.slowed) {
                    spawner.spawn(clock);
                }
                start(spawner);
            })
        }
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn prepare(arguments: &'static Arguments) -> anyhow::Result<Surroundings> {
    let read = |path: &std::path::Path| {
        std::fs::read(path).with_context(|| format!("{} cannot be read", path.display()))
    };
    let path = arguments.scenario.display();
    let text = String::from_utf8(read(&arguments.scenario)?)
        .with_context(|| format!("{path} is no text"))?;
    let scenario: Scenario =
        toml::from_str(&text).with_context(|| format!("{path} is no scenario"))?;
    ensure!(
        scenario.pace > 0.0
            && scenario.packet_ms >= 0.0
            && scenario.run_seconds > 0.0
            && scenario.power_fails_done.iter().all(|done| *done <= 100),
        "{path}: pace and run_seconds are above 0, packet_ms is not below, and power_fails_done at most 100"
    );
    crate::flash::insert(Region::Model, &read(&arguments.model)?);
    crate::flash::insert(Region::Binding, &read(&arguments.page)?);
    for (region, path) in [
        (Region::Journal, &arguments.journal),
        (Region::Calibration, &arguments.calibration),
    ] {
        if let Some(path) = path.as_ref().filter(|path| path.exists()) {
            crate::flash::insert(region, &read(path)?);
        }
    }
    let file = arguments.install.as_deref().map(read).transpose()?;
    let samples = read(&arguments.samples)?;
    let (samples, _) = samples.as_chunks::<8>();
    let samples = samples.iter().map(|bytes| bytes.map(u8::cast_signed));
    let run_us = (scenario.run_seconds * 1e6) as u64;
    hardware::start(&arguments.out, run_us.saturating_sub(arguments.elapsed_us))
        .with_context(|| format!("{} cannot be written", arguments.out.display()))?;
    #[cfg(unix)]
    let controller = arguments.hci.as_ref().map(UnixStream::connect).transpose();
    Ok(Surroundings {
        arguments,
        #[cfg(unix)]
        controller: controller.context("no Bluetooth controller at the socket")?,
        samples: samples.collect(),
        scenario,
        file: file.unwrap_or_default(),
    })
}

/// A panic resets the board.
fn on_panic() {
    std::panic::set_hook(Box::new(|panic| power::fail(panic)));
}

fn surroundings() -> &'static Surroundings {
    SURROUNDINGS
        .get()
        .expect("set before the program is started")
}

pub struct RadioParts(());

/// Takes the peripherals; the pin levels are safe from here on.
pub fn start() -> Board {
    let Surroundings {
        arguments,
        scenario,
        ..
    } = surroundings();
    hardware::feed_watchdog(WATCHDOG_MS);
    hardware::set_levels(PinState::SAFE);
    Board {
        labels: LabelPort {
            fault: scenario.fault,
        },
        commands: CommandPort(()),
        pins: Pins(PinState::SAFE),
        button: Button(()),
        radio: RadioParts(()),
        watchdog: Watchdog(()),
        dead_man: DeadMan {
            packet_us: (scenario.packet_ms * 1000.0) as u64,
        },
        reset_reason: arguments.reset.unwrap_or(ResetReason::Power),
    }
}

pub async fn run_radio(_: Spawner, _: RadioParts, driver: &SessionDriver<'_>) {
    let Surroundings {
        arguments,
        scenario,
        samples,
        ..
    } = surroundings();
    #[cfg(unix)]
    if let Some(controller) = &surroundings().controller {
        installation::beside(flash::Files, async |flash| {
            hci::run(controller, driver, flash).await;
        })
        .await;
        return;
    }
    fault::inject_at_start(scenario.fault);
    hardware::sent(arguments.sent);
    let armbands = armbands(
        scenario.behaviour(),
        scenario.stranger,
        samples.clone(),
        arguments.sent,
    );
    let armbands: Vec<_> = armbands.into_iter().map(RefCell::new).collect();
    let mut radio = SimulatedRadio {
        armbands: &armbands,
    };
    installation::beside(flash::Files, async |flash| {
        driver.run(&mut radio, flash).await
    })
    .await;
}

/// The UART's transmitter.
pub struct LabelPort {
    fault: Option<BoardFault>,
}

impl LabelPort {
    /// Sends a line, in the time that it takes at 115200 baud.
    pub async fn send(&mut self, line: &[u8]) {
        let end = Instant::now() + Duration::from_micros(line.len() as u64 * BYTE_US);
        Timer::at(end).await;
        hardware::write_line(line, end.as_micros());
        person::hear(line);
        fault::inject(self.fault, line).await;
    }
}

/// The UART's receiver.
pub struct CommandPort(());

impl CommandPort {
    /// Waits for bytes and takes some; returns the line that they came by and their number.
    pub async fn read(&mut self, buffer: &mut [u8]) -> (usize, Result<usize, BytesLost>) {
        let count = RECEIVED.read(buffer).await;
        let is_lost = OVERRUN.swap(false, Ordering::Relaxed);
        (0, if is_lost { Err(BytesLost) } else { Ok(count) })
    }
}

pub struct Pins(PinState);

impl Pins {
    /// Sets every level. Pulses are not simulated.
    pub fn set(&mut self, state: PinState) {
        let state = PinState {
            strength: Percent::ZERO,
            ..state
        };
        if state != self.0 {
            self.0 = state;
            hardware::set_levels(state);
        }
    }
}

pub struct Button(());

impl Button {
    pub fn is_down(&mut self) -> bool {
        IS_DOWN.load(Ordering::Relaxed)
    }
}

pub struct Watchdog(());

impl Watchdog {
    /// Restarts the period.
    pub fn feed(&mut self) {
        hardware::feed_watchdog(WATCHDOG_MS);
    }
}

/// A timer that makes the pins safe unless it is cleared in time.
pub struct DeadMan {
    packet_us: u64,
}

impl DeadMan {
    /// Restarts the period. Every packet passes here, so the time that it takes passes here too.
    pub fn clear(&mut self) {
        fault::inject_into_inference();
        hardware::clear_dead_man(DEAD_MAN_MS);
        clock::spend(self.packet_us);
    }

    /// Whether the timer has expired since the last [`DeadMan::acknowledge`]: the pins are safe, and stay so.
    pub fn has_expired(&self) -> bool {
        hardware::dead_man_has_expired()
    }

    /// Lets the pins show a valid label again.
    pub fn acknowledge(&mut self) {
        hardware::acknowledge_dead_man();
    }
}
