//! Boards that a scenario runs on.

use std::fs;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail, ensure};
use myointent_tests::emulator::{self, Run, bench};
use myointent_tests::simulation::{self, Inputs};
use serde_json::{Value, json};
use shared::model::noise::Noise;
use shared::myo::{Address, binding};
use shared::units::Sample;

use super::expectation::Models;
use super::file::{Act, File, Model, Page, Scenario, Signal};

/// Address of the armband.
const ARMBAND: &str = "FA:12:34:56:78:9A";
/// Factor by which the emulated board's clock runs slower than real time: its timeout of 200 ms is a second of real
/// time.
const TIME_SCALE: u32 = 5;
const PACE: f64 = 3.0;
/// Factor of the clock where the armband has its true rate by that clock, so that times are as on a board.
const TRUE_RATE_TIME_SCALE: u32 = 3;
/// Longest wait for an expected event of the emulated board.
const PATIENCE: Duration = Duration::from_secs(90);

/// Runs a scenario on the simulated board, in virtual time.
///
/// # Errors
/// Names the first expectation that does not hold.
pub fn simulate(file: &File, program: &Path) -> anyhow::Result<()> {
    let Some(samples) = samples(&file.name, &file.scenario)? else {
        return Ok(());
    };
    let model = model(&file.scenario.model)?;
    let other = file.scenario.install.as_deref().map(model_file);
    let other = other.transpose()?;
    let ran = simulation::run(
        program,
        &Inputs {
            scenario: &file.text,
            model: &model,
            samples: &samples,
            page: &page(file.scenario.page),
            install: other.as_deref(),
        },
    )?;
    let models = Models {
        first: &model,
        other: other.as_deref().unwrap_or_default(),
    };
    let checked = file.scenario.expect.check(models, &samples, &ran);
    checked.with_context(|| ran.tails())?;
    if file.scenario.expect.installed {
        ensure!(
            ran.region.starts_with(models.other),
            "the region does not hold the file"
        );
    }
    Ok(())
}

/// Runs a scenario on the emulated board, against the virtual armband.
///
/// # Errors
/// Names the first expectation that does not hold.
pub fn emulate(file: &File) -> anyhow::Result<()> {
    let scenario = &file.scenario;
    let Some(samples) = samples(&file.name, scenario)? else {
        return Ok(());
    };
    let Some(bench) = bench(&file.name) else {
        return Ok(());
    };
    let model = model(&scenario.model)?;
    let mut arguments = vec![
        "--end".to_owned(),
        scenario.end.clone(),
        "--first-lane".to_owned(),
        scenario.first_lane.to_string(),
    ];
    if let Some(stranger) = &scenario.stranger {
        let stranger = format!("{},{}", stranger.address, stranger.rssi);
        arguments.extend(["--stranger".to_owned(), stranger]);
    }
    let (time_scale, pace) = if scenario.true_rate {
        let time_scale = scenario.time_scale.unwrap_or(TRUE_RATE_TIME_SCALE);
        (time_scale, scenario.pace / f64::from(time_scale))
    } else {
        (scenario.time_scale.unwrap_or(TIME_SCALE), PACE)
    };
    let script = scenario.armband.iter().map(|step| json!(step));
    let script = script.map(|step| slowed_down(step, time_scale)).collect();
    let mut run = bench.start(&emulator::Scenario {
        model: &model,
        samples: &samples,
        page: Some(page(scenario.page)),
        time_scale,
        pace,
        fault: fault(scenario.fault.as_deref())?,
        script,
        arguments,
    })?;
    // The board takes no command and no press before.
    run.wait_for("the board's first line", |run| !run.comments().is_empty())?;
    for act in &scenario.person {
        carry_out(act, &mut run, time_scale)?;
    }
    let start = Instant::now();
    loop {
        let models = Models {
            first: &model,
            other: &[],
        };
        let checked = scenario.expect.check(models, &samples, &run);
        let checked = checked.and_then(|()| scenario.expect.check_armband(&run));
        match checked {
            Ok(()) => break,
            Err(error) if start.elapsed() > PATIENCE => {
                return Err(error.context(format!("after {PATIENCE:?}\n{}", run.tails())));
            }
            Err(_) => sleep(Duration::from_millis(50)),
        }
    }
    if scenario.fault.is_some() {
        run.expect_restart();
    }
    run.check()
}

/// Scales a step to real time: a scenario's times are the board's, the armband's script has real ones.
fn slowed_down(mut step: Value, time_scale: u32) -> Value {
    for key in ["ms", "for_ms"] {
        if let Some(ms) = step[key].as_u64() {
            step[key] = json!(ms * u64::from(time_scale));
        }
    }
    step
}

