//! `myointent board install` over a pseudo-terminal, which is pulled meanwhile.

use std::sync::{Arc, Mutex};

use myointent::board::{BoardError, ModelFile, install};
use shared::installation::InstallationProgress;
use shared::uart_line::answer::{Answer, Refusal};
use shared::uart_line::command::Command;

use super::scripted::{Scripted, identity};
use super::shipped;

#[test]
fn a_model_is_installed_over_a_line_that_is_pulled_and_one_in_use_is_not_sent() {
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let model = shipped();
    let file = ModelFile::new(&model).unwrap();
    // The block that the board wants; none once it has all. The first page is sent last, but for its first block.
    let wanted = Arc::new(Mutex::new(Some(0)));
    let start = || {
        let (wanted, blocks, checksum) = (wanted.clone(), file.blocks(), file.checksum());
        Scripted::start(&link, move |command| {
            let wanted = &mut *wanted.lock().unwrap();
            if let Command::Block(number, _) = command {
                *wanted = match number + 1 {
                    1 => Some(64),
                    64 => None,
                    next if next == blocks => Some(1),
                    next => Some(next),
                };
            }
            let installed = InstallationProgress::Installed;
            let answer = match command {
                Command::Identify => identity(if wanted.is_none() { checksum } else { 7 }),
                Command::Install(_) | Command::Block(..) => {
                    Answer::Install(wanted.map_or(installed, InstallationProgress::Next))
                }
                _ => Answer::Refused(Refusal::Unknown),
            };
            answer.to_string()
        })
    };
    let mut board = Some(start());
    let mut pulled_at = None;
    let report = |blocks| {
        if blocks > 500 && pulled_at.is_none() {
            pulled_at = Some(blocks);
            board = None;
            board = Some(start());
        }
    };
    install(&link, file, || false, report).unwrap();
    assert!(pulled_at.is_some());
    let mut reports = Vec::new();
    install(&link, file, || false, |blocks| reports.push(blocks)).unwrap();
    assert_eq!(reports, [file.blocks()]);
    drop(board);
    let missing = install("/no/such/port".as_ref(), file, || false, |_| {});
    assert!(matches!(missing, Err(BoardError::Open { .. })));
}
