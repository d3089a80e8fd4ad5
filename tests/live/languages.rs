//! Languages of the page: one table each, with the same keys; no text of the page stands elsewhere.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use myointent::live::Source;

use super::browser::{Browser, VALID};
use super::record::{SHORT, pictures, record};
use super::serve;

/// Keys that one of the tables lacks, or has twice.
pub const UNEQUAL: &str = "import('./texts.js').then(async ({ TABLES }) => { \
    const [en, de] = [TABLES.en, TABLES.de].map((table) => Object.keys(table)); \
    const parts = await Promise.all(['english', 'english-session', 'german', 'german-session'].map((name) => import(`./${name}.js`))); \
    const all = parts.flatMap((part) => Object.keys(Object.values(part)[0])); \
    const twice = all.length === en.length + de.length ? [] : ['twice']; \
    const holes = (text) => [...text.matchAll(/\\{\\w+\\}/g)].map(String).sort().join(); \
    const other = en.filter((key) => key in TABLES.de && holes(TABLES.en[key]) !== holes(TABLES.de[key])); \
    return [...en.filter((key) => !(key in TABLES.de)), ...de.filter((key) => !(key in TABLES.en)), ...other, ...twice].join(); })";

/// Script for the English on a German page, visible or not, in contents, titles and names: texts of the English table; texts with a word that
/// only English has, but for commands and addresses; and numbers with a decimal point, but for versions.
pub const ENGLISH: &str = "import('./texts.js').then(({ TABLES }) => { \
    const whole = Object.entries(TABLES.en).filter(([key, text]) => text !== TABLES.de[key] && key !== 'language' && !Object.values(TABLES.de).includes(text)); \
    const english = new Set(whole.flatMap(([, text]) => text.split('|'))); \
    const shown = []; const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT); \
    while (texts.nextNode()) { const node = texts.currentNode; if (!node.parentElement.closest('code, noscript, script, #language')) shown.push(node.data.trim()); } \
    for (const one of document.querySelectorAll('[title], [aria-label]')) if (one.id !== 'language') shown.push(one.title, one.ariaLabel ?? ''); \
    const words = /(^|[^\\p{L}-])(the|is|are|of|and|not|with|this|that|were|has|your|for|from|it|be|no|to|space|enter)([^\\p{L}-]|$)/u; \
    const points = document.body.innerText.match(/(^|[\\s(])\\d+\\.\\d+(?=[\\s%)]|$)/g) ?? []; \
    return [...shown.filter((text) => english.has(text) || words.test(text)), ...points].join('; '); })";

/// Whether the page is German.
pub const GERMAN: &str = "document.documentElement?.lang === 'de'";

/// Paths and texts of the files of the page.
fn page_files() -> Vec<(PathBuf, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/web/page");
    let entries = std::fs::read_dir(folder).unwrap().flatten();
    let paths = entries.map(|entry| entry.path());
    paths
        .map(|path| (path.clone(), std::fs::read_to_string(path).unwrap()))
        .collect()
}

/// A line of a script without what is filled into its templates.
fn without_parts(line: &str) -> String {
    let (mut kept, mut rest) = (String::new(), line);
    while let Some((before, from)) = rest.split_once("${") {
        kept += before;
        let mut depth = 1;
        let end = from.find(|letter| {
            depth += i32::from(letter == '{') - i32::from(letter == '}');
            depth == 0
        });
        rest = end.map_or("", |end| &from[end + 1..]);
    }
    kept + rest
}

/// Whether a string is words for people: two of them, of letters, with a space between.
fn is_words(text: &str) -> bool {
    let words: Vec<&str> = text.split(' ').collect();
    let is_word = |word: &&str| {
        word.len() > 1
            && word
                .chars()
                .all(|letter| letter.is_alphabetic() || ".,:;!?'’".contains(letter))
    };
    words.windows(2).any(|pair| pair.iter().all(is_word))
}

#[test]
fn no_text_of_the_page_stands_outside_of_the_tables() {
    let mut found = Vec::new();
    for (path, text) in page_files() {
        let name = path.file_name().unwrap().to_str().unwrap();
        if name.ends_with(".html") {
            let (text, _) = text.split_once("<noscript>").unwrap_or((&text, ""));
            let bare = text.split('<').filter_map(|part| part.split_once('>'));
            let bare = bare.filter(|(tag, _)| !["title", "kbd", "code", "h1"].contains(tag));
            found.extend(
                bare.map(|(_, text)| text.trim().to_owned())
                    .filter(|text| text.chars().count() > 1),
            );
            for attribute in [" title=\"", " aria-label=\""] {
                assert!(!text.contains(attribute), "{name}: {attribute}");
            }
        } else if name.ends_with(".js")
            && !name.starts_with("english")
            && !name.starts_with("german")
        {
            let code = text
                .lines()
                .filter(|line| !line.trim_start().starts_with(['/', '*']));
            for line in code.filter(|line| !line.starts_with("import ")) {
                let line = without_parts(line);
                let strings = line.split(['"', '`']).skip(1).step_by(2);
                found.extend(strings.filter(|text| is_words(text)).map(str::to_owned));
            }
        }
    }
    // Names under which the browser keeps something.
    found.retain(|text| !["alignment is skipped", "change of the placement"].contains(&&text[..]));
    assert_eq!(found, [""; 0]);
}

