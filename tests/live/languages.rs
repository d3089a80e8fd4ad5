//! Languages of the page: one table each, with the same keys; no text of the page stands elsewhere.

use std::collections::{BTreeMap, BTreeSet};
use std::io::ErrorKind;
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

/// Enums whose variants the page shows: the kind of their messages, file and name.
const SPEAKERS: [(&str, &str, &str); 17] = [
    ("armband", "host/web/src/armband.rs", "State"),
    ("board", "host/web/src/installer.rs", "InstallError"),
    ("cable", "host/src/live/line/advice.rs", "Step"),
    (
        "doubt",
        "host/training/src/run/personalize/error.rs",
        "Doubt",
    ),
    ("finding", "host/web/src/record/quality.rs", "Finding"),
    ("journal", "host/src/record/error.rs", "RecordError"),
    ("model", "host/web/src/scored_pipeline.rs", "Refused"),
    ("port", "host/src/live/line/advice.rs", "Reason"),
    ("refusal", "shared/src/uart_line/refusal.rs", "Refusal"),
    ("request", "host/web/src/request.rs", "NotDone"),
    ("session", "host/web/src/engine/recording.rs", "Notice"),
    ("silent", "host/web/src/board.rs", "Step"),
    ("storage", "host/src/live/storage/mod.rs", "Trouble"),
    (
        "tuning",
        "host/training/src/run/personalize/error.rs",
        "PersonalizeError",
    ),
    ("unheard", "host/web/src/board.rs", "Unheard"),
    ("wear", "host/web/src/armband.rs", "Step"),
    (
        "worse",
        "host/training/src/run/personalize/rule.rs",
        "Worse",
    ),
];

/// Kinds of errors of an operating system that have German.
const OS: [ErrorKind; 6] = [
    ErrorKind::AlreadyExists,
    ErrorKind::NotADirectory,
    ErrorKind::NotFound,
    ErrorKind::PermissionDenied,
    ErrorKind::ReadOnlyFilesystem,
    ErrorKind::StorageFull,
];

fn source(path: impl AsRef<Path>) -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    std::fs::read_to_string(root.join(path)).unwrap()
}

/// Text between the braces of an enum or a struct.
fn body<'s>(source: &'s str, name: &str) -> &'s str {
    let from = [format!("{name} {{\n"), format!("{name}<'p> {{\n")];
    let body = from.iter().find_map(|from| source.split_once(&**from));
    body.unwrap().1.split_once("\n}\n").unwrap().0
}

/// Names of an enum's variants as they are serialized, each with the text of its fields; without those that are skipped.
fn variants(source: &str, name: &str) -> Vec<(String, String)> {
    let body = body(source, &format!("enum {name}"));
    let mut found: Vec<(String, String)> = Vec::new();
    let mut is_skipped = false;
    for line in body.lines() {
        let own = line.strip_prefix("    ").unwrap_or_default();
        if own.starts_with(|letter: char| letter.is_ascii_uppercase()) {
            let end = own.find(|letter: char| !letter.is_alphanumeric());
            let (name, fields) = own.split_at(end.unwrap());
            let words = name.char_indices().map(|(at, letter)| {
                let dash = if at > 0 && letter.is_uppercase() {
                    "-"
                } else {
                    ""
                };
                format!("{dash}{}", letter.to_ascii_lowercase())
            });
            let fields = match fields.strip_prefix("(Exchange") {
                Some(_) => self::body(source, "struct Exchange"),
                None => fields,
            };
            if !std::mem::take(&mut is_skipped) {
                found.push((words.collect(), fields.to_owned()));
            }
        } else if let (Some((_, fields)), true) = (found.last_mut(), own.starts_with("    ")) {
            *fields += own;
        }
        is_skipped |= own == "#[serde(skip)]";
    }
    found
}

