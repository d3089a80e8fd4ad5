//! `libclang`, which generates the bindings to Nordic's controller library.
//!
//! Only the image without a SoftDevice needs it. `libclang` finds its own headers only if it is loaded
//! from the folder that it was installed in.

use std::{
    env, fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result};

use crate::debian;

/// The variable in which bindgen looks for the folder of `libclang` first.
pub const VARIABLE: &str = "LIBCLANG_PATH";

const PACKAGES: [&str; 1] = ["libclang-dev"];
/// The folder in which Debian installs all versions of LLVM.
const INSTALLED: &str = "/usr/lib";

/// The folder of `libclang`. None if the environment names one already, or where this machine is no
/// Debian: then bindgen searches by itself.
pub fn find(install: bool) -> Result<Option<PathBuf>> {
    if env::var_os(VARIABLE).is_some() || !Path::new("/usr/bin/dpkg-query").exists() {
        return Ok(None);
    }
    if let Some(folder) = folder(Path::new(INSTALLED)) {
        return Ok(Some(folder));
    }
    let otherwise = format!(
        "no libclang, which the image without a SoftDevice needs. Either set {VARIABLE}, or"
    );
    debian::provide(&PACKAGES, install, &otherwise)?;
    folder(Path::new(INSTALLED))
        .with_context(|| format!("{PACKAGES:?} brought no libclang under {INSTALLED}"))
        .map(Some)
}

/// The `lib` folder of the first LLVM that has both library and headers.
fn folder(installed: &Path) -> Option<PathBuf> {
    let mut versions: Vec<PathBuf> = fs::read_dir(installed)
        .ok()?
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| name_starts_with(path, "llvm-"))
        .map(|path| path.join("lib"))
        .collect();
    versions.sort();
    versions.into_iter().find(|lib| {
        has(lib, |path| name_starts_with(path, "libclang.so"))
            && has(&lib.join("clang"), |path| {
                path.join("include/stdint.h").is_file()
            })
    })
}

fn has(folder: &Path, wanted: impl Fn(&Path) -> bool) -> bool {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.into_iter().any(|entry| wanted(&entry.path()))
}

fn name_starts_with(path: &Path, start: &str) -> bool {
    path.file_name()
        .is_some_and(|name| name.to_string_lossy().starts_with(start))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_library_without_its_headers_is_skipped() {
        let root = env::temp_dir().join(format!("xtask-clang-{}", std::process::id()));
        let make = |file: &str| {
            let file = root.join(file);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, "").unwrap();
        };
        make("llvm-13/lib/libclang.so.1");
        make("llvm-14/lib/libclang.so.1");
        assert_eq!(folder(&root), None);
        make("llvm-14/lib/clang/14.0.6/include/stdint.h");
        assert_eq!(folder(&root), Some(root.join("llvm-14/lib")));
        fs::remove_dir_all(root).unwrap();
    }
}
