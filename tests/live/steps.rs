//! Steps of the page of `record`, by keys alone: an unbound board is bound from the page, and a step may be left out.

use myointent::live::Source;

use super::board::Board;
use super::browser::FITS;
use super::record::{SHORT, is_seen, pictures, record, step};

#[test]
fn a_new_board_is_bound_from_the_page_and_the_steps_lead_to_the_recording() {
    let mut browser = start!();
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let board = Board::unbound(&link);
    let live = record(folder.path(), Source::Port(link), SHORT, 1);
    browser.look(1440, 900, "light", "reduce");
    browser.open(live.url());

    // The board follows no armband: binding is the step now, and nothing can be recorded.
    browser.wait_for(&step("bind", "now"));
    browser.wait_for(&is_seen("bind"));
    assert!(browser.is(&step("connect", "done")));
    for next in ["align", "record", "tune", "compare", "install"] {
        assert!(browser.is(&step(next, "next")), "{next}");
    }
    let now = "document.querySelector('[aria-current=step]').id";
    assert_eq!(browser.value(now), "step-bind");
    assert!(!browser.is(&is_seen("begin")));
    assert!(browser.text("setup-hint").contains("follows none yet"));
    browser.screenshot(&pictures().join("steps-bind.png"));

    // The page says that a pairing heard no armband.
    browser.press("b");
    let listening = "$setup-task.textContent.startsWith('Listening')";
    browser.wait_for(listening);
    browser.wait_for("$setup-hint.textContent.startsWith('No armband was heard')");
    browser.press("b");
    browser.wait_for(listening);
    browser.wait_for(&step("bind", "done"));
    assert!(browser.text("step-bind").contains("FA:12:34:56:78:9A"));

    // The board streams, and may be aligned; a user who knows how the armband sits need not align it.
    browser.wait_for(&step("align", "now"));
    browser.wait_for(&is_seen("align-now"));
    browser.screenshot(&pictures().join("steps-align.png"));
    browser.look(390, 844, "dark", "reduce");
    assert!(browser.is(FITS), "wider than the window");
    browser.screenshot(&pictures().join("steps-phone.png"));
    browser.look(1440, 900, "light", "reduce");
    browser.press("a");
    let waiting = "$setup-task.textContent.startsWith('Open the')";
    browser.wait_for(waiting);
    // The hand rests: the page says that the alignment failed, and it may be begun again.
    browser.wait_for("$setup-hint.textContent.startsWith('Not aligned: no two openings')");
    assert!(browser.is(&step("align", "now")));
    browser.press("a");
    browser.wait_for(waiting);
    browser.press("k");
    browser.wait_for(&step("align", "done"));
    browser.wait_for(&step("record", "now"));
    // A step that was left out stays left out when the page is loaded again.
    browser.open(live.url());
    browser.wait_for(&step("align", "done"));
    browser.wait_for(&step("record", "now"));
    assert!(!browser.is(&is_seen("setup")));
    assert!(browser.is(&is_seen("begin")));
    browser.press("Enter");
    browser.wait_for("$session.dataset.phase === 'ready'");
    browser.press("e");
    browser.press("e");
    // Nothing was recorded: the next step is another session.
    browser.wait_for("!$result.hidden");
    browser.wait_for(&step("record", "now"));
    browser.wait_for(&step("tune", "next"));
    let main = "document.querySelector('#result button.main').id";
    assert_eq!(browser.value(main), "again");
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
    drop(board);
}
