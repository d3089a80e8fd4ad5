//! The board goes wrong by itself, takes its outputs back, and starts anew.

use myointent_tests::emulator::{Fault, Pins, Run, Scene, bench};
use serde_json::json;
use shared::intent::Intent;
use shared::stream::safe_state::Cause;
use shared::uart_line::Report;
use shared::units::Sample;

/// Where the guest mostly waits for its own time to pass.
const TIME_SCALE: u32 = 3;
const PACE: f64 = 3.0;
/// End of the flash that programs lie in.
const FLASH_END: u32 = 0x5_8000;

/// Plays a made-up signal until the board has started anew and follows the armband again.
///
/// The fault strikes in every life; what is looked at ends with the stream of the second.
fn play(test: &str, fault: Fault) -> anyhow::Result<Option<Lives>> {
    let Some(bench) = bench(test) else {
        return Ok(None);
    };
    // As much as makes a label, and then enough for the watchdog to run out.
    let samples: Vec<Sample> = (0..4000_i32)
        .map(|n| [(n % 251 * n % 251 - 125) as i8; 8])
        .collect();
    let mut run = bench.start(&Scene {
        model: &super::model(),
        samples: &samples,
        time_scale: TIME_SCALE,
        pace: PACE,
        fault: Some(fault),
        script: json!([]),
        arguments: Vec::new(),
    })?;
    run.wait_for("the armband to be followed again", |run| {
        pins(run)
            .get(1)
            .is_some_and(|life| life.iter().any(|pins| pins.armband))
    })?;
    run.check()?;
    Ok(Some(Lives {
        pins: pins(&run),
        reports: run.lives()?,
        remarks: run.remarks(),
        tails: run.tails(),
    }))
}

/// What the pins showed in each life: with it the guest's clock begins anew.
fn pins(run: &Run) -> Vec<Vec<Pins>> {
    let pins = run.pins();
    let lives = pins.chunk_by(|one, next| one.at_us <= next.at_us);
    lives.map(<[Pins]>::to_vec).collect()
}

struct Lives {
    pins: Vec<Vec<Pins>>,
    reports: Vec<Vec<Report>>,
    remarks: Vec<String>,
    tails: String,
}

impl Lives {
    /// The second life tells why it began, and with which state; its pins are safe until the
    /// armband is followed again.
    fn begin_anew(&self, reason: &str, cause: Cause) {
        let tails = &self.tails;
        let starts = self
            .remarks
            .iter()
            .filter_map(|r| r.split_once(", started by "));
        let starts: Vec<_> = starts.map(|(_, reason)| reason).take(2).collect();
        assert_eq!(starts, ["power or reset", reason], "{tails}");
        let first = self.reports[1][0];
        let begun = (first.sequence, first.status.cause());
        assert_eq!(begun, (0, Some(cause)), "{tails}");
        let pins = &self.pins[1];
        let followed = pins.iter().position(|pins| pins.armband).expect("a stream");
        assert!(
            followed > 0 && pins[..followed].iter().all(is_safe),
            "{tails}"
        );
    }

    /// The first life ended with a label taken back; gives what was said of it.
    fn panicked(&self) -> &str {
        let [.., valid, last] = &self.pins[0][..] else {
            panic!("nothing was shown\n{}", self.tails);
        };
        assert!(
            valid.valid && is_safe(last) && !last.armband,
            "{}",
            self.tails
        );
        let said = self
            .remarks
            .iter()
            .find(|remark| remark.starts_with("# panicked at "));
        said.unwrap_or_else(|| panic!("nothing was said\n{}", self.tails))
    }
}

fn is_safe(pins: &Pins) -> bool {
    !pins.valid && pins.high == [Intent::Relax]
}

#[test]
fn a_task_that_stops_is_ended_by_the_watchdog() -> anyhow::Result<()> {
    let test = "a_task_that_stops_is_ended_by_the_watchdog";
    let Some(lives) = play(test, Fault::TaskStops)? else {
        return Ok(());
    };
    // Nothing but the reset takes the label back.
    let last = lives.pins[0].last().expect("pins");
    assert!(last.valid && last.armband, "{}", lives.tails);
    assert!(
        !lives
            .remarks
            .iter()
            .any(|remark| remark.contains("panicked"))
    );
    lives.begin_anew("the watchdog", Cause::Watchdog);
    Ok(())
}

#[test]
fn a_panic_takes_the_label_back_says_why_and_starts_anew() -> anyhow::Result<()> {
    let test = "a_panic_takes_the_label_back_says_why_and_starts_anew";
    let Some(lives) = play(test, Fault::Panic)? else {
        return Ok(());
    };
    let said = lives.panicked();
    assert!(said.ends_with(": a panic on demand"), "{said}");
    lives.begin_anew("software", Cause::Boot);
    Ok(())
}

#[test]
fn a_hard_fault_is_a_panic_that_tells_its_address() -> anyhow::Result<()> {
    let test = "a_hard_fault_is_a_panic_that_tells_its_address";
    let Some(lives) = play(test, Fault::HardFault)? else {
        return Ok(());
    };
    let said = lives.panicked();
    let address = said
        .split_once("hard fault at 0x")
        .map(|(_, address)| address);
    let address = address.and_then(|hex| u32::from_str_radix(hex, 16).ok());
    assert!(
        address.is_some_and(|at| (1..FLASH_END).contains(&at)),
        "{said}"
    );
    lives.begin_anew("software", Cause::Boot);
    Ok(())
}
