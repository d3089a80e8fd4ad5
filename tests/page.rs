//! The page as one file, opened from the disk in a browser: labels as by `replay`, devices, recordings.

#[allow(dead_code, reason = "shared with the tests of `live`")]
#[path = "live/browser.rs"]
mod browser;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use myointent::cli::replay;
use myointent_tests::chip::{self, Board, Setting};
use myointent_tests::found;
use nrf52::time::HZ;
use recordings::synthetic::{self, SynthOptions};
use recordings::{LoadOptions, load};
use serde_json::{Value, json};
use shared::calibration::Shown;
use shared::intent::Intent;
use shared::model::file::Model;
use shared::myo::Address;
use shared::uart_line::Report;
use shared::uart_line::answer::{Answer, Identity};
use shared::uart_line::calibration::{CalibrationReport, CalibrationState, Recalls};
use shared::uart_line::emg::EmgReport;
use shared::units::{Sample, SampleIndex};
use web::SHIPPED;
use web::event::Event;
use xtask::firmware::Image;

use self::browser::{Browser, BrowserKind, CATCH, CONNECTED, FITS, LOST, VALID};

/// Whether the page offers to save a calibrated model.
const SAVES: &str = "!$save-model.hidden";

/// Expression that is true once the page shows a label.
fn label(name: &str) -> String {
    format!("{VALID} && $label.textContent === '{name}'")
}

/// The shipped model, on the heap, which aligns it as a model requires.
fn shipped() -> Vec<u8> {
    SHIPPED.to_vec()
}

/// A synthetic recording.
fn samples(seconds: usize) -> Vec<Sample> {
    let options = SynthOptions {
        subjects: 1,
        recordings: 1,
        seconds,
        ..SynthOptions::default()
    };
    synthetic::generate(&options).remove(0).samples
}

/// A report as a message, without what `replay` does not write.
fn message(mut message: Value) -> Value {
    let fields = message.as_object_mut().unwrap();
    fields.remove("at");
    fields.remove("strength");
    message
}

/// Reports of `replay` as messages.
fn replayed(samples: &[Sample]) -> Vec<Value> {
    let lines = replay::lines(&shipped(), samples).unwrap();
    let reports = lines.lines().filter_map(|line| {
        let report = Report::parse(format!("{line}\r\n").as_bytes()).ok()?;
        Some(message(json!(Event::of_report(0.0, &report))))
    });
    reports.collect()
}

/// Path of the one file, or why there is none. MYOINTENT_PAGE names another one, of a release.
static FILE: LazyLock<Result<PathBuf, String>> = LazyLock::new(|| {
    if let Some(path) = std::env::var_os("MYOINTENT_PAGE") {
        return Ok(path.into());
    }
    let page = xtask::page::build(false).map_err(|error| format!("{error:#}"))?;
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("myointent.html");
    std::fs::write(&path, page).unwrap();
    Ok(path)
});

/// Opens the file in a browser, after a script; none where something is missing, which is booked as skipped.
fn open(kind: BrowserKind, script: &str) -> Option<Browser> {
    let mut browser = Browser::start(kind)?;
    let path = match &*FILE {
        Ok(path) => path,
        Err(error) => {
            myointent_tests::skip(error);
            return None;
        }
    };
    if !script.is_empty() {
        let method = "Page.addScriptToEvaluateOnNewDocument";
        browser.command(method, json!({ "source": script }));
    }
    // A device keeps its pace: pictures without motion leave a busy machine the time to hear it.
    let motion = if script.is_empty() {
        "no-preference"
    } else {
        "reduce"
    };
    browser.look(1440, 900, "light", motion);
    browser.open(&format!("file://{}", path.display()));
    Some(browser)
}

/// Clicks an element as a user does: a chooser needs that.
fn click(browser: &mut Browser, id: &str) {
    let place = browser.value(&format!(
        "(({{ x, y, width, height }}) => [x + width / 2, y + height / 2])(${id}.getBoundingClientRect())"
    ));
    for kind in ["mousePressed", "mouseReleased"] {
        browser.command(
            "Input.dispatchMouseEvent",
            json!({ "type": kind, "x": place[0], "y": place[1], "button": "left", "clickCount": 1 }),
        );
    }
}