#[test]
fn what_the_program_says_has_its_german() {
    let files = page_files();
    let mut files = files.iter();
    let german = files.find(|(path, _)| path.ends_with("german-program.js"));
    let (_, german) = german.expect("the German of the program");
    let own = german
        .lines()
        .filter_map(|line| line.trim_start().strip_prefix('"'));
    let own: BTreeMap<&str, &str> = own.filter_map(|line| line.split_once("\": ")).collect();
    let mut said = BTreeMap::new();
    for (kind, path, name) in SPEAKERS {
        for (variant, fields) in variants(&source(path), name) {
            if kind == "finding" {
                said.insert(format!("advice.{variant}"), String::new());
            }
            said.insert(format!("{kind}.{variant}"), fields);
        }
    }
    said.insert("open.empty".to_owned(), String::new());
    for (key, fields) in &said {
        let text = own
            .get(&**key)
            .unwrap_or_else(|| panic!("no German of {key}"));
        for hole in text
            .split('{')
            .skip(1)
            .map(|hole| hole.split([':', '}']).next().unwrap())
        {
            assert!(
                fields.contains(&format!("{hole}: ")),
                "{key}: {hole} is none of {fields}"
            );
        }
    }
    // Values of messages.
    said.extend(OS.map(|kind| (format!("os.{kind:?}"), String::new())));
    let values = [
        "and",
        "os.Uncategorized",
        "part.held back",
        "part.tuned on",
        "recordings.",
    ];
    said.extend(values.map(|value| (value.to_owned(), String::new())));
    let part = source("host/training/src/run/personalize/part.rs");
    assert!(part.contains("\"held back\"") && part.contains("\"tuned on\""));
    let keys: Vec<_> = own.keys().copied().collect();
    let expected: Vec<_> = said.keys().map(String::as_str).collect();
    assert_eq!(keys, expected, "said by nobody, or without German");
    // Every message that has a name is one of these.
    let sources = SPEAKERS.map(|(_, path, _)| path).into_iter().chain([
        "host/src/live/storage/tuning.rs",
        "host/web/src/dialogue.rs",
        "host/web/src/engine.rs",
        "host/web/src/engine/opening.rs",
        "host/web/src/event.rs",
        "host/web/src/outcome.rs",
    ]);
    let sources: Vec<_> = sources.map(source).collect();
    let kinds = sources
        .iter()
        .flat_map(|text| text.split("Said::of(\"").skip(1));
    let kinds: BTreeSet<_> = kinds.map(|rest| rest.split('"').next().unwrap()).collect();
    assert_eq!(kinds, SPEAKERS.map(|(kind, _, _)| kind).into());
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

    // Sentences of a tuning: its reason, what the recordings have of both halves, and doubts.
    let tuned = "import('./result.js').then(({ tuned }) => tuned({ state: 'worse', file: null, judged_seconds: 30.2, tuned_seconds: 61, \
        rows: [{ measure: 'recognised', before: 0.875, after: 1 }, { measure: 'in-others', before: 12, after: 2.54 }, { measure: 'raised', before: null, after: 1 }], \
        why: { text: 'x', name: 'worse.lower', measure: 'recognised', old: 0.5, new: 0.25 }, \
        doubts: [{ text: 'x', name: 'doubt.exchanged', classes: ['open', 'close'], recordings: [], before: 0.5, exchanged: 0.75 }, { text: 'plain' }] }))";
    assert_eq!(
        browser.value(tuned),
        "erkannte Gesten: von 0,500 auf 0,250 gefallen. Verglichen an 30 s, die zurückgehalten wurden, nach 61 s zum Anpassen. \
         Von den Gesten werden 100 % erkannt, vorher 88 %. Eine Minute Bewegung ohne Bedeutung löst 2,5-mal etwas aus, vorher 12,0-mal. \
         Nichts wurde geschrieben; mehr Aufnahmen können helfen. Offen und Faust scheinen vertauscht (Aufnahmen: alle): vertauscht hätte \
         das Modell davor Treffer von 0,75 statt 0,50. Die beiden in der Beschriftung tauschen. Stimmt sie, sitzt das Armband halb herum \
         gedreht: drehen oder ausrichten (docs/alignment.md) und neu aufnehmen. Plain."
    );

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
