//! `myointent board hid`: keys, buttons and axes of the computer that the board is plugged into.

use std::iter::zip;

use clap::Subcommand;
use shared::hid::{HidCommand, Output, Settings};
use shared::intent::Intent;
use shared::uart_line::answer::Answer;
use shared::uart_line::command::Command;

use crate::board::Board;

/// Request about the outputs.
#[derive(Clone, Copy, Debug, Subcommand)]
pub(super) enum HidRequest {
    /// Show the computer a keyboard, mouse or gamepad, whichever the labels use. The serial port comes back in a second.
    On,
    /// Show none.
    Off,
    /// Give a label an output, or none.
    Set {
        /// open, close, wave-in, wave-out or pinch.
        #[arg(value_parser = gesture)]
        label: Intent,
        /// Such as key:space, click:left, move:up, button:1 or axis:x+; none.
        #[arg(value_parser = output)]
        output: OrNone,
    },
    /// Say which outputs there are.
    State,
}

type OrNone = Option<Output>;

fn gesture(text: &str) -> Result<Intent, String> {
    let label = Intent::from_name(text).filter(|label| *label != Intent::Relax);
    label.ok_or_else(|| "open, close, wave-in, wave-out or pinch".to_owned())
}

fn output(text: &str) -> Result<OrNone, String> {
    if text == "none" {
        return Ok(None);
    }
    let output = Output::from_name(text).ok_or(
        "key:a to key:z, key:0 to key:9, key:f1 to key:f12, key:enter, escape, backspace, tab, space, insert, home, page-up, \
         delete, end, page-down, right, left, down, up, ctrl, shift, alt or meta; click:left, right or middle; move:left, \
         right, up or down; button:1 to button:16; axis:x+, x-, y+, ... rz-; or none",
    )?;
    Ok(Some(output))
}

/// Sends the command, and returns what the board answers, in words.
pub(super) fn run(board: &mut Board, request: HidRequest) -> anyhow::Result<String> {
    let command = match request {
        HidRequest::On => HidCommand::Switch(true),
        HidRequest::Off => HidCommand::Switch(false),
        HidRequest::Set { label, output } => HidCommand::Set(label, output),
        HidRequest::State => HidCommand::State,
    };
    let settings = board.ask(Command::Hid(command), |answer| match answer {
        Answer::Hid(settings) => Some(*settings),
        _ => None,
    })?;
    Ok(said(&settings))
}

fn said(settings: &Settings) -> String {
    let switch = match (settings.on, settings.devices().contains(&true)) {
        (false, _) => "off: `hid on` shows them to the computer",
        (true, false) => "on, but no label has an output: `hid set` gives it one",
        (true, true) => "on",
    };
    let outputs = zip(&Intent::ALL[1..], settings.outputs).map(|(label, output)| {
        let output = output.map_or_else(|| "-".to_owned(), |output| output.names().join(":"));
        format!("{:<9} {output}\n", label.name())
    });
    format!("{switch}\n{}", outputs.collect::<String>())
}
