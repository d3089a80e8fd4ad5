//! Cuts of the line at 100 random bytes of each dialogue with the firmware: in the command on its way to the board, or
//! in the answer, which is then lost. A line that is put back carries the next command.

use std::fmt::Write as _;

use anyhow::{Context as _, ensure};
use myointent_tests::oracle::{Input, expected_lines};
use myointent_tests::simulation::{self, Inputs, Ran};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use shared::stream::alignment::{Alignment, Arm};
use shared::stream::safe_state::Cause;
use shared::stream::smoother::Gate;
use shared::units::Sample;

use super::{ARMBAND, cuts, model, page, program, samples};

const CUTS: usize = 100;
/// Number of notifications before the first cut, so that labels come.
const FIRST: usize = 400;

/// Command that is cut, and the commands before and after it. Every body has its answer, which may go on after `…`.
#[derive(Clone, Copy)]
struct Dialogue<'d> {
    /// Command that gives the cut one an effect.
    before: Option<[&'d str; 2]>,
    cut: [&'d str; 2],
    /// Question, its answer where the command was not taken, and its answer where it was.
    probe: [&'d str; 3],
    /// Command that undoes the effect.
    after: Option<[&'d str; 2]>,
}

/// Bytes that a person sends after so many notifications.
struct Sent {
    at: usize,
    bytes: Vec<u8>,
    /// Body of the command, if it is whole.
    body: Option<String>,
}

/// Bytes that are sent, and the expected answers.
#[derive(Default)]
struct Script {
    sent: Vec<Sent>,
    answers: Vec<String>,
    /// Number of cut commands that came whole.
    taken: usize,
}

impl Script {
    fn ask(&mut self, at: usize, [body, answer]: [&str; 2]) {
        self.sent.push(Sent {
            at,
            bytes: framed(body).into_bytes(),
            body: Some(body.to_owned()),
        });
        self.answers.push(answer.to_owned());
    }

    /// Pulls the line at a byte of the dialogue; returns true if the command has come whole.
    fn cut(&mut self, at: usize, [body, answer]: [&str; 2], random: &mut ChaCha8Rng) -> bool {
        let mut bytes = framed(body).into_bytes();
        let place = random.random_range(0..bytes.len() + framed(answer).len());
        // The first byte of the line's end ends it.
        let is_whole = place + 1 >= bytes.len();
        bytes.truncate(place);
        if random.random_bool(0.5) {
            // A pulled plug looks like these bytes.
            bytes.extend([0x00, 0xff]);
        }
        self.sent.push(Sent {
            at,
            bytes,
            body: is_whole.then(|| body.to_owned()),
        });
        if is_whole {
            self.answers.push(answer.to_owned());
            self.taken += 1;
        }
        is_whole
    }

    /// Plans the cuts of a dialogue: `apart` notifications from one to the next, `step` within.
    fn of(dialogue: Dialogue<'_>, apart: usize, step: usize, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut script = Self::default();
        let [question, untouched, touched] = dialogue.probe;
        for number in 0..CUTS {
            let at = FIRST + number * apart;
            if let Some(before) = dialogue.before {
                script.ask(at, before);
            }
            let is_whole = script.cut(at + step, dialogue.cut, &mut random);
            let answer = if is_whole { touched } else { untouched };
            script.ask(at + 2 * step, [question, answer]);
            // A person who saw no answer gives the command again.
            script.ask(at + 3 * step, dialogue.cut);
            if let Some(after) = dialogue.after {
                script.ask(at + 4 * step, after);
            }
        }
        script
    }

    fn run(&self, samples: &[Sample], run_seconds: usize) -> anyhow::Result<Ran> {
        let mut text = format!("run_seconds = {run_seconds}\nend = \"disconnect\"\nperson = [\n");
        for Sent { at, bytes, .. } in &self.sent {
            let mut escaped = String::new();
            for byte in bytes {
                write!(escaped, "\\u{byte:04x}")?;
            }
            writeln!(
                text,
                "{{ do = \"send-bytes\", at = {at}, text = \"{escaped}\" }},"
            )?;
        }
        text += "]\n";
        let inputs = Inputs {
            scenario: &text,
            model: &model("three-class"),
            samples,
            page: &page(),
            install: None,
        };
        let ran = simulation::run(program(), &inputs)?;
        ran.check(false)?;
        self.check_answers(&ran).with_context(|| ran.tails())?;
        Ok(ran)
    }

    fn check_answers(&self, ran: &Ran) -> anyhow::Result<()> {
        let answers = ran.answers();
        for (place, (found, wanted)) in answers.iter().zip(&self.answers).enumerate() {
            let is_right = match wanted.strip_suffix('…') {
                Some(start) => found.starts_with(start),
                None => found == wanted,
            };
            ensure!(is_right, "answer {place} is {found}, not {wanted}");
        }
        ensure!(
            answers.len() == self.answers.len(),
            "{} answers",
            answers.len()
        );
        ensure!(
            (10..=CUTS - 10).contains(&self.taken),
            "{} of {CUTS} came whole",
            self.taken
        );
        Ok(())
    }
}

/// Returns a line with the right checksum.
fn framed(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n")
}

/// Returns the effect of a command on the labels.
fn effect(body: &str) -> Option<Input<'static>> {
    Some(match body {
        "ALIGN,begin" => Input::Align(Arm::Unknown),
        "ALIGN,cancel" => Input::CancelAlignment,
        "ALIGN,set,3,1" => Input::SetAlignment(Alignment::new(3, true)),
        "ALIGN,set,0,0" => Input::SetAlignment(Alignment::new(0, false)),
        "GATE,set,5000,50,-" => Input::SetGate(Gate {
            entry: Some(5000),
            other: Some(50),
            reaction: None,
        }),
        "GATE,set,-,-,-" => Input::SetGate(Gate::default()),
        _ => return None,
    })
}

/// Checks that every command that came whole changes the labels where it came, and that nothing else does.
fn check_lines(script: &Script, ran: &Ran, samples: &[Sample]) -> anyhow::Result<()> {
    let mut inputs = Vec::new();
    let mut from = 0;
    for Sent { at, body, .. } in &script.sent {
        if let Some(input) = body.as_deref().and_then(effect) {
            inputs.extend([Input::Samples(&samples[from..2 * at]), input]);
            from = 2 * at;
        }
    }
    inputs.extend([Input::Samples(&samples[from..]), Input::Disconnected]);
    same(
        &ran.lines(),
        &expected_lines(&model("three-class"), &inputs)?,
    )
}

fn same(found: &[String], expected: &[String]) -> anyhow::Result<()> {
    let differs = found.iter().zip(expected).position(|(one, two)| one != two);
    if let Some(place) = differs {
        anyhow::bail!("{}expected {}", found[place], expected[place]);
    }
    ensure!(
        found.len() == expected.len(),
        "{} lines, expected {}",
        found.len(),
        expected.len()
    );
    Ok(())
}

#[test]
fn a_command_is_taken_whole_or_not_at_all_and_the_next_one_is_answered_rightly() {
    const STATE: &str = "ALIGN,state";
    let identify = ["IDENTIFY", "OK,IDENTIFY,…"];
    let asked = |cut| Dialogue {
        before: None,
        cut,
        probe: [identify[0], identify[1], identify[1]],
        after: None,
    };
    let seed = cuts::seed();
    println!("MYOINTENT_SEED={seed}");
    let samples = samples(70);
    for dialogue in [
        asked(identify),
        asked(["COUNTERS", "OK,COUNTERS,1,…"]),
        asked(["ALIGN,state", "OK,ALIGN,state,0,0"]),
        asked(["GATE,state", "OK,GATE,-,-,-"]),
        asked(["BIND,state", "OK,BIND,bound,FA:12:34:56:78:9A,1"]),
        Dialogue {
            before: None,
            cut: ["ALIGN,set,3,1", "OK,ALIGN,set"],
            probe: [STATE, "OK,ALIGN,state,0,0", "OK,ALIGN,state,3,1"],
            after: Some(["ALIGN,set,0,0", "OK,ALIGN,set"]),
        },
        Dialogue {
            before: None,
            cut: ["ALIGN,begin", "OK,ALIGN,begin"],
            probe: [STATE, "OK,ALIGN,state,0,0", "OK,ALIGN,state,0,0"],
            after: Some(["ALIGN,cancel", "OK,ALIGN,cancel"]),
        },
        Dialogue {
            before: Some(["ALIGN,begin", "OK,ALIGN,begin"]),
            cut: ["ALIGN,cancel", "OK,ALIGN,cancel"],
            probe: [STATE, "OK,ALIGN,state,0,0", "OK,ALIGN,state,0,0"],
            after: None,
        },
        Dialogue {
            before: None,
            cut: ["GATE,set,5000,50,-", "OK,GATE,5000,50,-"],
            probe: ["GATE,state", "OK,GATE,-,-,-", "OK,GATE,5000,50,-"],
            after: Some(["GATE,set,-,-,-", "OK,GATE,-,-,-"]),
        },
    ] {
        let script = Script::of(dialogue, 60, 10, seed);
        let checked = script.run(&samples, 75).and_then(|ran| {
            check_lines(&script, &ran, &samples)?;
            let said = ran.comments();
            ensure!(said.len() == 5, "{said:#?}");
            Ok(())
        });
        checked.with_context(|| dialogue.cut[0].to_owned()).unwrap();
    }
}

#[test]
fn the_raw_stream_begins_and_ends_with_a_whole_command_alone() {
    let seed = cuts::seed();
    println!("MYOINTENT_SEED={seed}");
    let samples = samples(70);
    let counters = "OK,COUNTERS,1,…";
    for (cut, undo) in [("on", "off"), ("off", "on")] {
        let bodies = [cut, undo].map(|way| format!("RAW,{way}"));
        let answers = [cut, undo].map(|way| format!("OK,RAW,{way}"));
        let undo = [&bodies[1][..], &answers[1]];
        let dialogue = Dialogue {
            before: Some(undo),
            cut: [&bodies[0], &answers[0]],
            probe: ["COUNTERS", counters, counters],
            after: None,
        };
        let script = Script::of(dialogue, 60, 10, seed);
        let ran = script.run(&samples, 75).unwrap();
        check_lines(&script, &ran, &samples).unwrap();
        // Expected state of the raw stream after each packet; `None` at a command itself, where it may be either.
        let mut is_on = vec![Some(false); samples.len() / 2];
        for Sent { at, body, .. } in &script.sent {
            if let Some(way) = body.as_deref().and_then(|body| body.strip_prefix("RAW,")) {
                is_on[*at..].fill(Some(way == "on"));
                is_on[at - 1..=*at].fill(None);
            }
        }
        let mut found = vec![false; is_on.len()];
        for report in ran.emg().unwrap() {
            let first = report.first.0 as usize;
            assert_eq!(report.samples[..], samples[first..first + 2]);
            found[first / 2] = true;
        }
        for (packet, (found, expected)) in found.iter().zip(&is_on).enumerate() {
            assert!(
                expected.is_none_or(|expected| expected == *found),
                "packet {packet}"
            );
        }
    }
}

#[test]
fn an_armband_is_bound_and_forgotten_by_a_whole_command_alone() {
    let seed = cuts::seed();
    println!("MYOINTENT_SEED={seed}");
    // Cuts are 3.5 s of a stream apart: labels come in each.
    const APART: usize = 350;
    let samples = samples((FIRST + CUTS * APART) / 100 + 4);
    let set = format!("BIND,set,{ARMBAND}");
    let bound = format!("OK,BIND,bound,{ARMBAND},…");
    let state = "BIND,state";
    let nobody = "OK,BIND,nobody,-,…";
    for dialogue in [
        Dialogue {
            before: None,
            cut: ["BIND,forget", nobody],
            probe: [state, &bound, nobody],
            after: Some([&set, &bound]),
        },
        Dialogue {
            before: Some(["BIND,forget", nobody]),
            cut: [&set, &bound],
            probe: [state, nobody, &bound],
            after: None,
        },
        Dialogue {
            before: None,
            cut: ["BIND,begin", "OK,BIND,pairing,…"],
            probe: [state, &bound, "OK,BIND,pairing,…"],
            after: Some([&set, &bound]),
        },
    ] {
        // Everything is sent at once: without a stream no packets count the time.
        let script = Script::of(dialogue, APART, 0, seed);
        let ran = script
            .run(&samples, samples.len() / 200 + 3 * CUTS / 2)
            .unwrap();
        let mut inputs = vec![Input::Samples(&samples[..2 * FIRST])];
        for number in 0..CUTS {
            let at = FIRST + number * APART;
            let to = if number + 1 < CUTS {
                2 * (at + APART)
            } else {
                samples.len()
            };
            inputs.extend([Input::Disconnected, Input::Samples(&samples[2 * at..to])]);
        }
        inputs.push(Input::Disconnected);
        let expected = expected_lines(&model("three-class"), &inputs).unwrap();
        same(&ran.lines(), &expected)
            .with_context(|| dialogue.cut[0].to_owned())
            .unwrap();
        let reports = ran.reports().unwrap();
        let lost = reports
            .iter()
            .filter(|report| report.status.cause() == Some(Cause::Disconnected));
        assert_eq!(lost.count(), CUTS + 1);
        let follows = ran.comments();
        let follows = follows.iter().filter(|one| one.contains(": bound"));
        assert_eq!(follows.count(), CUTS + 1);
    }
}
