//! Calibration on the simulated board: a wearer who follows the cues, losses, loss of power at every operation of flash.

use std::fmt::Write as _;
use std::iter::repeat_n;

use myointent::cli::replay::calibrated_lines;
use myointent_tests::model_file;
use myointent_tests::output::is_numbered;
use myointent_tests::simulation::{self, Inputs, Ran};
use recordings::synthetic::Follower;
use shared::calibration::from_record;
use shared::intent::Intent;
use shared::model::file::Model;
use shared::stream::alignment::Alignment;
use shared::uart_line::{Report, ReportKind};
use shared::units::Sample;

use super::page;

/// Notifications before the command.
const AT: usize = 400;
/// Samples of a cue: 1 s of reaction, 3 s that count.
const CUE: usize = 800;
const RUN_SECONDS: usize = 48;
const BEGUN: &str = "OK,CALIBRATE,teaching,relax,-,-,0";
const DONE: &str = "# calibration: done, recall ";

const ROUND: [Intent; 4] = [Intent::Relax, Intent::Open, Intent::Relax, Intent::Close];

/// Samples of a wearer who does what each cue of so many rounds asks for, the first after four seconds, and then rests; and the cues.
fn following(rounds: usize, after: usize) -> impl Iterator<Item = (Sample, Intent)> {
    let cues = ROUND.repeat(rounds).into_iter();
    let cues = cues.flat_map(|cue| repeat_n(cue, CUE));
    let resting = |samples| repeat_n(Intent::Relax, samples);
    let cues = resting(2 * AT).chain(cues).chain(resting(after));
    let mut person = Follower::new("s2");
    cues.map(move |cue| (person.sample(cue), cue))
}

/// Samples of a wearer who does what each cue of both rounds asks for, in a stream of a minute.
fn samples() -> Vec<Sample> {
    following(2, 4400).map(|(sample, _)| sample).collect()
}

struct Bench {
    model: Vec<u8>,
    samples: Vec<Sample>,
}

impl Bench {
    fn new() -> Self {
        Self {
            model: model_file("three-class"),
            samples: samples(),
        }
    }

    /// Runs commands, after so many notifications each, on a board whose page holds this.
    fn run(
        &self,
        page_before: &[u8],
        keys: &str,
        commands: &[(usize, &str)],
    ) -> anyhow::Result<Ran> {
        let mut text = format!("run_seconds = {RUN_SECONDS}\n{keys}\nperson = [\n");
        for (at, command) in commands {
            writeln!(
                text,
                "{{ do = \"send\", at = {at}, command = \"{command}\" }},"
            )?;
        }
        text += "]\n";
        let inputs = Inputs {
            scenario: &text,
            model: &self.model,
            samples: &self.samples,
            page: &page(),
            calibration: page_before,
            install: None,
        };
        simulation::run(&inputs)
    }

    fn calibrate(&self, keys: &str) -> Ran {
        let ran = self.run(
            &[],
            keys,
            &[(AT, "CALIBRATE,begin"), (4300, "CALIBRATE,state")],
        );
        let ran = ran.unwrap();
        ran.check(false).unwrap();
        ran
    }

    /// Whether a page holds a whole record for the model.
    fn is_kept(&self, page: &[u8]) -> bool {
        // At a multiple of four bytes.
        let mut words = vec![0_u32; page.len().div_ceil(4)];
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut words);
        bytes[..page.len()].copy_from_slice(page);
        from_record(bytes, &Model::parse(&self.model).unwrap()).is_ok()
    }
}

/// Causes of the safe state, `valid` where there is none.
fn states(ran: &Ran) -> Vec<&'static str> {
    let reports = ran.reports().unwrap();
    let states = reports.iter().map(|report| report.status.cause());
    let mut states: Vec<_> = states
        .map(|cause| cause.map_or("valid", |cause| cause.name()))
        .collect();
    states.dedup();
    states
}

fn said(ran: &Ran) -> Vec<String> {
    let comments = ran.comments().into_iter();
    comments
        .filter(|comment| comment.contains("calibration"))
        .collect()
}

