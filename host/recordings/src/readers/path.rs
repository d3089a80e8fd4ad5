//! Names of files and folders, which identify person and gesture in the published sets.

use std::path::{Path, PathBuf};

/// Name of the file without its ending.
pub(crate) fn stem(path: &Path) -> Option<&str> {
    path.file_stem()?.to_str()
}

/// Ending of a path in small letters: some systems and recorders write `.CSV`.
pub fn ending(path: &Path) -> Option<String> {
    let ending = path.extension()?.to_str()?;
    Some(ending.to_ascii_lowercase())
}

/// A path with its ending in small letters.
pub(crate) fn with_small_ending(path: &Path) -> PathBuf {
    ending(path).map_or_else(|| path.to_owned(), |ending| path.with_extension(ending))
}

/// The file of a path, whatever letters its ending has; none if there is no such file.
pub fn existing(path: PathBuf) -> Option<PathBuf> {
    if path.exists() {
        return Some(path);
    }
    let wanted = with_small_ending(&path);
    let beside = path.parent()?.read_dir().ok()?.flatten();
    let mut beside = beside.map(|entry| entry.path());
    beside.find(|own| with_small_ending(own) == wanted)
}

/// Whether a text is digits alone.
pub(crate) fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// Words for the left and the right arm in names of folders and files.
#[rustfmt::skip]
const ARMS: [(bool, &[&str]); 2] = [
    (true, &[
        "left", "lefthand", "leftarm", "links", "linke", "linker", "izquierda", "izquierdo", "gauche", "sinistra",
        "sinistro",
    ]),
    (false, &["right", "righthand", "rightarm", "rechts", "rechte", "derecha", "droite", "destra"]),
];

/// Whether a file is named after the left arm: the name nearest to it that names an arm decides, of its own and those
/// of four folders above.
pub(crate) fn left_arm(path: &Path) -> bool {
    let names = path.ancestors().take(5).filter_map(Path::file_name);
    let arm = |name: &std::ffi::OsStr| {
        let name = name.to_string_lossy().to_lowercase();
        let has = |list: &[&str]| {
            name.split(|c: char| !c.is_alphabetic())
                .any(|word| list.contains(&word))
        };
        ARMS.iter()
            .find(|(_, words)| has(words))
            .map(|(is_left, _)| *is_left)
    };
    names.into_iter().find_map(arm).unwrap_or(false)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_of_an_arm_decides() {
        for (path, is_left) in [
            ("/d/_readings_left_hand/12345-1/7.txt", true),
            ("/left/_readings_right_hand/12345-1/7.txt", false),
            ("/d/anna/anna_left_1.csv", true),
            ("/d/anna/Links/1.csv", true),
            ("/d/leftovers/1.csv", false),
            ("/d/anna/1.csv", false),
        ] {
            assert_eq!(left_arm(Path::new(path)), is_left, "{path}");
        }
    }
}
