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
    let mut versions = entries(installed, "llvm-");
    versions.sort();
    let mut folders = versions.iter().map(|version| version.join("lib"));
    folders.find(|lib| {
        let mut headers = entries(&lib.join("clang"), "").into_iter();
        !entries(lib, "libclang.so").is_empty()
            && headers.any(|version| version.join("include/stdint.h").is_file())
    })
}

/// Entries of a folder whose names have this start; none if it cannot be read.
fn entries(folder: &Path, start: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let named = entries.filter(|entry| entry.file_name().to_string_lossy().starts_with(start));
    named.map(|entry| entry.path()).collect()
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
