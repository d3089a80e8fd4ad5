//! Damaged model: the device stays in the safe state, and the UART says why.

use myointent_tests::emulator::{board, damages};
use shared::stream::safe_state::Cause;

#[test]
fn every_damage_to_the_model_is_refused_with_its_reason() -> anyhow::Result<()> {
    let test = "every_damage_to_the_model_is_refused_with_its_reason";
    let Some(board) = board(test) else {
        return Ok(());
    };
    let damages = damages(&super::model());
    assert!(damages.len() >= 6);
    for damage in &damages {
        let reason = damage.reason().expect("damage is refused on the PC too");
        let mut run = board.start_without_armband(&damage.bytes)?;
        run.wait_for(&format!("the reason of {}: {reason}", damage.name), |run| {
            run.comments()
                .iter()
                .any(|comment| comment.contains(&reason))
        })?;
        run.wait_for("the state", |run| {
            let reports = run.reports().unwrap_or_default();
            let last = reports.last().and_then(|report| report.status.cause());
            last == Some(Cause::ModelRefused)
        })?;
        run.wait_for("the pins", |run| !run.pins().is_empty())?;
        assert!(run.pins().iter().all(|pins| !pins.valid), "{}", run.tails());
        run.check()?;
    }
    Ok(())
}

#[test]
fn the_first_line_names_version_revision_image_and_model() -> anyhow::Result<()> {
    let test = "the_first_line_names_version_revision_image_and_model";
    let Some(board) = board(test) else {
        return Ok(());
    };
    let model = super::model();
    let checksum = model.last_chunk::<4>().expect("a checksum");
    let checksum = u32::from_le_bytes(*checksum);
    let mut run = board.start_without_armband(&model)?;
    run.wait_for("the first line", |run| !run.comments().is_empty())?;
    let line = run.comments().remove(0);
    let words: Vec<&str> = line.split([' ', ',']).collect();
    let version = env!("CARGO_PKG_VERSION");
    assert_eq!(words[..3], ["#", "myointent", version], "{line}");
    let revision = words[3].trim_end_matches("-dirty");
    assert!(
        revision == "unknown"
            || revision.len() >= 12 && revision.chars().all(|c| c.is_ascii_hexdigit()),
        "{line}"
    );
    let rest = format!(", image emulator, model {checksum:08x}, started by power or reset");
    assert!(line.ends_with(&rest), "{line}");
    Ok(())
}
