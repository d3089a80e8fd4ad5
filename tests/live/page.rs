//! The page in a browser: it loads, moves, follows the recording, pauses, saves, and says when the stream is gone.

use std::time::{Duration, Instant};

use myointent::live::Source;
use recordings::{LoadOptions, load};
use serde_json::json;

use super::browser::Browser;
use super::record::pictures;
use super::viewer::Viewer;
use super::{serve, synthetic};

/// Script whose value changes with every change of the picture.
pub const PICTURE: &str = "document.getElementById('traces').toDataURL().split('').reduce((sum, letter) => (sum * 31 + letter.charCodeAt(0)) | 0, 7)";

const CONNECTED: &str = "document.getElementById('source')?.dataset.state === 'connected'";
const LOST: &str = "document.getElementById('source')?.dataset.state === 'lost'";
pub const VALID: &str = "document.getElementById('valid')?.dataset.valid === 'yes'";

#[test]
fn the_page_follows_a_recording_and_saves_what_it_saw() {
    let Some(mut browser) = Browser::start("the_page_follows_a_recording_and_saves_what_it_saw")
    else {
        return;
    };
    let recording = synthetic(60);
    let live = serve(Source::Replay(Box::new(recording.clone())));
    let downloads = tempfile::tempdir().unwrap();
    browser.command(
        "Browser.setDownloadBehavior",
        json!({ "behavior": "allow", "downloadPath": downloads.path() }),
    );
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    browser.wait_for(CONNECTED);
    browser.wait_for(VALID);

    // Traces move, and the label becomes what the recording says it is, and something else again.
    let before = browser.value(PICTURE);
    browser.wait_for(&format!("{PICTURE} !== {before}"));
    browser.wait_for("document.getElementById('label').textContent === 'open'");
    browser.wait_for("document.getElementById('label').textContent === 'close'");
    browser.wait_for("document.getElementById('label').textContent === 'relax'");
    browser.wait_for("Number(document.getElementById('rate').textContent) > 190");
    let delay = browser.text("delay");
    let delay: u32 = delay.strip_suffix(" ms").unwrap().parse().unwrap();
    assert!((5..=255).contains(&delay), "{delay} ms");
    assert_eq!(browser.text("lost"), "0");

    for (name, width, height, scheme) in [
        ("light", 1440, 900, "light"),
        ("dark", 1440, 900, "dark"),
        ("phone-light", 390, 844, "light"),
        ("phone-dark", 390, 844, "dark"),
    ] {
        browser.look(width, height, scheme, "no-preference");
        if width < 400 {
            // A picture with a gesture tells more than one at rest.
            browser.wait_for("document.getElementById('label').textContent === 'close' && document.getElementById('truth').lastChild.textContent === 'close'");
        }
        browser.frames(20);
        browser.screenshot(&pictures().join(format!("{name}.png")));
        let fits = "document.documentElement.scrollWidth <= innerWidth";
        assert_eq!(browser.value(fits), true, "{name} is wider than the window");
    }
    browser.look(1440, 900, "light", "no-preference");

    // Paused, the picture stands, a key moves it, and the stream goes on behind it.
    browser.press(" ");
    assert_eq!(
        browser.value("document.getElementById('pause').ariaPressed"),
        "true"
    );
    // The picture stops once the labels have come that are later by their look-ahead.
    browser.wait_for(&format!(
        "(async () => {{ const before = {PICTURE}; \
         for (let frame = 0; frame < 20; frame++) await new Promise(requestAnimationFrame); \
         return {PICTURE} === before; }})()"
    ));
    let paused = browser.value(PICTURE);
    browser.press("ArrowLeft");
    browser.wait_for(&format!("{PICTURE} !== {paused}"));
    browser.press(" ");
    assert_eq!(
        browser.value("document.getElementById('pause').ariaPressed"),
        "false"
    );

    browser.press("m");
    browser.frames(20);
    browser.press("s");
    let end = Instant::now() + Duration::from_secs(20);
    let (saved, text) = loop {
        let mut files = std::fs::read_dir(downloads.path()).unwrap().flatten();
        let file = files.find(|file| file.path().extension().is_some_and(|kind| kind == "csv"));
        let text =
            file.and_then(|file| Some((file.path(), std::fs::read_to_string(file.path()).ok()?)));
        match text.filter(|(_, text)| text.ends_with('\n')) {
            Some(whole) => break whole,
            None => assert!(Instant::now() < end, "no whole file was saved"),
        }
        std::thread::sleep(Duration::from_millis(50));
    };
    assert!(text.contains(",mark 1\n"), "no mark in the csv");
    let library = load(&saved, &LoadOptions::default()).unwrap();
    let found = &library.recordings[0];
    let first: usize = text
        .lines()
        .nth(1)
        .unwrap()
        .split(',')
        .nth(9)
        .unwrap()
        .parse()
        .unwrap();
    let expected = first..(first + found.samples.len()).min(recording.samples.len());
    assert!(expected.len() > 1000, "{expected:?}");
    assert_eq!(
        found.samples[..expected.len()],
        recording.samples[expected.clone()]
    );
    assert_eq!(found.labels[..expected.len()], recording.labels[expected]);

    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
    browser.wait_for(LOST);
    assert!(
        browser.text("source").contains("has ended"),
        "{}",
        browser.text("source")
    );
}

