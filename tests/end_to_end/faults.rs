//! Injected faults: the board enters the safe state and restarts.

use myointent_tests::emulator::{Fault, Run, Scenario, bench};
use myointent_tests::output::Pins;
use recordings::synthetic::Follower;
use serde_json::json;
use shared::intent::Intent;
use shared::stream::safe_state::Cause;
use shared::uart_line::Report;
use shared::units::Sample;

/// Factor by which the guest's clock runs slower than real time. It is smaller than elsewhere: these runs mostly wait
/// on that clock.
const TIME_SCALE: u32 = 3;
const PACE: f64 = 3.0;
/// End of the program's flash region.
const FLASH_END: u32 = 0x5_7000;
/// Microseconds at most from a fault to safe pins, without any help of the program.
const SAFE_WITHIN_US: u32 = 250_000;

/// Streams a synthetic signal until the board has restarted and receives a stream again.
///
/// The fault is injected after every start; the tests look at the first two only.
fn play(test: &str, fault: Fault) -> anyhow::Result<Option<Restarted>> {
    let Some(bench) = bench(test) else {
        return Ok(None);
    };
    // The samples suffice for a label, and then for the watchdog to expire. Labels change with any model: a hand rests,
    // and opens for 0.6 s out of 1.2 s.
    let mut person = Follower::new("anna");
    let samples: Vec<Sample> = (0..4000)
        .map(|n| match n / 120 % 2 {
            1 if n >= 600 => person.sample(Intent::Open),
            _ => person.sample(Intent::Relax),
        })
        .collect();
    let mut run = bench.start(&Scenario {
        model: &super::model(),
        page: Some(super::bound()),
        samples: &samples,
        time_scale: TIME_SCALE,
        pace: PACE,
        fault: Some(fault),
        script: json!([]),
        arguments: Vec::new(),
    })?;
    run.wait_for("a stream after the restart", |run| {
        pins(run)
            .get(1)
            .is_some_and(|pins| pins.iter().any(|pins| pins.armband))
    })?;
    run.check()?;
    Ok(Some(Restarted {
        pins: pins(&run),
        reports: run.reports_by_start()?,
        comments: run.comments(),
        faults_us: run.faults_us(),
        tails: run.tails(),
    }))
}

/// Returns the pins after each start, which sets the guest's clock to 0.
fn pins(run: &Run) -> Vec<Vec<Pins>> {
    let pins = run.pins();
    let starts = pins.chunk_by(|one, next| one.at_us <= next.at_us);
    starts.map(<[Pins]>::to_vec).collect()
}

/// Result of a run in which the board has restarted.
struct Restarted {
    /// Pins of each start.
    pins: Vec<Vec<Pins>>,
    /// Reports of each start.
    reports: Vec<Vec<Report>>,
    comments: Vec<String>,
    faults_us: Vec<u32>,
    tails: String,
}

impl Restarted {
    /// Checks that the second start reports its reason and its state, and that the pins are safe until the armband
    /// streams again.
    fn check_restart(&self, reason: &str, cause: Cause) {
        let tails = &self.tails;
        let starts = self
            .comments
            .iter()
            .filter_map(|c| c.split_once(", started by "));
        let starts: Vec<_> = starts.map(|(_, reason)| reason).take(2).collect();
        assert_eq!(starts, ["power or reset", reason], "{tails}");
        let first = self.reports[1][0];
        let first = (first.sequence, first.status.cause());
        assert_eq!(first, (0, Some(cause)), "{tails}");
        let pins = &self.pins[1];
        let streams = pins.iter().position(|pins| pins.armband).expect("a stream");
        assert!(
            streams > 0 && pins[..streams].iter().all(is_safe),
            "{tails}"
        );
    }

    /// Checks that the pins of the first run were valid when the fault was injected, safe in time after it, and stayed
    /// so.
    fn safe_in_time(&self) {
        let fault = self.faults_us[0];
        let before = self.pins[0].iter().rfind(|pins| pins.at_us <= fault);
        assert!(before.is_some_and(|pins| pins.valid), "{}", self.tails);
        let after = self.pins[0].iter().filter(|pins| pins.at_us > fault);
        let after: Vec<_> = after.skip_while(|pins| pins.valid).collect();
        let fell = after.first().map(|pins| pins.at_us - fault);
        assert!(
            fell.is_some_and(|after_us| after_us <= SAFE_WITHIN_US),
            "{fell:?} us after the fault\n{}",
            self.tails
        );
        assert!(after.into_iter().all(is_safe), "{}", self.tails);
    }

    /// Checks that the pins stayed valid until the restart, and did not hold an old label: they changed after the time
    /// within which the pins of a halted board fall.
    fn live_until_restart(&self) {
        let fault = self.faults_us[0];
        let pins = &self.pins[0];
        let last = pins.last().expect("pins");
        assert!(last.valid && last.armband, "{}", self.tails);
        let after = pins.iter().filter(|pins| pins.at_us > fault);
        assert!(after.clone().all(|pins| pins.valid), "{}", self.tails);
        let late = after.filter(|pins| pins.at_us - fault > SAFE_WITHIN_US);
        let changes = late.count();
        assert!(changes > 1, "{changes} changes\n{}", self.tails);
    }