/// Script with fakes of devices, and what they play.
fn fakes(board: &Value, pairs: &[&[i8]]) -> String {
    let armband = json!({ "pairs": pairs, "period": 10 });
    let fakes = include_str!("page/devices.js");
    format!("{{ const BOARD = {board}; const ARMBAND = {armband};\n{fakes} }}")
}

/// Script with fakes of both kinds of devices.
fn devices() -> String {
    let samples = samples(60);
    let pairs: Vec<&[i8]> = samples
        .chunks_exact(2)
        .map(|pair| pair.as_flattened())
        .collect();
    // Of each notification the raw line, and behind it the reports that it leads to.
    let mut reports = Vec::new();
    for line in replay::lines(&shipped(), &samples).unwrap().lines() {
        let line = format!("{line}\r\n");
        let report = Report::parse(line.as_bytes()).unwrap();
        reports.push((report.emitted.0, line));
    }
    let mut reports = reports.into_iter().peekable();
    let lines = samples.chunks_exact(2).zip((0..).step_by(2));
    let lines: Vec<String> = lines
        .map(|(pair, first)| {
            let emg = EmgReport {
                first: SampleIndex(first),
                samples: [pair[0], pair[1]],
            };
            let mut text = emg.to_string();
            while let Some((_, line)) = reports.next_if(|(emitted, _)| *emitted < first + 2) {
                let _ = write!(text, "{line}");
            }
            text
        })
        .collect();
    let identity = Answer::Identity(Identity {
        version: "0.1.0",
        revision: "0123456789ab",
        image: "fake",
        model: Some(Model::parse(&shipped()).unwrap().checksum),
        armband: Some(Address::parse("FA:12:34:56:78:9A").unwrap()),
        firmware: None,
        battery: Some(77),
    });
    let begun = [Intent::Relax, Intent::Open]
        .map(|cue| CalibrationReport::of(CalibrationState::Teaching, Some(Shown::Intent(cue))));
    let done = CalibrationReport {
        recalls: Some(Recalls {
            before: 761,
            learnt: 840,
        }),
        ..CalibrationReport::of(CalibrationState::Done, None)
    };
    let calibration = [CalibrationReport::default(), begun[0], begun[1], done];
    let answers = calibration.map(|report| Answer::Calibration(report, report == done).to_string());
    let board = json!({
        "lines": lines, "period": 10, "identity": identity.to_string(), "calibration": answers,
    });
    fakes(&board, &pairs)
}

