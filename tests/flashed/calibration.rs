//! A calibration by a wearer who follows the cues, in an image with a SoftDevice and in one without.

use std::iter::repeat_n;

use myointent_tests::chip::{self, Board, Setting};
use myointent_tests::output::BoardOutput;
use nrf52::time::ms;
use recordings::synthetic::Follower;
use shared::calibration::from_record;
use shared::intent::Intent;
use shared::model::file::Model;
use xtask::firmware::Image;

/// The calibration's page, as in `memory.x`.
const PAGE: u32 = 0x5_5000;

#[test]
fn what_a_wearer_shows_is_learnt_in_time_kept_and_used() {
    for built in [Image::Nrf52840S140, Image::Nrf52840Sdc] {
        let round = [Intent::Relax, Intent::Open, Intent::Relax, Intent::Close];
        let cues = round
            .iter()
            .chain(&round)
            .flat_map(|cue| repeat_n(*cue, 800));
        let cues = repeat_n(Intent::Relax, 700)
            .chain(cues)
            .chain(repeat_n(Intent::Relax, 2000));
        let mut person = Follower::new("s2");
        let file = chip::model();
        let samples = cues.map(|cue| person.sample(cue)).collect();
        let setting = Setting::of(file.clone(), samples);
        let Some(mut board) = Board::of(built, setting) else {
            return;
        };
        let streamed = board.until("stream", 10_000, ms(10), |board| board.sent() >= 340);
        streamed.unwrap();
        if built == Image::Nrf52840S140 {
            board.flash().needs_silence = true;
        }
        board.send("CALIBRATE,begin");
        board.wait_for("# calibration: done", 40_000).unwrap();
        board.wait_for("$LABEL", 10_000).unwrap();
        let page = board.memory().read(PAGE, 4096).unwrap();
        let mut words = [0_u32; 1024];
        bytemuck::cast_slice_mut(&mut words).copy_from_slice(&page);
        let kept = from_record(bytemuck::cast_slice(&words), &Model::parse(&file).unwrap());
        assert!(kept.is_ok(), "{kept:?}");
        let folder = tempfile::tempdir().unwrap();
        board.write_output(folder.path()).unwrap();
        let output = BoardOutput::new(folder.path());
        output.check(false).unwrap();
        let said = output.comments();
        assert!(
            !said.iter().any(|one| one.contains("too slow")),
            "{said:#?}"
        );
    }
}