    /// Checks that the first run of the program ended with a label cleared; returns the panic's message.
    fn panic_message(&self) -> &str {
        let [.., valid, last] = &self.pins[0][..] else {
            panic!("no pins\n{}", self.tails);
        };
        assert!(
            valid.valid && is_safe(last) && !last.armband,
            "{}",
            self.tails
        );
        let message = self
            .comments
            .iter()
            .find(|comment| comment.starts_with("# panicked: "));
        message.unwrap_or_else(|| panic!("no message\n{}", self.tails))
    }
}

fn is_safe(pins: &Pins) -> bool {
    !pins.valid && pins.high == [Intent::Relax]
}

#[test]
fn a_task_that_stops_is_ended_by_the_watchdog() -> anyhow::Result<()> {
    let test = "a_task_that_stops_is_ended_by_the_watchdog";
    let Some(run) = play(test, Fault::TaskStops)? else {
        return Ok(());
    };
    // The pins do not wait for the line: only the reset clears the label, and until then it follows the muscle.
    run.live_until_restart();
    assert!(
        !run.comments
            .iter()
            .any(|comment| comment.contains("panicked"))
    );
    run.check_restart("the watchdog", Cause::Watchdog);
    Ok(())
}

#[test]
fn a_panic_clears_the_label_writes_its_message_and_restarts() -> anyhow::Result<()> {
    let test = "a_panic_clears_the_label_writes_its_message_and_restarts";
    let Some(run) = play(test, Fault::Panic)? else {
        return Ok(());
    };
    let message = run.panic_message();
    assert!(
        message.starts_with("# panicked: injected panic, "),
        "{message}"
    );
    run.check_restart("software", Cause::Boot);
    Ok(())
}

#[test]
fn a_hard_fault_is_a_panic_with_its_address() -> anyhow::Result<()> {
    let test = "a_hard_fault_is_a_panic_with_its_address";
    let Some(run) = play(test, Fault::HardFault)? else {
        return Ok(());
    };
    let message = run.panic_message();
    let address = message
        .split_once("hard fault at 0x")
        .and_then(|(_, rest)| rest.split(',').next());
    let address = address.and_then(|hex| u32::from_str_radix(hex, 16).ok());
    assert!(
        address.is_some_and(|at| (1..FLASH_END).contains(&at)),
        "{message}"
    );
    run.check_restart("software", Cause::Boot);
    Ok(())
}

#[test]
fn a_stuck_executor_is_safe_within_250_ms_and_ended_by_the_watchdog() -> anyhow::Result<()> {
    let test = "a_stuck_executor_is_safe_within_250_ms_and_ended_by_the_watchdog";
    let Some(run) = play(test, Fault::ExecutorStops)? else {
        return Ok(());
    };
    run.safe_in_time();
    run.check_restart("the watchdog", Cause::Watchdog);
    Ok(())
}

#[test]
fn a_stack_overflow_clears_the_label_and_restarts_with_its_own_cause() -> anyhow::Result<()> {
    let test = "a_stack_overflow_clears_the_label_and_restarts_with_its_own_cause";
    let Some(run) = play(test, Fault::Recursion)? else {
        return Ok(());
    };
    run.safe_in_time();
    let message = run.comments.iter().any(|c| c == "# stack overflow");
    assert!(message, "{}", run.tails);
    let restarted = run
        .comments
        .iter()
        .any(|c| c.ends_with(", started by a stack overflow"));
    assert!(restarted, "{}", run.tails);
    run.check_restart("a stack overflow", Cause::StackOverflow);
    Ok(())
}

#[test]
fn an_inference_in_a_loop_is_safe_within_250_ms_and_ended_by_the_watchdog() -> anyhow::Result<()> {
    let test = "an_inference_in_a_loop_is_safe_within_250_ms_and_ended_by_the_watchdog";
    let Some(run) = play(test, Fault::InferenceLoops)? else {
        return Ok(());
    };
    run.safe_in_time();
    run.check_restart("the watchdog", Cause::Watchdog);
    Ok(())
}

#[test]
fn an_interrupt_storm_is_safe_within_250_ms_and_ended_by_the_watchdog() -> anyhow::Result<()> {
    let test = "an_interrupt_storm_is_safe_within_250_ms_and_ended_by_the_watchdog";
    let Some(run) = play(test, Fault::InterruptStorm)? else {
        return Ok(());
    };
    run.safe_in_time();
    run.check_restart("the watchdog", Cause::Watchdog);
    Ok(())
}

