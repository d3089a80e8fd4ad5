//! Links of the repository's pages lead to files and headings that exist.

use std::{
    collections::HashSet,
    fs,
    path::{Path, PathBuf},
};

/// Folders whose pages are checked, below the workspace; `.` without its subfolders.
const FOLDERS: [&str; 4] = [".", "docs", "docs/guides", "models"];

/// A page's text without its code blocks, where a `#` or a bracket means something else.
fn prose(page: &Path) -> String {
    let text = fs::read_to_string(page).expect("a readable page");
    text.split("```").step_by(2).collect()
}

/// Finds the links of a page: the text between `](` and `)`.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let after = text.split("](").skip(1);
    after.filter_map(|rest| rest.split_once(')').map(|(link, _)| link))
}

/// Anchors of the headings, as the usual viewers of Markdown make them.
fn anchors(text: &str) -> HashSet<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    headings
        .map(|line| anchor(line.trim_start_matches('#').trim()))
        .collect()
}

fn anchor(heading: &str) -> String {
    let kept = heading
        .chars()
        .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.flat_map(char::to_lowercase)
        .map(|c| if c == ' ' { '-' } else { c })
        .collect()
}

/// Describes what is wrong with a link of a page, if anything is.
fn fault(page: &Path, text: &str, link: &str) -> Option<String> {
    if link.contains("://") {
        return None;
    }
    let (file, wanted) = link.split_once('#').unwrap_or((link, ""));
    let target = match file {
        "" => page.to_owned(),
        file => page.parent()?.join(file),
    };
    let page = page.display();
    if !target.exists() {
        return Some(format!("{page}: no file {link}"));
    }
    let found = match file {
        _ if wanted.is_empty() => true,
        "" => anchors(text).contains(wanted),
        _ => anchors(&prose(&target)).contains(wanted),
    };
    (!found).then(|| format!("{page}: no heading {link}"))
}

fn pages() -> Vec<PathBuf> {
    let folders = FOLDERS.map(|folder| crate::workspace().join(folder));
    let entries = folders.iter().flat_map(|folder| {
        let entries = fs::read_dir(folder).expect("a folder of pages");
        entries.map(|entry| entry.expect("an entry").path())
    });
    let mut pages: Vec<_> = entries
        .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
        .collect();
    pages.push(crate::workspace().join("tests/golden/data/README.md"));
    pages
}

#[test]
fn links_of_pages_lead_to_files_and_headings() {
    let faults: Vec<String> = pages()
        .iter()
        .flat_map(|page| {
            let text = prose(page);
            let faults: Vec<_> = links(&text)
                .filter_map(|link| fault(page, &text, link))
                .collect();
            faults
        })
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Cargo.toml has the address; other files repeat it, the program's help reads it.
#[test]
fn the_projects_address_is_the_one_in_cargo_toml() {
    let files = [
        "README.md",
        "docs/guides/flash.md",
        "host/python/pyproject.toml",
    ];
    for file in files {
        let text = fs::read_to_string(crate::workspace().join(file)).expect(file);
        let own = env!("CARGO_PKG_REPOSITORY");
        let hosted = text.matches("://github.com/").count();
        let others = text.matches("://github.com/").count() - text.matches(own).count();
        assert!(hosted > 0 && others == 0, "{file}");
    }
}

#[test]
fn anchors_drop_punctuation_and_keep_words() {
    assert_eq!(
        anchor("Why d = 64 with two layers?"),
        "why-d--64-with-two-layers"
    );
    assert_eq!(anchor("Why one `memory.x`?"), "why-one-memoryx");
}
