//! Scenarios on the emulated chip, which runs the image that is flashed, in virtual time.

use anyhow::{Context as _, bail};
use myointent_tests::chip::{Board, Setting};
use myointent_tests::found;
use myointent_tests::output::BoardOutput;
use nrf52::chip::Chip;
use nrf52::time::{HZ, ms};
use shared::myo::Address;
use virtual_armband::{ArmbandFault, Behaviour, End};
use xtask::firmware::Image;

use super::bench::{model, page, samples};
use super::expectation::Models;
use super::file::{Act, File, Scenario};

/// Runs a scenario on the emulated chip, in this image.
pub fn run(file: &File, built: Image) -> anyhow::Result<()> {
    let scenario = &file.scenario;
    let samples = found!(samples(scenario)?);
    let model = model(&scenario.model)?;
    let stranger = scenario.stranger.as_ref().map(|stranger| {
        let address = Address::parse(&stranger.address).context("the stranger's address")?;
        anyhow::Ok((address, stranger.rssi))
    });
    let setting = Setting {
        model: model.clone(),
        page: page(scenario.page),
        samples: samples.clone(),
        behaviour: behaviour(scenario)?,
        stranger: stranger.transpose()?,
        is_blank: false,
    };
    let mut board = found!(Board::of(built, setting));
    let mut person = Actor::new(&scenario.person);
    let end = (scenario.run_seconds * HZ as f64) as u64;
    while board.machine.now() < end {
        person.act(&mut board)?;
        board.run_ms(1)?;
    }
    let folder = tempfile::tempdir()?;
    board.write_output(folder.path())?;
    let output = BoardOutput::new(folder.path());
    let models = Models {
        first: &model,
        other: &[],
    };
    let checked = scenario.expect.check(models, &samples, &output);
    checked.with_context(|| output.tails())
}

fn behaviour(scenario: &Scenario) -> anyhow::Result<Behaviour> {
    let steps = scenario.armband.iter().cloned();
    let steps = steps.map(|step| toml::Value::Table(step).try_into::<ArmbandFault>());
    Ok(Behaviour {
        pace: scenario.pace,
        interval_ms: 0.0,
        first_lane: scenario.first_lane,
        end: match scenario.end.as_str() {
            "silence" => End::Silence,
            "disconnect" => End::Disconnect,
            other => bail!("no end {other}"),
        },
        steps: steps.collect::<Result<_, _>>()?,
    })
}

/// The person, who does one thing after the other.
struct Actor<'s> {
    acts: &'s [Act],
    /// The tick at which the button is released.
    releases_at: Option<u64>,
    /// The tick from which on the next act waits.
    waits_from: Option<u64>,
}

impl<'s> Actor<'s> {
    const fn new(acts: &'s [Act]) -> Self {
        Self {
            acts,
            releases_at: None,
            waits_from: None,
        }
    }

    fn act(&mut self, board: &mut Board) -> anyhow::Result<()> {
        let now = board.machine.now();
        if let Some(at) = self.releases_at {
            if at > now {
                return Ok(());
            }
            board.set_button(false);
            self.releases_at = None;
        }
        let Some((act, rest)) = self.acts.split_first() else {
            return Ok(());
        };
        // The board takes no command and no press before its first line.
        let has_spoken = |chip: &Chip| chip.sent().iter().any(|(_, byte)| *byte == b'\n');
        if board.sent() < act.at() || !has_spoken(&board.machine.chip()) {
            return Ok(());
        }
        if now < *self.waits_from.get_or_insert(now) + ms(act.after_ms()) {
            return Ok(());
        }
        self.waits_from = None;
        self.acts = rest;
        match act {
            Act::Press { for_ms, .. } => {
                board.set_button(true);
                self.releases_at = Some(now + ms(*for_ms));
            }
            Act::Send { command, .. } => board.send(command),
            Act::SendBytes { text, times, .. } => {
                let bytes: Vec<u8> = text.chars().map(|byte| byte as u8).collect();
                board.send_bytes(bytes.repeat(*times));
            }
            Act::Install { .. } => bail!("the emulated chip's person installs nothing"),
        }
        Ok(())
    }
}
