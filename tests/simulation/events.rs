//! Event log of the simulated board, in microseconds since a start.

use std::path::Path;

use anyhow::{Context as _, bail};

/// Events from one start of the program to the next.
#[derive(Clone, Default, Debug)]
pub struct Start {
    /// Time of each received packet, and its number over all starts.
    pub packets: Vec<(u64, usize)>,
    /// Time at which the last byte of each line had been sent, in the order of UART0's lines.
    pub lines: Vec<u64>,
}

/// Reads the log.
pub fn read(path: &Path) -> anyhow::Result<Vec<Start>> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let mut starts = Vec::new();
    for line in text.lines() {
        add(&mut starts, line).with_context(|| line.to_owned())?;
    }
    Ok(starts)
}

fn add(starts: &mut Vec<Start>, line: &str) -> anyhow::Result<()> {
    let mut words = line.split_whitespace();
    let what = words.next().context("an empty line")?;
    let at_us = words.next().context("no time")?.parse()?;
    let number = words.next();
    let number = || number.context("no number");
    if what == "START" {
        starts.push(Start::default());
        return Ok(());
    }
    let start = starts.last_mut().context("before the start")?;
    match what {
        "PACKET" => start.packets.push((at_us, number()?.parse()?)),
        "LINE" => start.lines.push(at_us),
        _ => bail!("nothing that a board writes"),
    }
    Ok(())
}