#[test]
fn who_follows_the_cues_gets_a_head_that_is_kept_and_no_label_is_valid_meanwhile() {
    let bench = Bench::new();
    let ran = bench.calibrate("");
    let said = said(&ran);
    let cues = ["relax", "open", "relax", "close"];
    let cues = ["teaching", "judging"]
        .map(|round| cues.map(|cue| format!("# calibration: {round}, {cue}")));
    assert_eq!(said[..8], cues.concat());
    assert!(
        said[8].starts_with("# calibration: keeping, recall "),
        "{said:#?}"
    );
    assert!(said[9].starts_with(DONE) && said.len() == 10, "{said:#?}");
    let answers = ran.answers();
    assert_eq!(answers[0], BEGUN);
    let done = answers[1].strip_prefix("OK,CALIBRATE,done,-,").unwrap();
    let recalls: Vec<u32> = done.split(',').map(|one| one.parse().unwrap()).collect();
    assert!(
        recalls[1] >= 850 && recalls[1] + 50 >= recalls[0] && recalls[2] == 1,
        "{answers:#?}"
    );
    assert_eq!(states(&ran), ["boot", "valid", "installation", "valid"]);
    assert!(bench.is_kept(&ran.calibration));
    // The LED is dark for rest and lit for each of four gestures, 4 s each; then it blinks for 3 s: success.
    let mut pins = ran.pins();
    pins.dedup_by_key(|pins| pins.alignment_led);
    let lit = pins.windows(2).filter(|pins| pins[0].alignment_led);
    let lit: Vec<_> = lit
        .map(|pins| (pins[1].at_us - pins[0].at_us) / 100_000)
        .collect();
    let (held, blinks) = lit.split_at(4);
    assert!(held.iter().all(|one| (40..=43).contains(one)), "{lit:?}");
    assert!(
        blinks.iter().all(|one| *one <= 3) && (5..=7).contains(&blinks.len()),
        "{lit:?}"
    );
    // Each start uses it, and forgets it when asked.
    let asked = [
        (AT, "CALIBRATE,state"),
        (AT + 50, "CALIBRATE,forget"),
        (AT + 300, "CALIBRATE,state"),
    ];
    let again = bench.run(&ran.calibration, "", &asked).unwrap();
    again.check(false).unwrap();
    let expected = ["idle,-,-,-,1", "keeping,-,-,-,1", "idle,-,-,-,0"];
    assert_eq!(
        again.answers(),
        expected.map(|one| format!("OK,CALIBRATE,{one}"))
    );
    assert_eq!(states(&again), ["boot", "valid", "installation", "valid"]);
    assert_eq!(again.calibration, [0xff; 4096]);
    // Another model does not.
    let other = Bench {
        model: model_file("five-class"),
        samples: samples(),
    };
    let other = other
        .run(&ran.calibration, "", &[(AT, "CALIBRATE,state")])
        .unwrap();
    assert_eq!(other.answers(), ["OK,CALIBRATE,idle,-,-,-,0"]);
    let comments = other.comments();
    let refusals = comments
        .iter()
        .filter(|one| one.starts_with("# the calibration is of model "));
    assert_eq!(refusals.count(), 1);
}

#[test]
fn replay_writes_what_the_board_writes_in_a_calibration_and_after_it() {
    let bench = Bench::new();
    let ran = bench.calibrate("");
    let reports = ran.reports().unwrap();
    let mut begun = reports.iter().filter(|report| {
        let cause = report.status.cause();
        cause.is_some_and(|cause| cause.name() == "installation")
    });
    // Samples that the board had when it was asked.
    let at = begun.next().unwrap().emitted.0 + 1;
    let lines = calibrated_lines(&bench.model, &bench.samples, at.into()).unwrap();
    let of_wearer = |line: &&str| is_numbered(line) || line.starts_with("# calibration: ");
    let expected: Vec<&str> = lines.split_inclusive('\n').collect();
    let text = std::fs::read_to_string(ran.lines_file()).unwrap();
    let found: Vec<&str> = text.split_inclusive('\n').filter(of_wearer).collect();
    let done = found
        .iter()
        .position(|line| line.starts_with(DONE))
        .unwrap();
    assert!(found.len() > done + 50, "{}", ran.tails());
    assert_eq!(found, expected[..found.len()]);
}

#[test]
fn an_armband_that_is_turned_or_on_the_other_arm_ends_calibrated_like_any_other() {
    let model = model_file("three-class");
    let (samples, cues): (Vec<_>, Vec<_>) = following(4, 0).unzip();
    // Thousandths of the labels after it that are as asked.
    let right = |placed: Alignment| {
        let worn = samples.iter().map(|own| placed.inverse().apply(*own));
        let worn: Vec<Sample> = worn.collect();
        let lines = calibrated_lines(&model, &worn, 2 * AT as u64).unwrap();
        let (_, after) = lines.split_once(DONE).expect(&lines);
        let labels = after.split_inclusive("\r\n").filter_map(|line| {
            let report = Report::parse(line.as_bytes()).ok()?;
            (report.kind == ReportKind::Label).then_some(report)
        });
        let right = labels.map(|own| own.status.label() == cues[own.instant.0 as usize]);
        let right: Vec<bool> = right.collect();
        assert!(right.len() > 250, "{lines}");
        1000 * right.iter().filter(|one| **one).count() / right.len()
    };
    let as_in_training = right(Alignment::NONE);
    for placed in Alignment::all() {
        let found = right(placed);
        assert!(
            found + 50 >= as_in_training,
            "{found} {as_in_training} {placed:?}"
        );
    }
}

