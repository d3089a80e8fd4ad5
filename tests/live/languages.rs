//! Languages of the page: one table each, with the same keys; no text of the page stands elsewhere.

use std::path::{Path, PathBuf};

use myointent::live::Source;

use super::browser::Browser;
use super::page::VALID;
use super::record::{SHORT, pictures, record};
use super::serve;

/// Keys that one of the tables lacks, or has twice.
const UNEQUAL: &str = "import('./texts.js').then(async ({ TABLES }) => { \
    const [en, de] = [TABLES.en, TABLES.de].map((table) => Object.keys(table)); \
    const parts = await Promise.all(['english', 'english-session', 'german', 'german-session'].map((name) => import(`./${name}.js`))); \
    const all = parts.flatMap((part) => Object.keys(Object.values(part)[0])); \
    const twice = all.length === en.length + de.length ? [] : ['twice']; \
    const holes = (text) => [...text.matchAll(/\\{\\w+\\}/g)].map(String).sort().join(); \
    const other = en.filter((key) => key in TABLES.de && holes(TABLES.en[key]) !== holes(TABLES.de[key])); \
    return [...en.filter((key) => !(key in TABLES.de)), ...de.filter((key) => !(key in TABLES.en)), ...other, ...twice].join(); })";

/// English texts that a German page shows: contents, titles and names, visible or not.
const ENGLISH: &str = "import('./texts.js').then(({ TABLES }) => { \
    const whole = Object.entries(TABLES.en).filter(([key, text]) => text !== TABLES.de[key] && key !== 'language' && !Object.values(TABLES.de).includes(text)); \
    const english = new Set(whole.flatMap(([, text]) => text.split('|'))); \
    const shown = []; const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT); \
    while (texts.nextNode()) shown.push(texts.currentNode.data.trim()); \
    for (const one of document.querySelectorAll('[title], [aria-label]')) shown.push(one.title, one.ariaLabel ?? ''); \
    return shown.filter((text) => english.has(text)).join('; '); })";

/// Paths and texts of the files of the page.
fn page_files() -> Vec<(PathBuf, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/src/live/page");
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

#[test]
fn the_page_is_german_where_the_browser_or_the_viewer_asks_for_it() {
    let name = "the_page_is_german_where_the_browser_or_the_viewer_asks_for_it";
    let Some(mut browser) = Browser::start(name) else {
        return;
    };
    browser.look(1440, 900, "light", "no-preference");
    let folder = tempfile::tempdir().unwrap();
    let live = serve(Source::Demo);
    browser.open(live.url());
    browser.wait_for(VALID);
    assert_eq!(browser.value(UNEQUAL), "");
    assert_eq!(browser.value("document.documentElement?.lang"), "en");
    // By the switch, and kept.
    browser.value("document.getElementById('language').click()");
    let german = "document.documentElement?.lang === 'de' && ".to_owned() + VALID;
    browser.wait_for(&german);
    browser.open(live.url());
    browser.wait_for(&german);
    browser.wait_for("document.getElementById('label').textContent === 'Faust'");
    browser.wait_for("!document.getElementById('share').hidden");
    assert_eq!(browser.value(ENGLISH), "");
    browser.screenshot(&pictures().join("german.png"));
    live.stop().unwrap();
    browser.wait_for("document.getElementById('empty').hidden === false");
    assert_eq!(browser.value(ENGLISH), "");

    // By the browser's language, on the page of a session and its record.
    let tongue = serde_json::json!({ "userAgent": "test", "acceptLanguage": "de-DE" });
    browser.command("Emulation.setUserAgentOverride", tongue);
    let live = record(folder.path(), Source::Demo, SHORT, 16);
    browser.open(live.url());
    browser.wait_for(&german);
    assert_eq!(browser.value(ENGLISH), "");
    browser.press("Enter");
    browser.wait_for("document.getElementById('task').textContent === 'Die Hand weit öffnen'");
    assert_eq!(browser.value(ENGLISH), "");
    browser.screenshot(&pictures().join("german-session.png"));
    browser.open(&format!("{}sessions", live.url()));
    browser
        .wait_for("document.getElementById('state')?.textContent.startsWith('In diesem Ordner')");
    assert_eq!(browser.value(ENGLISH), "");
    assert_eq!(browser.complaints, [""; 0]);
    live.stop().unwrap();
}
