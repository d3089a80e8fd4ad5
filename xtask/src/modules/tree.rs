//! All modules of a crate, read from its root file on.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context as _, Result};

use super::parse::{self, File, Source};

/// A line of a file.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct Site {
    /// The file.
    pub file: PathBuf,
    /// The line in it.
    pub line: usize,
}

impl Site {
    /// As `file:line`, the file relative to `root`.
    pub fn below(&self, root: &Path) -> String {
        let file = self.file.strip_prefix(root).unwrap_or(&self.file);
        format!("{}:{}", file.display(), self.line)
    }
}

/// Where a module is, from the crate's root, which has the empty path.
pub type ModulePath = Vec<String>;

/// One module.
pub struct Module {
    /// The file that it is written in.
    pub file: PathBuf,
    /// Its contents, without the modules inside it.
    pub source: Source,
}

/// The modules of a crate.
#[derive(Default)]
pub struct Tree {
    modules: BTreeMap<ModulePath, Module>,
    /// Modules that are declared and have no file.
    missing: Vec<Missing>,
    /// Files, and folders of files, that are compiled for tests alone.
    tests: Vec<PathBuf>,
}

/// A module without a file.
pub struct Missing {
    /// Its name.
    pub name: String,
    /// Where it is declared.
    pub site: Site,
}

impl Tree {
    /// Reads a crate.
    ///
    /// # Errors
    /// When a file cannot be read or is no Rust.
    pub fn load(root: &Path) -> Result<Self> {
        let mut tree = Self::default();
        let folder = root.parent().unwrap_or(root);
        tree.read(Vec::new(), root, folder)?;
        Ok(tree)
    }

    /// All modules with their paths, parents before children.
    pub fn modules(&self) -> impl Iterator<Item = (&ModulePath, &Module)> {
        self.modules.iter()
    }

    /// The module at a path.
    pub fn get(&self, path: &[String]) -> Option<&Module> {
        self.modules.get(path)
    }

    /// Modules that are declared and have no file.
    pub fn missing(&self) -> &[Missing] {
        &self.missing
    }

    /// Files, and folders of files, that are compiled for tests alone.
    pub fn tests(&self) -> &[PathBuf] {
        &self.tests
    }

    /// Reads a file; `folder` is where the files of its own modules are.
    fn read(&mut self, path: ModulePath, file: &Path, folder: &Path) -> Result<()> {
        let text = fs::read_to_string(file)
            .with_context(|| format!("{} cannot be read", file.display()))?;
        let source = parse::parse(&text).map_err(|error| {
            let line = error.span().start().line;
            anyhow::anyhow!("{}:{line}: {error}", file.display())
        })?;
        self.add(path, source, file, folder)
    }

    fn add(
        &mut self,
        path: ModulePath,
        mut source: Source,
        file: &Path,
        folder: &Path,
    ) -> Result<()> {
        for (name, inner) in std::mem::take(&mut source.inline) {
            let folder = folder.join(&name);
            self.add(child(&path, name), inner, file, &folder)?;
        }
        for declared in &source.files {
            let child = child(&path, declared.name.clone());
            match find(declared, file, folder) {
                Some((found, own)) => self.read(child, &found, &own)?,
                None => self.missing.push(Missing {
                    name: declared.name.clone(),
                    site: Site {
                        file: file.to_owned(),
                        line: declared.line,
                    },
                }),
            }
        }
        for declared in &source.test_files {
            if let Some((found, own)) = find(declared, file, folder) {
                self.tests.push(found);
                // With `#[path]` the folder is that of other files, too.
                self.tests
                    .extend(Some(own).filter(|_| declared.path.is_none()));
            }
        }
        // Two of a name exist under opposite `cfg`s: both count.
        let module = self.modules.entry(path).or_insert_with(|| Module {
            file: file.to_owned(),
            source: Source::default(),
        });
        module.source.items.append(&mut source.items);
        module.source.imports.append(&mut source.imports);
        module.source.globs.append(&mut source.globs);
        module.source.references.append(&mut source.references);
        Ok(())
    }
}

/// The file of a module that is declared in `file`, and the folder of the module's own files.
fn find(declared: &File, file: &Path, folder: &Path) -> Option<(PathBuf, PathBuf)> {
    if let Some(name) = &declared.path {
        let found = file.parent()?.join(name);
        let own = found.parent()?.to_owned();
        return Some((found, own)).filter(|(found, _)| found.is_file());
    }
    let own = folder.join(&declared.name);
    let candidates = [own.with_extension("rs"), own.join("mod.rs")];
    let found = candidates
        .into_iter()
        .find(|candidate| candidate.is_file())?;
    Some((found, own))
}

fn child(parent: &ModulePath, name: String) -> ModulePath {
    let mut path = parent.clone();
    path.push(name);
    path
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// A crate of these modules: paths such as `a::b`, the root's empty, and their text.
    pub fn tree(modules: &[(&str, &str)]) -> Tree {
        let mut tree = Tree::default();
        for (path, text) in modules {
            let path: ModulePath = path.split("::").map(str::to_owned).collect();
            let path = if path == [""] { Vec::new() } else { path };
            let file = PathBuf::from(format!("{}.rs", path.join("/")));
            let mut source = parse::parse(text).unwrap();
            source.files.clear();
            tree.add(path, source, &file, Path::new("")).unwrap();
        }
        tree
    }

    #[test]
    fn a_crate_is_read_file_by_file() -> Result<()> {
        let folder = std::env::temp_dir().join(format!("xtask-tree-{}", std::process::id()));
        let write = |name: &str, text: &str| {
            let file = folder.join(name);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(file, text).unwrap();
        };
        write("lib.rs", "mod a; mod b; #[path = \"odd/name.rs\"] mod c;");
        write("a.rs", "mod inner { mod deep; } #[cfg(test)] mod checks;");
        write("a/checks.rs", "");
        write("a/inner/deep.rs", "");
        write("b/mod.rs", "mod leaf;");
        write("b/leaf.rs", "");
        write("odd/name.rs", "");
        let tree = Tree::load(&folder.join("lib.rs"))?;
        let paths: Vec<_> = tree.modules().map(|(path, _)| path.join("::")).collect();
        let expected = ["", "a", "a::inner", "a::inner::deep", "b", "b::leaf", "c"];
        assert_eq!(paths, expected);
        assert_eq!(
            tree.tests(),
            [folder.join("a/checks.rs"), folder.join("a/checks")]
        );

        write("b/mod.rs", "\nmod leaf; mod missing;");
        let tree = Tree::load(&folder.join("lib.rs"))?;
        let missing = tree.missing();
        assert_eq!(missing.len(), 1);
        assert_eq!(
            (missing[0].name.as_str(), missing[0].site.line),
            ("missing", 2)
        );
        assert!(missing[0].site.file.ends_with("b/mod.rs"));

        write("b/mod.rs", "\n\nmod }");
        let error = Tree::load(&folder.join("lib.rs"))
            .err()
            .unwrap()
            .to_string();
        assert!(error.contains("b/mod.rs:3: "), "{error}");
        fs::remove_dir_all(&folder)?;
        Ok(())
    }
}
