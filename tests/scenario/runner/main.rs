//! Scenarios: a minute of an armband with its faults, and the expected behaviour of board, lines and pins.
//!
//! Every file of `tests/scenario` is a test on the simulated board in virtual time, and on the emulated chip unless its
//! `not_on_chip` says why not. README.md there describes the format.

mod bench;
mod expectation;
mod file;
mod on_chip;

use std::path::Path;
use std::process::ExitCode;

use libtest_mimic::{Arguments, Failed, Trial};
use xtask::firmware::Image;

/// Scenarios that the emulated chip cannot run.
const LEFT_OUT: usize = 15;

fn main() -> ExitCode {
    let arguments = Arguments::from_args();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenario");
    let trials = trials(&folder).unwrap_or_else(|error| {
        let message = format!("{error:#}");
        vec![Trial::test("scenarios_can_be_read", || Err(message.into()))]
    });
    libtest_mimic::run(&arguments, trials).exit_code()
}

fn trials(folder: &Path) -> anyhow::Result<Vec<Trial>> {
    let mut trials = Vec::new();
    let files = file::all(folder)?;
    let left_out = files
        .iter()
        .filter(|file| file.scenario.not_on_chip.is_some());
    let left_out = left_out.count();
    let all_but = "the_chip_runs_all_but_those_that_say_why";
    trials.push(Trial::test(all_but, move || match left_out {
        LEFT_OUT => Ok(()),
        other => Err(format!("{other} scenarios say `not_on_chip`, expected {LEFT_OUT}").into()),
    }));
    // Its fields are those of two types.
    let wrong = files
        .first()
        .map(|file| format!("colour = 1\n{}", file.text));
    let refused = "a_key_that_no_scenario_has_is_refused";
    trials.push(Trial::test(refused, move || {
        match toml::from_str::<file::Scenario>(&wrong.unwrap_or_default()) {
            Err(error) if error.to_string().contains("`colour`") => Ok(()),
            other => {
                Err(format!("expected an error about the key, found {:?}", other.err()).into())
            }
        }
    }));
    for file in files {
        // The image that the README flashes, and the one without a SoftDevice.
        let images = [
            (
                "chip",
                file.scenario.not_on_chip.is_none(),
                Image::Nrf52840S140,
            ),
            ("chip::sdc", file.scenario.on_sdc, Image::Nrf52840Sdc),
        ];
        for (board, _, image) in images.into_iter().filter(|(_, runs, _)| *runs) {
            let file = file.clone();
            let is_left = !file.scenario.always_on_chip;
            let trial = Trial::test(format!("{board}::{}", file.name), move || {
                on_chip::run(&file, image).map_err(|error| failed(&file, &error))
            });
            trials.push(trial.with_ignored_flag(is_left));
        }
        trials.push(Trial::test(
            format!("simulation::{}", file.name),
            move || bench::simulate(&file).map_err(|error| failed(&file, &error)),
        ));
    }
    Ok(trials)
}

fn failed(file: &file::File, error: &anyhow::Error) -> Failed {
    let about = &file.scenario.about;
    Failed::from(format!("{}: {about}\n{error:#}", file.path.display()))
}
