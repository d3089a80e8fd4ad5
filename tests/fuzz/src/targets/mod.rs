//! What is fuzzed. A new target: its file, its line in [`ALL`], its seeds in [`crate::seeds`].

mod advertisement;
mod answer;
mod binding;
mod command;
mod discovery;
mod labels;
mod mat;
mod model;
mod notification;
mod npy;
mod pipeline;
pub mod recording;
mod report;
mod session;
mod template;

/// A target.
#[derive(Clone, Copy)]
pub struct Target {
    /// Name on the command line, and of its folder of seeds.
    pub name: &'static str,
    /// Takes any bytes; panics if something does not hold that must.
    pub run: fn(&[u8]),
}

const fn target(name: &'static str, run: fn(&[u8])) -> Target {
    Target { name, run }
}

/// All of them, from the radio to the PC.
pub const ALL: [Target; 15] = [
    target("advertisement", advertisement::run),
    target("discovery", discovery::run),
    target("notification", notification::run),
    target("session", session::run),
    target("binding", binding::run),
    target("pipeline", pipeline::run),
    target("command", command::run),
    target("report", report::run),
    target("answer", answer::run),
    target("model", model::run),
    target("template", template::run),
    target("npy", npy::run),
    target("mat", mat::run),
    target("recording", recording::run),
    target("labels", labels::run),
];