#[test]
fn a_calibration_that_ends_without_a_head_leaves_the_alignment_as_it_was() {
    let placed = Alignment::new(3, true);
    let turned = samples().into_iter();
    let bench = Bench {
        samples: turned.map(|own| placed.inverse().apply(own)).collect(),
        ..Bench::new()
    };
    // In the first closing: the opening has aligned the armband.
    let at = AT + 7 * CUE / 4;
    let commands = [
        (AT, "CALIBRATE,begin"),
        (at, "ALIGN,state"),
        (at + 1, "CALIBRATE,cancel"),
        (at + 200, "ALIGN,state"),
    ];
    let ran = bench.run(&[], "", &commands).unwrap();
    ran.check(false).unwrap();
    let answers = ran.answers();
    assert!(answers[1].ends_with(",1"), "not aligned: {answers:?}");
    let expected = ["OK,CALIBRATE,cancelled,close,-,-,0", "OK,ALIGN,state,0,0"];
    assert_eq!(answers[2..], expected);
}

#[test]
fn an_armband_that_comes_late_is_waited_for_by_the_wearer_and_its_first_window_by_the_board() {
    let bench = Bench::new();
    // At the first notification there is no window: cues begin with it.
    let commands = [
        (0, "CALIBRATE,begin"),
        (1, "CALIBRATE,begin"),
        (299, "CALIBRATE,state"),
        (500, "CALIBRATE,cancel"),
    ];
    let ran = bench.run(&[], "", &commands).unwrap();
    ran.check(false).unwrap();
    let expected = [
        "ERR,no-stream",
        BEGUN,
        BEGUN,
        "OK,CALIBRATE,cancelled,relax,-,-,0",
    ];
    assert_eq!(ran.answers(), expected);
    assert_eq!(states(&ran), ["boot", "installation", "valid"]);
}

#[test]
fn flash_that_refuses_the_record_leaves_the_models_own_head_in_use() {
    let bench = Bench::new();
    let ran = bench.calibrate("page_fails = true");
    let answers = ran.answers();
    assert!(
        answers[1].starts_with("OK,CALIBRATE,not-kept,-,") && answers[1].ends_with(",0"),
        "{answers:#?}"
    );
    assert_eq!(states(&ran), ["boot", "valid", "installation", "valid"]);
}

#[test]
fn power_that_fails_at_any_operation_of_flash_leaves_the_old_record_the_new_one_or_none() {
    let bench = Bench::new();
    let whole = bench.calibrate("");
    let mut before = whole.calibration.clone();
    let length = before.iter().rposition(|byte| *byte != 0xff).unwrap() + 1;
    before.truncate(length.next_multiple_of(4));
    // The page is erased, and written in blocks of 64 bytes.
    let last = 1 + length.div_ceil(64);
    for (operation, done) in [
        (1, 0),
        (1, 50),
        (1, 100),
        (2, 50),
        (last / 2, 100),
        (last, 50),
        (last, 100),
    ] {
        let keys = format!("power_fails_at = [{operation}]\npower_fails_done = [{done}]");
        let commands = [(AT, "CALIBRATE,begin"), (4350, "CALIBRATE,state")];
        let ran = bench.run(&before, &keys, &commands).unwrap();
        ran.check(true).unwrap();
        let tails = ran.tails();
        assert_eq!(ran.starts().unwrap().len(), 2, "{tails}");
        let is_kept = bench.is_kept(&ran.calibration);
        let is_whole = matches!((operation, done), (1, 0)) || (operation, done) == (last, 100);
        assert_eq!(is_kept, is_whole, "{tails}");
        let answer = ran.answers().pop().unwrap();
        assert_eq!(
            answer,
            format!("OK,CALIBRATE,idle,-,-,-,{}", u8::from(is_kept))
        );
        let is_damaged = ran.calibration.iter().any(|byte| *byte != 0xff) && !is_kept;
        let damaged = ran
            .comments()
            .into_iter()
            .filter(|one| one.contains("calibration is damaged"));
        // Half an erasure takes the record's start.
        assert!(damaged.count() <= usize::from(is_damaged), "{tails}");
        assert!(states(&ran).ends_with(&["valid"]), "{tails}");
    }
}
