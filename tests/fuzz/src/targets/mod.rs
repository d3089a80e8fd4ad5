//! Targets of fuzzing. A new target needs its function, its line in [`ALL`] and first inputs in `corpus`.

mod armband;
mod command;
mod description;
mod installation;
mod mat;
mod model;
mod npy;
mod pipeline;
mod preset;
mod recording;
mod report;
mod session;

#[derive(Clone, Copy)]
pub struct Target {
    /// Name on the command line, and of its folder of seeds.
    pub name: &'static str,
    /// Bytes of its longest input: just enough to reach all behaviour, for executions take as long as their input.
    pub longest: usize,
    /// Function that takes any bytes, and panics if a condition does not hold.
    pub run: fn(&[u8]),
}

const fn target(name: &'static str, longest: usize, run: fn(&[u8])) -> Target {
    Target { name, longest, run }
}

/// All targets, from the radio to the PC.
pub const ALL: [Target; 18] = [
    target("advertisement", 256, armband::advertisement),
    target("discovery", 4096, armband::discovery),
    target("notification", 1024, armband::notification),
    target("session", 1024, session::run),
    target("binding", 64, armband::binding),
    target("pipeline", 512, pipeline::run),
    target("command", 512, command::run),
    target("installation", 1024, installation::run),
    target("report", 1024, report::run),
    target("model", 2048, model::run),
    target("template", 128, model::template),
    target("calibration", 1024, model::calibration),
    target("npy", 1024, npy::run),
    target("mat", 2048, mat::run),
    target("recording", 4096, recording::run),
    target("labels", 4096, recording::labels),
    target("preset", 2048, preset::run),
    target("description", 4096, description::run),
];