#[test]
fn the_file_shows_the_simulated_arm_without_a_server_and_takes_recordings() {
    let Some(mut browser) = open(BrowserKind::Chromium, "") else {
        return;
    };
    browser.wait_for(VALID);
    println!("first label: {} ms", browser.value("performance.now()"));
    for class in ["open", "relax", "close"] {
        browser.wait_for(&label(class));
    }
    browser.wait_for("$agrees.dataset.state === 'right'");
    browser.wait_for("Number($rate.textContent) > 190");
    let picture = |name: &str| Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    browser.screenshot(&picture("page.png"));
    browser.look(390, 844, "dark", "no-preference");
    browser.screenshot(&picture("page-phone.png"));
    assert!(browser.is(FITS), "wider than the window");
    browser.look(1440, 900, "light", "no-preference");

    // A task that measures, by a key: the simulated arm moves blocks.
    browser.press("p");
    browser.wait_for("$guide-task.textContent === 'Close the hand to a fist'");
    browser.wait_for("parseInt($guide-count.textContent) > 1");
    browser.screenshot(&picture("page-blocks.png"));
    browser.press("w");
    browser.wait_for("parseInt($worn-word.textContent) > 2");
    browser.screenshot(&picture("page-blocks-worn.png"));
    browser.press("w");
    browser.press("p");
    browser.wait_for("$guide.hidden && $played.textContent.startsWith('Ended')");

    // The page's own messages: a mark, and an alignment that the simulated arm takes part in.
    browser.press("m");
    browser.press("a");
    browser.wait_for("$placement.textContent === 'Aligned: in its usual place'");
    // As one that was put on otherwise.
    browser.value("$turn.click()");
    browser.press("a");
    browser.wait_for("$placement.textContent === 'Aligned: turned by 3 places'");
    browser.value("$turn.click(), $reset.click()");
    browser.wait_for("$placement.textContent.startsWith('Not aligned')");

    // A calibration leads through half a minute; its model is saved, and opened again.
    browser.press("c");
    browser.wait_for("$guide-task.textContent === 'Close the hand to a fist'");
    browser.screenshot(&picture("page-calibrating.png"));
    browser.wait_for("$calibrated.textContent.startsWith('Calibrated: ')");
    browser.value(CATCH);
    browser.value("$save-model.click()");
    browser.wait_for("window.saved?.size > 80000");
    browser.screenshot(&picture("page-calibrated.png"));
    browser.value("$forget.click()");
    browser.wait_for("$forget.hidden");
    browser.value(
        "(() => { const data = new DataTransfer(); data.items.add(new File([window.saved], 'mine.intent')); \
         document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true })); })()",
    );
    browser.wait_for("$valid.dataset.valid !== 'yes'");
    browser.wait_for(&format!("{CONNECTED} && {VALID}"));

    // A recording is dropped; another file says why it is refused.
    let mut text = String::from("gt,emg_0,emg_1,emg_2,emg_3,emg_4,emg_5,emg_6,emg_7\n");
    for sample in samples(20) {
        let counts = sample.map(|count| count.to_string()).join(",");
        let _ = writeln!(text, "1,{counts}");
    }
    let drop = |text: &str| {
        format!(
            "(() => {{ const data = new DataTransfer(); data.items.add(new File([{}], 'mine.csv')); \
             return document.body.dispatchEvent(new DragEvent('drop', {{ dataTransfer: data, bubbles: true, cancelable: true }})); }})()",
            json!(text)
        )
    };
    browser.value(&drop(&text));
    browser.wait_for(&format!(
        "{CONNECTED} && $source.textContent.includes('mine') && {VALID} && \
         $truth.lastChild.textContent === 'open'"
    ));
    browser.value(&drop("no recording"));
    browser.wait_for(LOST);
    let why = browser.text("source");
    assert!(why.contains("mine.csv"), "{why}");
    browser.value("$use-demo.click()");
    browser.wait_for(&format!("{CONNECTED} && {VALID}"));
    assert_eq!(browser.complaints, [""; 0]);
}

/// Script that plays a recording's file through the module inside the page, as fast as it goes; its value is the reports.
fn play(name: &Path, bytes: &[u8], samples: usize) -> String {
    let wanted = json!({ "source": "recording", "name": name });
    let ticks = samples.div_ceil(2);
    format!(
        "(async () => {{
            const packed = Uint8Array.from(atob($program.textContent), (letter) => letter.charCodeAt(0));
            const code = new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip')));
            const {{ instance: {{ exports: program }} }} = await WebAssembly.instantiate(await code.arrayBuffer());
            const give = (bytes) => {{
                const address = program.input(bytes.length);
                new Uint8Array(program.memory.buffer, address, bytes.length).set(bytes);
            }};
            const messages = (length) =>
                JSON.parse(new TextDecoder().decode(new Uint8Array(program.memory.buffer, program.output(), length)));
            give(Uint8Array.from({bytes:?}));
            program.file();
            give(new TextEncoder().encode({}));
            const opened = messages(program.open(0));
            return opened.concat(...Array.from({{ length: {ticks} }}, (_, tick) => messages(program.tick(10 * tick))))
                .filter(({{ type }}) => type === 'report');
        }})()",
        json!(wanted.to_string())
    )
}