fn carry_out(act: &Act, run: &mut Run, time_scale: u32) -> anyhow::Result<()> {
    let at = act.at();
    run.wait_for(&format!("{at} notifications"), |run| {
        run.event_count("sent") >= at
    })?;
    match act {
        Act::Press { for_ms, .. } => {
            run.set_button(true)?;
            sleep(Duration::from_millis(for_ms * u64::from(time_scale)));
            run.set_button(false)
        }
        Act::Send { command, .. } => {
            let sum = command.bytes().fold(0, |sum, byte| sum ^ byte);
            run.ask(&format!("${command}*{sum:02X}\r\n")).map(drop)
        }
        Act::SendBytes { text, times, .. } => {
            let bytes: Vec<u8> = text.chars().map(|byte| byte as u8).collect();
            (0..*times).try_for_each(|_| run.send(&bytes))
        }
        Act::Install { .. } => bail!("the emulated board's person installs nothing"),
    }
}

fn fault(name: Option<&str>) -> anyhow::Result<Option<emulator::Fault>> {
    Ok(Some(match name {
        None => return Ok(None),
        Some("task-stops") => emulator::Fault::TaskStops,
        Some("panic") => emulator::Fault::Panic,
        Some("recursion") => emulator::Fault::Recursion,
        Some("executor-stops") => emulator::Fault::ExecutorStops,
        Some("inference-loops") => emulator::Fault::InferenceLoops,
        Some("radio-stops") => emulator::Fault::RadioStops,
        Some("inference-pauses") => emulator::Fault::InferencePauses,
        Some(other) => bail!("no fault {other}"),
    }))
}

/// Reads or generates the armband's samples; returns `None` where the recordings are missing.
///
/// # Errors
/// Fails when a recording cannot be read, or is too short.
pub fn samples(name: &str, scenario: &Scenario) -> anyhow::Result<Option<Vec<Sample>>> {
    let count = (scenario.seconds * 200.0).round() as usize;
    let Some(recording) = &scenario.recording else {
        return Ok(Some(synthetic(scenario.signal, count)));
    };
    let Some(folder) = myointent_tests::data(name) else {
        return Ok(None);
    };
    let path = folder.join(recording);
    if !path.is_file() {
        let missing = format!("no {}: see docs/recordings.md", path.display());
        myointent_tests::skip(name, &missing);
        return Ok(None);
    }
    let mut samples = myointent::cli::replay::one_recording(&path, None)?.samples;
    ensure!(
        samples.len() >= count,
        "{} has {} samples, not {count}",
        path.display(),
        samples.len()
    );
    samples.truncate(count);
    Ok(Some(samples))
}

fn synthetic(signal: Signal, count: usize) -> Vec<Sample> {
    let mut noise = Noise(5);
    (0..count)
        .map(|index| {
            let works = index / 300 % 2 == 1;
            [(); 8].map(|()| match signal {
                Signal::Rest => (noise.signed() * 3.0) as i8,
                Signal::Effort => (noise.signed() * if works { 90.0 } else { 3.0 }) as i8,
                Signal::Saturated if noise.signed() < 0.0 => i8::MIN,
                Signal::Saturated => i8::MAX,
                Signal::Constant => 7,
            })
        })
        .collect()
}

/// Reads a model of the repository.
fn model_file(name: &str) -> anyhow::Result<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let path = folder.join(name).with_extension("intent");
    fs::read(&path).with_context(|| path.display().to_string())
}

/// Returns the content of the model's region.
///
/// # Errors
/// Fails when the model cannot be read.
pub fn model(model: &Model) -> anyhow::Result<Vec<u8>> {
    let mut bytes = model_file("three-class")?;
    let middle = bytes.len() / 2;
    match model {
        Model::Shipped => {}
        Model::Erased => bytes.fill(0xff),
        Model::Half => bytes.truncate(middle),
        Model::FlippedBit => bytes[middle] ^= 1,
        Model::AnotherVersion => bytes[8] += 1,
    }
    Ok(bytes)
}

/// Returns the content of the page of the bound armband.
pub fn page(page: Page) -> Vec<u8> {
    let armband = Address::parse(ARMBAND).expect("an address");
    let mut record = binding::to_record(armband).to_vec();
    match page {
        Page::Bound => {}
        Page::Erased => record.fill(0xff),
        Page::HalfWritten => record[12..].fill(0xff),
        Page::FlippedBit => record[6] ^= 1,
    }
    record
}