#[test]
fn a_stream_that_comes_and_is_not_taken_is_ended_by_the_watchdog() -> anyhow::Result<()> {
    let test = "a_stream_that_comes_and_is_not_taken_is_ended_by_the_watchdog";
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    // Every notification from the 400th on is a PDU that the Bluetooth stack discards.
    let script: Vec<_> = (400..6000)
        .map(|at| json!({"do": "corrupt", "at": at, "kind": "garbage"}))
        .collect();
    let mut run = bench.start(&Scenario {
        model: &super::model(),
        page: Some(super::bound()),
        samples: &vec![[1; 8]; 12_000],
        time_scale: TIME_SCALE,
        pace: 1.0,
        fault: None,
        script: script.into(),
        arguments: Vec::new(),
    })?;
    run.expect_restart();
    run.wait_for("a restart", |run| {
        let starts = run.reports_by_start();
        starts.is_ok_and(|starts| starts.len() > 1 && !starts[1].is_empty())
    })?;
    run.check()?;
    let starts = run.reports_by_start()?;
    let last = starts[0].last().expect("reports");
    assert!(!last.status.valid(), "{}", run.tails());
    let restarted = starts[1][0].status.cause();
    assert_eq!(restarted, Some(Cause::Watchdog), "{}", run.tails());
    Ok(())
}

/// Streams with such a packet in the place of every 27th notification: each leaves a gap that is bridged.
fn play_with(test: &str, kind: &str) -> anyhow::Result<()> {
    const PACKETS: u32 = 28;
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    let script: Vec<_> = (0..PACKETS)
        .map(|number| json!({"do": "corrupt", "at": 400 + 27 * number, "kind": kind}))
        .collect();
    let samples = vec![[1; 8]; 2600];
    let model = super::model();
    let mut run = super::play(&bench, &model, &samples, super::TIME_SCALE, script.into())?;
    run.wait_for("the end", |run| {
        let last = run
            .reports()
            .ok()
            .and_then(|reports| reports.last().copied());
        last.and_then(|report| report.status.cause()) == Some(Cause::Disconnected)
    })?;
    // The check includes that the board did not restart.
    run.check()?;
    let lost = run.reports()?.last().map(|report| report.counters.lost);
    // A busy host may lose more.
    assert!(lost >= Some(2 * PACKETS), "{lost:?}: {}", run.tails());
    Ok(())
}

#[test]
fn attribute_pdus_that_end_too_early_do_not_restart_the_board() -> anyhow::Result<()> {
    play_with(
        "attribute_pdus_that_end_too_early_do_not_restart_the_board",
        "cut",
    )
}

#[test]
fn the_end_of_a_channel_that_nobody_opened_does_not_restart_the_board() -> anyhow::Result<()> {
    let test = "the_end_of_a_channel_that_nobody_opened_does_not_restart_the_board";
    play_with(test, "signal")
}

#[test]
fn a_clock_that_stops_is_ended_by_the_watchdog() -> anyhow::Result<()> {
    let test = "a_clock_that_stops_is_ended_by_the_watchdog";
    let Some(run) = play(test, Fault::ClockStops)? else {
        return Ok(());
    };
    // Packets are processed by their own interrupts, and so labels and the dead-man timer, which is another timer, go
    // on.
    run.live_until_restart();
    let label = run.reports[0].last().expect("reports").status.label();
    let last = run.pins[0].last().expect("pins");
    assert_eq!(last.high, [label], "{}", run.tails);
    run.check_restart("the watchdog", Cause::Watchdog);
    Ok(())
}

#[test]
fn a_radio_that_stops_is_safe_and_ended_by_the_watchdog_after_a_minute() -> anyhow::Result<()> {
    let test = "a_radio_that_stops_is_safe_and_ended_by_the_watchdog_after_a_minute";
    let Some(bench) = bench(test) else {
        return Ok(());
    };
    // The minute is the guest's, at real time.
    let mut run = bench.start(&Scenario {
        model: &super::model(),
        page: Some(super::bound()),
        samples: &vec![[1; 8]; 4000],
        time_scale: 1,
        pace: 1.0,
        fault: Some(Fault::RadioStops),
        script: json!([]),
        arguments: Vec::new(),
    })?;
    run.wait_for("the fault", |run| !run.faults_us().is_empty())?;
    run.wait_for("a restart", |run| {
        run.comments()
            .iter()
            .any(|comment| comment.ends_with("started by the watchdog"))
    })?;
    let fault = run.faults_us()[0];
    let after = pins(&run)[0].clone();
    let after: Vec<_> = after.iter().filter(|pins| pins.at_us > fault).collect();
    let fell = after
        .iter()
        .find(|pins| !pins.valid)
        .map(|pins| pins.at_us - fault);
    assert!(
        fell.is_some_and(|after_us| after_us <= SAFE_WITHIN_US),
        "{fell:?} us after the fault\n{}",
        run.tails()
    );
    let stays = after.iter().skip_while(|pins| pins.valid);
    assert!(stays.clone().count() > 0 && stays.into_iter().all(|pins| is_safe(pins)));
    Ok(())
}