#[test]
fn in_a_browser_labels_of_four_sets_are_those_of_replay() {
    let Some(data) = myointent_tests::data() else {
        return;
    };
    let Some(mut browser) = open(BrowserKind::Chromium, "") else {
        return;
    };
    // Of these, one file is a whole recording: a page has no other beside it.
    for file in [
        "uci-gestures/23/1_raw_data_13-18_05.04.16.txt",
        "ss-stm/data/sub11/M1T1.csv",
        "epn/user10/testing/098_fist.npy",
        "cote-allard/EvaluationDataset/Male2/training0/classe_7.dat",
    ] {
        let path = data.join(file);
        let library = load(&path, &LoadOptions::default()).unwrap();
        let samples = &library.recordings[0].samples;
        let expected = replayed(samples);
        assert!(expected.len() > 10, "{file}: {}", expected.len());
        let script = play(&path, &std::fs::read(&path).unwrap(), samples.len());
        let Value::Array(played) = browser.value(&script) else {
            panic!("{file}: no reports");
        };
        let played: Vec<Value> = played.into_iter().map(message).collect();
        assert_eq!(played, expected, "{file}");
    }
}

#[test]
fn an_armband_streams_into_the_file_and_is_found_again() {
    let Some(mut browser) = open(BrowserKind::Chromium, &devices()) else {
        return;
    };
    browser.wait_for(CONNECTED);
    click(&mut browser, "use-bluetooth");
    let streams = format!("{CONNECTED} && $source.textContent === 'armband: Simulated Myo'");
    browser.wait_for(&streams);
    browser.wait_for(&label("open"));
    browser.wait_for(&label("close"));
    assert_eq!(browser.text("battery"), "80 %");
    // Its movement shows the arm, once it is known how it is worn: raised by 30°, the palm down; level, and up; hanging.
    browser.wait_for("!$arm.hidden && $arm-said.textContent.startsWith('Raise')");
    for (pose, told) in [
        ("15826, 0, -4240, 0", "Raised by 30°, palm down"),
        ("0, 16384, 0, 0", "Raised by 0°, palm up"),
        ("14189, 0, 8192, 0", "Lowered by 60°, palm down"),
        ("11585, 11585, 0, 0", "Raised by 0°, palm to the side"),
    ] {
        browser.value(&format!("window.pose = [{pose}]"));
        browser.frames(20);
        if pose.starts_with("15826") {
            browser.value("$arm-set.click()");
        }
        browser.wait_for(&format!("$arm-said.textContent === '{told}'"));
    }
    browser.screenshot(&Path::new(env!("CARGO_TARGET_TMPDIR")).join("page-arm.png"));
    // A page that stalls gets afterwards what came meanwhile: nothing is lost, and labels go on.
    browser.wait_for(VALID);
    browser.value("window.worst = 'yes'; new MutationObserver(() => { if ($valid.dataset.valid !== 'yes') window.worst = $valid.textContent; }) \
         .observe($valid, { attributes: true })");
    for ms in [150, 300, 600, 1200] {
        browser.value(&format!(
            "(() => {{ const end = performance.now() + {ms}; while (performance.now() < end); }})()"
        ));
        browser.frames(30);
        let lost = browser.text("lost");
        assert_eq!(
            (&*lost, browser.value("window.worst")),
            ("0", json!("yes")),
            "{ms} ms"
        );
    }
    browser.value("device.gatt.disconnect()");
    browser.wait_for(LOST);
    browser.wait_for(&streams);
    browser.wait_for(VALID);
    assert_eq!(browser.value("device.gatt.connections"), 2);
    // Another source lets go of the armband.
    browser.value("$use-demo.click()");
    browser.wait_for("!device.gatt.connected");
    browser.wait_for(&format!("{CONNECTED} && {VALID}"));
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn a_board_streams_into_the_file_and_may_be_unplugged() {
    let Some(mut browser) = open(BrowserKind::Chromium, &devices()) else {
        return;
    };
    browser.wait_for(CONNECTED);
    click(&mut browser, "use-board");
    browser.wait_for(&format!(
        "{CONNECTED} && $source.textContent === 'board on USB'"
    ));
    browser.wait_for(&label("open"));
    browser.wait_for(&label("close"));
    browser.wait_for("$battery.textContent === '77 %'");
    assert_eq!(browser.text("line"), "0 samples, 0 lines");
    // It runs the page's model: three classes and other movement have scores.
    assert_eq!(browser.value("$legend.childElementCount"), 4);
    browser.press("a");
    browser.wait_for("port.written.includes('$ALIGN,begin')");
    // It calibrates itself.
    browser.press("c");
    browser.wait_for("$calibrated.textContent.startsWith('Calibrated: 84 %')");
    browser.value("$forget.click()");
    browser.wait_for("$calibrated.textContent.startsWith('Not calibrated')");
    assert!(!browser.is(SAVES));
    browser.value("port.pull()");
    browser.wait_for(LOST);
    browser.wait_for("!$empty.hidden");
    // It is chosen again, and another source turns its raw stream off.
    click(&mut browser, "use-board");
    browser.wait_for(&format!("{CONNECTED} && {VALID}"));
    browser.value("$use-demo.click()");
    browser.wait_for("port.written.includes('$RAW,off') && port.readable === null");
    browser.wait_for(&format!("{CONNECTED} && {VALID}"));
    assert_eq!(browser.complaints, [""; 0]);
}

/// Script that drops the shipped five-class model on the page, and says yes.
fn drop_five() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/five-class.intent");
    let bytes = json!(std::fs::read(path).unwrap());
    format!(
        "(() => {{ window.confirm = () => true; const data = new DataTransfer(); \
         data.items.add(new File([Uint8Array.from({bytes})], 'five.intent')); \
         document.body.dispatchEvent(new DragEvent('drop', {{ dataTransfer: data, bubbles: true, cancelable: true }})); }})()"
    )
}

