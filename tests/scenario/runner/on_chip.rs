//! Scenarios on the emulated chip, which runs the image that is flashed, in virtual time.

use anyhow::{Context as _, bail};
use myointent_tests::chip::{Board, Setting};
use myointent_tests::found;
use myointent_tests::output::BoardOutput;
use nrf52::chip::Chip;
use nrf52::time::{HZ, ms, us};
use virtual_armband::{Act, Acts};
use xtask::firmware::Image;

use super::bench::{model, page, samples};
use super::file::File;

/// Runs a scenario on the emulated chip, in this image.
pub fn run(file: &File, built: Image) -> anyhow::Result<()> {
    let scenario = &file.scenario;
    let samples = found!(samples(scenario)?);
    let model = model(scenario.model);
    let surroundings = &scenario.surroundings;
    let setting = Setting {
        model: model.clone(),
        page: page(scenario.page),
        samples: samples.clone(),
        behaviour: surroundings.behaviour(),
        stranger: surroundings.stranger,
        is_blank: false,
    };
    let mut board = found!(Board::of(built, setting));
    let mut person = Actor {
        acts: surroundings.person.iter().cloned().collect(),
        releases_at: None,
    };
    let end = (surroundings.run_seconds * HZ as f64) as u64;
    while board.machine.now() < end {
        person.act(&mut board)?;
        board.run_ms(1)?;
    }
    let folder = tempfile::tempdir()?;
    board.write_output(folder.path())?;
    let output = BoardOutput::new(folder.path());
    let checked = scenario.expect.check(&model, &samples, &output);
    checked.with_context(|| output.tails())
}

/// The person.
struct Actor {
    acts: Acts,
    /// The tick at which the button is released.
    releases_at: Option<u64>,
}

impl Actor {
    fn act(&mut self, board: &mut Board) -> anyhow::Result<()> {
        let now = board.machine.now();
        if let Some(at) = self.releases_at {
            if at > now {
                return Ok(());
            }
            board.set_button(false);
            self.releases_at = None;
        }
        // The board takes no command and no press before its first line.
        let has_spoken = |chip: &Chip| chip.sent().iter().any(|(_, byte)| *byte == b'\n');
        if !has_spoken(&board.machine.chip()) {
            return Ok(());
        }
        match self.acts.next_due(now / us(1), board.sent()) {
            None => {}
            Some(Act::Press { for_ms, .. }) => {
                board.set_button(true);
                self.releases_at = Some(now + ms(for_ms));
            }
            Some(Act::Send { command, .. }) => board.send(&command),
            Some(Act::SendBytes { text, times, .. }) => {
                let bytes: Vec<u8> = text.chars().map(|byte| byte as u8).collect();
                board.send_bytes(bytes.repeat(times));
            }
            Some(Act::Install { .. }) => bail!("the emulated chip's person installs nothing"),
        }
        Ok(())
    }
}