/// Files of the program whose texts the page shows.
const SPEAKERS: [&str; 24] = [
    "host/src/board.rs",
    "host/src/live/line.rs",
    "host/src/live/line/advice.rs",
    "host/src/live/storage/mod.rs",
    "host/src/live/storage/tuning.rs",
    "host/src/live/stream.rs",
    "host/src/record/error.rs",
    "host/training/src/run/personalize/error.rs",
    "host/training/src/run/personalize/mod.rs",
    "host/training/src/run/personalize/part.rs",
    "host/training/src/run/personalize/rule.rs",
    "host/web/src/armband.rs",
    "host/web/src/board.rs",
    "host/web/src/dialogue.rs",
    "host/web/src/engine.rs",
    "host/web/src/engine/opening.rs",
    "host/web/src/engine/recording.rs",
    "host/web/src/installer.rs",
    "host/web/src/outcome.rs",
    "host/web/src/playback.rs",
    "host/web/src/record/quality.rs",
    "host/web/src/request.rs",
    "host/web/src/scored_pipeline.rs",
    "shared/src/uart_line/refusal.rs",
];

/// Texts of these files that are written elsewhere, to the terminal or into a journal.
const ELSEWHERE: [&str; 9] = [
    "the model is refused",
    "this program was built without Bluetooth",
    "replay of {}",
    "{} over Bluetooth",
    " model refused: ",
    "the storage ended; what was recorded is in the journal",
    "gestures that the model does not have, counted as none: {}",
    "{}: {} s to tune on, {} s held back{}",
    ", a quarter at a time: a third is too short to judge",
];

/// Replaces what a text is filled with by empty braces.
fn without_names(text: &str) -> String {
    let (mut kept, mut rest) = (String::new(), text);
    while let Some((before, from)) = rest.split_once('{') {
        kept += before;
        kept += "{}";
        rest = from.split_once('}').map_or("", |(_, after)| after);
    }
    kept + rest
}

/// Strings of a file's code: without comments, reasons of lints, and unit tests.
fn strings(path: &str) -> Vec<String> {
    let whole =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path));
    let whole = whole.unwrap();
    let code = whole.split("mod tests {").next().unwrap();
    let is_code = |line: &&str| !line.trim_start().starts_with("//") && !line.contains("reason =");
    let lines: Vec<&str> = code.lines().filter(is_code).collect();
    // A string that goes on in the next line.
    let mut joined = String::new();
    for line in lines {
        match joined.strip_suffix('\\') {
            Some(begun) => joined = format!("{begun}{}", line.trim_start()),
            None => joined = joined + "\n" + line,
        }
    }
    let parts = joined.split('"').skip(1).step_by(2);
    parts.map(without_names).collect()
}

#[test]
fn what_the_program_says_has_its_german() {
    let german = page_files()
        .into_iter()
        .find(|(path, _)| path.ends_with("german-program.js"));
    let (_, german) = german.expect("the German of the program");
    let keys: BTreeSet<String> = german
        .lines()
        .filter(|line| line.trim_start().starts_with('"'))
        .flat_map(|line| {
            let strings: Vec<&str> = line.split('"').skip(1).step_by(2).collect();
            let keys = strings.into_iter().step_by(2);
            keys.map(without_names).collect::<Vec<_>>()
        })
        .collect();
    let said: BTreeSet<String> = SPEAKERS.into_iter().flat_map(strings).collect();
    let is_shown = |text: &&String| {
        is_words(text) && !text.starts_with("myointent ") && !ELSEWHERE.contains(&&text[..])
    };
    let missing: Vec<_> = said
        .iter()
        .filter(is_shown)
        .filter(|text| !keys.contains(text.trim_start()))
        .collect();
    assert_eq!(missing, [""; 0], "no German");
    // The others are the operating system's.
    let is_known = |key: &&String| {
        said.iter().any(|text| text.trim_start() == *key) || key.contains("(os error")
    };
    let dead: Vec<_> = keys.iter().filter(|key| !is_known(key)).collect();
    assert_eq!(dead, [""; 0], "said by nobody");
}

#[test]
fn each_state_of_a_german_page_is_german() {
    let mut browser = start!();
    browser.look(1440, 900, "light", "no-preference");
    // The browser asks for it.
    let tongue = serde_json::json!({ "userAgent": "test", "acceptLanguage": "de-DE" });
    browser.command("Emulation.setUserAgentOverride", tongue);
    let folder = tempfile::tempdir().unwrap();
    let reach = |browser: &mut Browser, state: &str| {
        browser.wait_for(state);
        assert_eq!(browser.value(ENGLISH), "", "{state}");
    };

    // A port that is not there.
    let live = serve(Source::Port(folder.path().join("board")));
    browser.open(live.url());
    reach(&mut browser, &format!("{GERMAN} && !$empty.hidden"));
    browser.screenshot(&pictures().join("german-port.png"));
    live.stop().unwrap();

    // A session that waits, one that cannot be written, and its findings.
    let live = record(folder.path(), Source::Demo, SHORT, 16);
    std::fs::write(folder.path().join("anna"), "").unwrap();
    browser.open(live.url());
    reach(&mut browser, &format!("{GERMAN} && {VALID}"));
    browser.press("Enter");
    reach(&mut browser, "!$trouble.hidden");
    std::fs::remove_file(folder.path().join("anna")).unwrap();
    browser.press("Enter");
    reach(&mut browser, "$task.textContent === 'Die Hand weit öffnen'");
    browser.screenshot(&pictures().join("german-session.png"));
    browser.press("h");
    reach(&mut browser, "$session.dataset.phase === 'held'");
    browser.press("e");
    reach(&mut browser, "$ending.open");
    browser.press("e");
    reach(&mut browser, "!$result.hidden");
    browser.screenshot(&pictures().join("german-result.png"));

    // A tuning that fails, the wearer's view, and the person's sessions.
    browser.press("t");
    reach(&mut browser, "$tuned.dataset.state === 'failed'");
    browser.press("w");
    reach(&mut browser, "document.body.dataset.view === 'wearer'");
    browser.open(&format!("{}sessions", live.url()));
    reach(&mut browser, "$state?.textContent.endsWith('…') === false");
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}