#[test]
fn an_electrode_without_contact_is_named_and_marked() {
    let name = "an_electrode_without_contact_is_named_and_marked";
    let Some(mut browser) = Browser::start(name) else {
        return;
    };
    let mut recording = synthetic(60);
    for sample in &mut recording.samples {
        sample[2] = 0;
    }
    let live = serve(Source::Replay(Box::new(recording)));
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    browser.wait_for(
        "document.getElementById('electrodes')?.textContent === 'Electrode 3 has no contact.'",
    );
    assert_eq!(
        browser.value("document.querySelectorAll('#armband .pod.fault').length"),
        1
    );
    browser.screenshot(&pictures().join("electrode.png"));
    live.stop().unwrap();
    browser.wait_for("document.getElementById('electrodes').textContent === ''");
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn without_motion_the_picture_moves_by_the_second() {
    let Some(mut browser) = Browser::start("without_motion_the_picture_moves_by_the_second") else {
        return;
    };
    let live = serve(Source::Demo);
    browser.look(1440, 900, "dark", "reduce");
    browser.open(live.url());
    browser.wait_for(VALID);
    // Nothing else is drawn over the seconds along the axis.
    let lines = "(() => { const c = document.getElementById('traces'); \
        const dots = c.getContext('2d').getImageData(60, c.height - 14, c.width - 70, 10).data; \
        return dots.reduce((sum, dot, at) => (sum * 31 + dot + at) | 0, 7); })()";
    let mut changes = 0;
    let mut last = browser.value(lines);
    let end = Instant::now() + Duration::from_secs(3);
    while Instant::now() < end {
        let now = browser.value(lines);
        changes += u32::from(now != last);
        last = now;
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(changes <= 4, "{changes} changes in 3 s");
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}

#[cfg(target_os = "linux")]
#[test]
fn the_page_shows_a_board_that_is_lost_and_back() {
    use super::board::{Board, Damage};

    let Some(mut browser) = Browser::start("the_page_shows_a_board_that_is_lost_and_back") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let board = Board::start(&link, Damage::None);
    let live = serve(Source::Port(link.clone()));
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    browser.wait_for(CONNECTED);
    browser.wait_for(VALID);
    browser.wait_for("document.getElementById('battery').textContent === '80 %'");
    assert!(browser.text("legend").contains("--model FILE"));
    browser.press("a");
    browser.wait_for("document.getElementById('placement').textContent.includes('open the hand')");
    assert!(browser.text("align").starts_with("Stop"));
    browser.screenshot(&pictures().join("board.png"));
    drop(board);
    // The words come with the message, and the label goes with the next frame.
    browser.wait_for(&format!(
        "{LOST} && document.getElementById('source').textContent.includes('looking for it again')"
    ));
    browser.wait_for("document.getElementById('label').textContent === '–'");
    browser.screenshot(&pictures().join("lost.png"));
    let board = Board::start(&link, Damage::None);
    browser.wait_for(CONNECTED);
    browser.wait_for(VALID);
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
    drop(board);
}

/// Script that measures 10 s of frames: frames a second, and the longest and the 95th-percentile time between two in
/// ms.
const FRAMES: &str = "new Promise((done) => { const gaps = []; let last = performance.now(); const end = last + 10000; \
    const frame = () => { const now = performance.now(); gaps.push(now - last); last = now; \
    if (now < end) { requestAnimationFrame(frame); return; } gaps.sort((a, b) => a - b); \
    done([gaps.length / 10, gaps.at(-1), gaps[Math.floor(0.95 * gaps.length)]].map((number) => Math.round(number))); }; \
    requestAnimationFrame(frame); })";

#[test]
#[ignore = "a measurement: prints the delay from sample to screen with four more viewers"]
fn sample_to_screen_with_four_more_viewers() {
    let Some(mut browser) = Browser::start("sample_to_screen_with_four_more_viewers") else {
        return;
    };
    measure(&mut browser, "demo", Source::Demo);
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "a measurement: the same of a board whose raw stream comes four times as fast as an armband's"]
fn sample_to_screen_of_a_board_with_four_more_viewers() {
    use super::board::{Board, Damage};

    let name = "sample_to_screen_of_a_board_with_four_more_viewers";
    let Some(mut browser) = Browser::start(name) else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let link = folder.path().join("board");
    let board = Board::start(&link, Damage::None);
    measure(&mut browser, "board", Source::Port(link));
    drop(board);
}

#[cfg(target_os = "linux")]
#[test]
#[ignore = "a measurement: the same of the firmware on the PC, whose armband streams at its own rate"]
fn sample_to_screen_of_the_firmware_with_four_more_viewers() -> anyhow::Result<()> {
    use myointent_tests::bench::{Bridge, Run, Scenario, python};
    use shared::myo::{Address, binding::to_record};

    let name = "sample_to_screen_of_the_firmware_with_four_more_viewers";
    let (Some(python), Some(mut browser)) = (python(name), Browser::start(name)) else {
        return Ok(());
    };
    let scenario = Scenario {
        model: &super::shipped(),
        page: to_record(Address::parse("FA:12:34:56:78:9A")?).to_vec(),
        samples: &synthetic(600).samples,
        // A slowed clock halves a pause of a busy machine.
        slowed: 2,
        pace: 1.0,
        script: json!([]),
        arguments: Vec::new(),
    };
    let mut run = Run::start(python, &scenario)?;
    run.wait_for("the stream", |run| run.event_count("mode") > 0)?;
    let bridge = Bridge::start(run)?;
    measure(
        &mut browser,
        "firmware",
        Source::Port(bridge.port().to_owned()),
    );
    Ok(())
}

fn measure(browser: &mut Browser, what: &str, source: Source) {
    let live = serve(source);
    for _ in 0..4 {
        let mut viewer = Viewer::connect(live.url());
        std::thread::spawn(move || while viewer.next().is_some() {});
    }
    browser.look(1440, 900, "light", "no-preference");
    browser.open(live.url());
    browser.wait_for(VALID);
    let frames = browser.value(FRAMES);
    let latency = browser.text("latency");
    println!("{what}: sample to screen {latency}; frames a second, longest gap, 95 %: {frames} ms");
    assert_eq!(browser.text("skipped"), "0");
    live.stop().unwrap();
}
