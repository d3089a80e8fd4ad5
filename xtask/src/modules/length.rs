//! How long the source files are.
//!
//! Tests do not count: neither files named `tests.rs`, under a folder `tests` or of a module that is
//! compiled for tests alone, nor such a module inside a file.

use std::{
    fmt, fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result};
use syn::Item;

use super::cfg::is_test;

/// Most lines of a file.
pub const LIMIT: usize = 300;

/// Files that may be longer, and why. One that no longer needs it fails the check, too.
const EXCUSED: [(&str, &str); 0] = [];

/// What the check found.
#[derive(PartialEq, Eq, Debug, Default)]
pub struct Lengths {
    /// Files over the limit, with their lines.
    too_long: Vec<(String, usize)>,
    /// Files over the limit that may be, with their lines and the reason.
    excused: Vec<(String, usize, &'static str)>,
    /// Excuses of files that are gone, or not over the limit.
    needless: Vec<&'static str>,
}

/// Measures every source file of a workspace but those of `tests`, files or folders.
///
/// # Errors
/// When one cannot be read or parsed.
pub fn check(root: &Path, tests: &[PathBuf]) -> Result<Lengths> {
    let mut files = Vec::new();
    collect(root, &mut files)?;
    files.retain(|file| !tests.iter().any(|test| file.starts_with(test)));
    let mut long = Vec::new();
    for file in files {
        let text = fs::read_to_string(&file)
            .with_context(|| format!("{} cannot be read", file.display()))?;
        let lines = text.lines().count();
        if lines > LIMIT {
            let parsed = syn::parse_file(&text).with_context(|| file.display().to_string())?;
            let name = file.strip_prefix(root).unwrap_or(&file);
            long.push((
                name.to_string_lossy().replace('\\', "/"),
                lines - lines_of_tests(&parsed),
            ));
        }
    }
    long.retain(|(_, lines)| *lines > LIMIT);
    long.sort();
    Ok(judge(long, &EXCUSED))
}

fn judge(long: Vec<(String, usize)>, excuses: &[(&'static str, &'static str)]) -> Lengths {
    let mut lengths = Lengths::default();
    for (file, _) in excuses {
        if !long.iter().any(|(long, _)| long == file) {
            lengths.needless.push(file);
        }
    }
    for (file, lines) in long {
        match excuses.iter().find(|(excused, _)| *excused == file) {
            Some((_, reason)) => lengths.excused.push((file, lines, reason)),
            None => lengths.too_long.push((file, lines)),
        }
    }
    lengths
}

/// Source files under a folder, but for tests, build products and hidden folders.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    for entry in entries {
        let entry = entry?;
        let (name, path) = (entry.file_name(), entry.path());
        let name = name.to_string_lossy();
        if entry.file_type()?.is_dir() {
            if !name.starts_with('.') && !["target", "tests"].contains(&&*name) {
                collect(&path, files)?;
            }
        } else if name.ends_with(".rs") && name != "tests.rs" {
            files.push(path);
        }
    }
    Ok(())
}

/// Lines of the modules in a file that are compiled for tests alone.
fn lines_of_tests(file: &syn::File) -> usize {
    let lines = |item: &Item| match item {
        Item::Mod(module) if module.attrs.iter().any(is_test) => {
            let start = module.attrs.first().map(|first| first.pound_token.spans[0]);
            let end = module.content.as_ref().map(|(brace, _)| brace.span.close());
            start
                .zip(end)
                .map_or(0, |(start, end)| end.end().line + 1 - start.start().line)
        }
        _ => 0,
    };
    file.items.iter().map(lines).sum()
}

impl Lengths {
    /// Files that are too long, and excuses that are not needed.
    pub fn faults(&self) -> usize {
        self.too_long.len() + self.needless.len()
    }
}

impl fmt::Display for Lengths {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "files over {LIMIT} lines without their tests:")?;
        if self.too_long.is_empty() && self.excused.is_empty() {
            write!(f, " none")?;
        }
        for (file, lines, reason) in &self.excused {
            write!(f, "\n  {file}: {lines}, excused: {reason}")?;
        }
        for (file, lines) in &self.too_long {
            write!(f, "\n  {file}: {lines}, TOO LONG")?;
        }
        for file in &self.needless {
            write!(f, "\n  {file}: EXCUSED FOR NOTHING")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modules_of_tests_do_not_count() {
        let file = syn::parse_file(
            "fn f() {}\n\n#[cfg(test)]\nmod tests {\n    fn g() {}\n}\n#[cfg(unix)]\nmod more {\n}\n",
        );
        assert_eq!(lines_of_tests(&file.unwrap()), 4);
    }

    #[test]
    fn files_of_tests_do_not_count() -> Result<()> {
        let root = std::env::temp_dir().join(format!("xtask-length-{}", std::process::id()));
        let line = "const A: u8 = 0;\n";
        for (file, lines) in [
            ("src/short.rs", LIMIT),
            ("src/long.rs", LIMIT + 1),
            ("src/long/tests.rs", LIMIT + 1),
            ("src/checks.rs", LIMIT + 1),
            ("tests/long.rs", LIMIT + 1),
            ("target/long.rs", LIMIT + 1),
            (".hidden/long.rs", LIMIT + 1),
            ("src/long.txt", LIMIT + 1),
        ] {
            let file = root.join(file);
            fs::create_dir_all(file.parent().unwrap())?;
            fs::write(file, line.repeat(lines))?;
        }
        let lengths = check(&root, &[root.join("src/checks.rs")])?;
        assert_eq!(lengths.too_long, [("src/long.rs".to_owned(), LIMIT + 1)]);
        fs::remove_dir_all(&root)?;
        Ok(())
    }

    #[test]
    fn an_excuse_holds_for_a_long_file_alone() {
        let long = vec![("table.rs".to_owned(), 400), ("code.rs".to_owned(), 301)];
        let lengths = judge(long, &[("table.rs", "a table"), ("gone.rs", "was a table")]);
        assert_eq!(lengths.faults(), 2);
        assert_eq!(lengths.excused, [("table.rs".to_owned(), 400, "a table")]);
        assert_eq!(lengths.too_long, [("code.rs".to_owned(), 301)]);
        assert_eq!(lengths.needless, ["gone.rs"]);
    }
}