#[test]
fn the_simulated_board_shows_labels_and_takes_a_dropped_model() {
    let Some(mut browser) = open(BrowserKind::Chromium, "") else {
        return;
    };
    browser.wait_for(CONNECTED);
    assert!(
        !browser.is("$strengths.checkVisibility()"),
        "nobody is there"
    );
    click(&mut browser, "use-simulated");
    browser.wait_for(
        "$strengths.checkVisibility() && $strengths.textContent.startsWith('Rest for 5 s')",
    );
    let scores = |count| format!("{CONNECTED} && {VALID} && $legend.childElementCount === {count}");
    browser.wait_for(&scores(4));
    assert_eq!(browser.text("source"), "board on simulated USB");
    browser.wait_for("$battery.textContent === '80 %'");
    assert!(browser.text("board").starts_with("simulated, "));
    browser.wait_for(&label("open"));
    // Its wearer has rested and moved: how strong the electrodes are is told.
    browser.wait_for(
        "$strengths.textContent.startsWith('Each electrode reaches') && $strengths.checkVisibility()",
    );
    // Its wearer has turned the armband, and its file tells that nobody wore it.
    browser.value("$turn.click()");
    browser.press("a");
    browser.wait_for("$placement.textContent === 'Aligned: turned by 3 places'");
    browser.press("s");
    browser.wait_for("$notice.textContent.includes('simulated_')");
    browser.value(&drop_five());
    browser.wait_for("$notice.textContent.startsWith('Installed')");
    browser.wait_for(&scores(6));
    let picture = Path::new(env!("CARGO_TARGET_TMPDIR")).join("page-simulated-board.png");
    browser.screenshot(&picture);
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn a_dropped_model_is_installed_on_the_emulated_board() -> anyhow::Result<()> {
    let image = found!(chip::image(Image::Nrf52840S140));
    let mut browser = found!(open(BrowserKind::Chromium, &fakes(&Value::Null, &[])));
    let setting = Setting::of(chip::model(), samples(120));
    let mut board = Board::new(Image::Nrf52840S140, image, setting);
    browser.wait_for(CONNECTED);
    click(&mut browser, "use-board");
    // The cable: the chip's time goes on while the page is asked.
    let mut passed = (0, 0);
    let mut until = |browser: &mut Browser, expression: &str| -> anyhow::Result<()> {
        let end = board.machine.now() + 120 * HZ;
        loop {
            let line = board.text_from(passed.0);
            let heard = json!(line);
            let turn = format!(
                "[port.hear({heard}), port.written.slice({}), {expression}]",
                passed.1
            );
            let value = browser.value(&turn);
            let written = value[1].as_str().unwrap();
            passed = (passed.0 + line.len(), passed.1 + written.len());
            board.send_bytes(written.bytes());
            if value[2] == true {
                return Ok(());
            }
            anyhow::ensure!(
                board.machine.now() < end,
                "not in 120 s of the board: {expression}"
            );
            board.run_ms(20)?;
        }
    };
    let scores = |count| format!("{CONNECTED} && $legend.childElementCount === {count}");
    browser.wait_for("window.port?.readable != null");
    until(&mut browser, &scores(4))?;
    let model =
        std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../models/five-class.intent"))?;
    browser.value(&drop_five());
    until(&mut browser, "!$onto-board.hidden")?;
    until(&mut browser, "$notice.textContent.startsWith('Installed')")?;
    // Its scores are those of the new model, and its labels go on.
    until(&mut browser, &format!("{} && {VALID}", scores(6)))?;
    let memory = board.machine.chip().bus.memory.clone();
    assert_eq!(memory.read(chip::MODEL, model.len() as u32), Some(model));
    assert_eq!(browser.complaints, [""; 0]);
    Ok(())
}

#[test]
fn a_session_is_recorded_in_the_file_and_a_tab_that_is_killed_loses_nothing() {
    let Some(mut browser) = open(BrowserKind::Chromium, "") else {
        return;
    };
    browser.wait_for(VALID);
    click(&mut browser, "use-record");
    browser.value("$person.value = 'anna'");
    click(&mut browser, "record-now");
    browser.wait_for("document.body.dataset.mode === 'record'");
    browser.frames(20);
    browser.press("Enter");
    browser.wait_for(
        "$session.dataset.phase === 'cued' && $task.textContent === 'Close the hand to a fist'",
    );
    let picture = Path::new(env!("CARGO_TARGET_TMPDIR")).join("page-session.png");
    browser.screenshot(&picture);
    // A note, whose letters are no keys of the page.
    browser.value("$note.focus()");
    for letter in ["a", "p", "h"] {
        browser.command(
            "Input.dispatchKeyEvent",
            json!({ "type": "keyDown", "key": letter, "text": letter }),
        );
    }
    assert_eq!(browser.value("$note.value"), "aph");
    browser.value("document.querySelector('#note-form button').click()");
    browser.wait_for("$remarks.textContent === 'aph' && $note.value === ''");
    assert!(browser.is("$session.dataset.phase === 'cued' && $guide.hidden"));
    // The page before stays valid for a moment.
    browser.value("window.isBefore = true; location.reload()");
    browser.wait_for("window.isBefore === undefined");
    browser.wait_for(VALID);
    browser.value(CATCH);
    click(&mut browser, "use-record");
    browser.wait_for("$kept-list.childElementCount === 1");
    assert_eq!(browser.value("$person.value"), "anna");
    browser.value("document.querySelector('#kept-list button').click()");
    browser.wait_for("window.saved?.size > 50000");
    let verdict = browser.text("kept-verdict");
    assert!(verdict.starts_with("Not good enough yet\n"), "{verdict}");
    assert!(verdict.contains(" s kept: "), "{verdict}");
    browser.value("window.confirm = () => true; document.querySelector('#kept-list button:last-child').click()");
    browser.wait_for("$kept-before.hidden");
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn a_browser_without_bluetooth_says_so_and_shows_the_simulated_arm() {
    let Some(mut browser) = open(BrowserKind::Firefox, "") else {
        return;
    };
    browser.wait_for(&label("open"));
    // Firefox has no Web Bluetooth; its newer versions have Web Serial.
    assert!(browser.is("$use-bluetooth.disabled"));
    assert!(browser.text("lacks").contains("Chrome and Edge"));
    assert_eq!(browser.complaints, [""; 0]);
}
