//! Pulses of the strength: those of the pipeline, and none in the safe state.

use nrf52::time::{HZ, us};
use shared::intent::Intent;
use shared::model::encoder::DeviceEncoder;
use shared::model::file::Model;
use shared::pipeline::Pipeline;
use shared::units::{Millis, SAMPLE_PERIOD_MS, Sample};
use xtask::firmware::Image;

use super::dead_man::model_of;
use super::faults::effort;
use myointent_tests::chip::{Board, Setting};
use myointent_tests::found;

/// Percents that the pipeline has while its label is valid, each as often in a row as it changes.
fn expected(model: &[u8], samples: &[Sample]) -> anyhow::Result<Vec<u64>> {
    let model = Model::parse(model)?;
    let encoder = DeviceEncoder::new(&model)?;
    let mut state = encoder.fresh();
    let mut pipeline = Pipeline::of_model(&model, encoder, &mut state)?;
    let mut now = Millis(0);
    let mut found = Vec::new();
    for packet in samples.chunks(2) {
        for &sample in packet {
            now = now.plus(SAMPLE_PERIOD_MS);
            pipeline.sample(now, sample);
        }
        if pipeline.status().valid() {
            found.push(u64::from(pipeline.strength().get()));
        }
    }
    found.dedup();
    Ok(found)
}

/// Microseconds for which the pin is high, in the period that is running.
fn high_us(board: &Board) -> Option<u64> {
    Some(board.machine.chip().pulse()? / us(1))
}

#[test]
fn pulses_are_the_strength_and_end_with_the_stream() -> anyhow::Result<()> {
    let model = model_of(Intent::Close)?;
    let samples = effort(8);
    let expected = expected(&model, &samples)?;
    assert!(expected.len() > 20, "{expected:?}");
    for built in [Image::Nrf52840S140, Image::Nrf52832S132] {
        let setting = Setting::of(model.clone(), samples.clone());
        let mut board = found!(Board::of(built, setting));
        let mut found = Vec::new();
        while board.sent() < samples.len() / 2 {
            anyhow::ensure!(board.machine.now() < 12 * HZ, "{}", board.text());
            assert!(board.is_valid() || board.machine.now() < 5 * HZ);
            board.machine.run(us(500))?;
            found.extend(high_us(&board));
        }
        found.dedup();
        let percents: Vec<u64> = found.iter().map(|high_us| high_us / 10).collect();
        // The newest packet may be on its way.
        let sure = expected.len() - 1;
        assert_eq!(percents.get(..sure), Some(&expected[..sure]), "{built}");
        // The armband is silent: the pin is low.
        board.run_ms(300)?;
        let level = board.machine.chip().level(board.pins.strength);
        assert_eq!((high_us(&board), level), (None, Some(false)), "{built}");
    }
    Ok(())
}
