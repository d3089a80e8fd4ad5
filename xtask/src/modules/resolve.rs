//! Which modules of the crate a path leads to.

use super::tree::{ModulePath, Tree};

/// Most imports that lead from one to the next: more are a circle of names.
const MAX_DEPTH: usize = 16;

/// The modules that a path, written in the module `from`, depends on: the one that it names, and
/// the one that defines the item where the first only re-exports it. None of another crate.
pub fn resolve(tree: &Tree, from: &ModulePath, path: &[String]) -> Vec<ModulePath> {
    let mut found = Vec::new();
    if let Some(path) = absolute(tree, from, path, MAX_DEPTH) {
        walk(tree, &path, MAX_DEPTH, &mut found);
    }
    found
}

/// The path from the root of the crate; none if it leads into another crate.
fn absolute(tree: &Tree, from: &ModulePath, path: &[String], depth: usize) -> Option<ModulePath> {
    let (first, rest) = path.split_first()?;
    let joined = |start: &[String], rest: &[String]| Some([start, rest].concat());
    match first.as_str() {
        "crate" => joined(&[], rest),
        "self" => joined(from, rest),
        "super" => {
            let (_, parent) = from.split_last()?;
            match rest.first().map(String::as_str) {
                Some("super") => absolute(tree, &parent.to_vec(), rest, depth),
                _ => joined(parent, rest),
            }
        }
        _ => {
            let child = [&from[..], std::slice::from_ref(first)].concat();
            if tree.get(&child).is_some() {
                return joined(&child, rest);
            }
            let import = import(tree, from, first)?;
            let start = absolute(tree, from, import, depth.checked_sub(1)?)?;
            joined(&start, rest)
        }
    }
}

/// The path that a module imports under a name.
fn import<'t>(tree: &'t Tree, module: &ModulePath, name: &str) -> Option<&'t [String]> {
    let imports = &tree.get(module)?.source.imports;
    let (_, path) = imports.iter().find(|(imported, _)| imported == name)?;
    // `use rand;`: the name itself, of another crate.
    (path[..] != [name]).then_some(path)
}

fn walk(tree: &Tree, path: &[String], depth: usize, found: &mut Vec<ModulePath>) {
    let known = |length: &usize| tree.get(&path[..*length]).is_some();
    let length = (0..=path.len()).rev().find(known).unwrap_or(0);
    let (module, rest) = (path[..length].to_vec(), &path[length..]);
    if let (Some((name, rest)), Some(depth)) = (rest.split_first(), depth.checked_sub(1)) {
        let imported = import(tree, &module, name)
            .and_then(|import| absolute(tree, &module, import, depth))
            .or_else(|| from_glob(tree, &module, name, depth));
        if let Some(start) = imported {
            walk(tree, &[&start[..], rest].concat(), depth, found);
        }
    }
    found.push(module);
}

/// The path of a name that a module has from a `use other::*`.
fn from_glob(tree: &Tree, module: &ModulePath, name: &str, depth: usize) -> Option<ModulePath> {
    let source = &tree.get(module)?.source;
    if source.items.iter().any(|item| item == name) {
        return None;
    }
    source.globs.iter().find_map(|glob| {
        let mut path = absolute(tree, module, glob, depth)?;
        let other = &tree.get(&path)?.source;
        let defines = other.items.iter().any(|item| item == name);
        let imports = other.imports.iter().any(|(import, _)| import == name);
        (defines || imports).then(|| {
            path.push(name.to_owned());
            path
        })
    })
}

#[cfg(test)]
mod tests {
    use super::super::tree::tests::tree;
    use super::*;

    fn resolved(tree: &Tree, from: &str, path: &str) -> Vec<String> {
        let split = |path: &str| path.split("::").map(str::to_owned).collect::<Vec<_>>();
        let found = resolve(tree, &split(from), &split(path));
        found.iter().map(|path| path.join("::")).collect()
    }

    fn example() -> Tree {
        tree(&[
            ("", "mod a; mod b; pub use b::leaf::Item as Renamed;"),
            ("a", "mod x; use crate::b; use rand;"),
            (
                "a::x",
                "use super::super::b::leaf as other; use other::Loop; ",
            ),
            (
                "b",
                "mod leaf; pub use leaf::Item; pub use leaf::*; pub use rand::Rng;",
            ),
            ("b::leaf", "pub struct Item; pub fn free() {} mod deep;"),
            ("b::leaf::deep", ""),
        ])
    }

    #[test]
    fn a_path_leads_to_its_deepest_module() {
        let tree = example();
        assert_eq!(resolved(&tree, "a::x", "crate::b::leaf::Item"), ["b::leaf"]);
        assert_eq!(
            resolved(&tree, "a::x", "super::super::b::leaf"),
            ["b::leaf"]
        );
        assert_eq!(
            resolved(&tree, "a::x", "crate::b::leaf::deep"),
            ["b::leaf::deep"]
        );
        assert_eq!(resolved(&tree, "b", "leaf::Item::new"), ["b::leaf"]);
        assert_eq!(resolved(&tree, "b::leaf", "self::deep"), ["b::leaf::deep"]);
    }

    #[test]
    fn re_exports_lead_to_both_modules() {
        let tree = example();
        assert_eq!(resolved(&tree, "a", "crate::b::Item"), ["b::leaf", "b"]);
        assert_eq!(resolved(&tree, "a", "crate::b::free"), ["b::leaf", "b"]);
        assert_eq!(resolved(&tree, "a", "crate::Renamed"), ["b::leaf", ""]);
        assert_eq!(resolved(&tree, "a", "crate::b::Rng"), ["b"]);
    }

    #[test]
    fn imported_names_are_followed_and_other_crates_are_none() {
        let tree = example();
        assert_eq!(resolved(&tree, "a", "b::leaf::free"), ["b::leaf"]);
        assert_eq!(resolved(&tree, "a::x", "other::free"), ["b::leaf"]);
        for path in [
            "rand::Rng",
            "rand",
            "std::fmt",
            "Self::new",
            "super::super::super::z",
        ] {
            assert!(resolved(&tree, "a", path).is_empty(), "{path}");
        }
    }

    #[test]
    fn a_circle_of_names_ends() {
        let tree = tree(&[
            ("", "mod a; mod b;"),
            ("a", "pub use crate::b::T;"),
            ("b", "pub use crate::a::T;"),
        ]);
        let found = resolved(&tree, "a", "crate::b::T");
        assert!(found.iter().all(|module| module == "a" || module == "b"));
    }
}
