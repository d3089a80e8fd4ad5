//! The graph of each level: which of its modules imports which.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt,
};

use super::resolve::resolve;
use super::tree::{ModulePath, Site, Tree};

/// The modules with one parent, and the imports between them.
#[derive(Default)]
pub struct Level {
    /// The parent's path, empty for the crate's root.
    pub parent: ModulePath,
    /// Names of the modules.
    pub modules: BTreeSet<String>,
    /// By importing and imported module: every place of such an import, itself or inside.
    pub edges: BTreeMap<(String, String), BTreeSet<Site>>,
}

impl Level {
    /// The levels of a crate that have two modules or more, parents before children.
    pub fn all(tree: &Tree) -> Vec<Self> {
        let mut levels: BTreeMap<ModulePath, Self> = BTreeMap::new();
        for (path, _) in tree.modules() {
            if let Some((name, parent)) = path.split_last() {
                let level = levels.entry(parent.to_vec()).or_default();
                level.parent = parent.to_vec();
                level.modules.insert(name.clone());
            }
        }
        for (from, module) in tree.modules() {
            for (path, line) in &module.source.references {
                for to in resolve(tree, from, path) {
                    let site = Site {
                        file: module.file.clone(),
                        line: *line,
                    };
                    add_edge(&mut levels, from, &to, site);
                }
            }
        }
        let mut levels: Vec<_> = levels.into_values().collect();
        levels.retain(|level| level.modules.len() > 1);
        levels
    }

    /// The modules that one imports.
    fn imports_of(&self, module: &str) -> impl Iterator<Item = &str> {
        let edges = self.edges.keys();
        edges.filter_map(move |(from, to)| (from == module).then_some(to.as_str()))
    }

    /// The modules in an order in which they import later ones only, as far as there is one.
    fn top_down(&self) -> Vec<&str> {
        let mut left: BTreeSet<&str> = self.modules.iter().map(String::as_str).collect();
        let mut order = Vec::new();
        while let Some(&first) = left.first() {
            let is_imported = |module: &&str| {
                let mut importers = left.iter().filter(|importer| *importer != module);
                importers.any(|importer| self.imports_of(importer).any(|to| to == *module))
            };
            let next = left.iter().copied().find(|module| !is_imported(module));
            let next = next.unwrap_or(first);
            left.remove(next);
            order.push(next);
        }
        order
    }
}

/// Adds the edge between the two modules' ancestors that have one parent; none where one of them is
/// an ancestor of the other.
fn add_edge(
    levels: &mut BTreeMap<ModulePath, Level>,
    from: &ModulePath,
    to: &ModulePath,
    site: Site,
) {
    let common = from.iter().zip(to).take_while(|(a, b)| a == b).count();
    if let (Some(importer), Some(imported)) = (from.get(common), to.get(common))
        && let Some(level) = levels.get_mut(&from[..common])
    {
        let edge = (importer.clone(), imported.clone());
        level.edges.entry(edge).or_default().insert(site);
    }
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let indent = "  ".repeat(1 + self.parent.len());
        if let Some(name) = self.parent.last() {
            write!(f, "{indent}in {name}: ")?;
        } else {
            write!(f, "{indent}")?;
        }
        let mut unconnected = Vec::new();
        let mut lines = Vec::new();
        for module in self.top_down() {
            let imports: Vec<_> = self.imports_of(module).collect();
            let imported = self.edges.keys().any(|(_, to)| to == module);
            if imports.is_empty() && !imported {
                unconnected.push(module);
            } else if !imports.is_empty() {
                lines.push(format!("{module} -> {}", imports.join(", ")));
            }
        }
        let count = self.modules.len();
        write!(f, "{count} modules")?;
        if !unconnected.is_empty() {
            write!(f, ", unconnected: {}", unconnected.join(", "))?;
        }
        for line in lines {
            write!(f, "\n{indent}  {line}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
pub mod tests {
    use super::super::tree::tests::tree;
    use super::*;

    /// The edges of each level, as `level: from -> to`.
    fn edges(levels: &[Level]) -> Vec<String> {
        let of = |level: &Level| {
            let parent = level.parent.join("::");
            let edges = level.edges.keys().cloned();
            edges
                .map(|(from, to)| format!("{parent}: {from} -> {to}"))
                .collect::<Vec<_>>()
        };
        levels.iter().flat_map(of).collect()
    }

    #[test]
    fn an_import_is_an_edge_at_the_level_of_the_common_parent() {
        let levels = Level::all(&tree(&[
            ("", "mod a; mod b; use a::x::T;"),
            ("a", "mod x; mod y; use x::T;"),
            (
                "a::x",
                "use super::y::U;\nuse crate::b;\nuse super::V; struct T;",
            ),
            ("a::y", "use crate::b::f;"),
            ("b", ""),
        ]));
        assert_eq!(edges(&levels), [": a -> b", "a: x -> y"]);
        let sites = &levels[0].edges[&("a".to_owned(), "b".to_owned())];
        let sites: Vec<_> = sites
            .iter()
            .map(|site| (site.file.to_str().unwrap(), site.line))
            .collect();
        assert_eq!(sites, [("a/x.rs", 2), ("a/y.rs", 1)]);
    }

    #[test]
    fn a_re_export_of_the_parent_leads_to_the_sibling() {
        let levels = Level::all(&tree(&[
            ("", "mod a;"),
            ("a", "mod x; mod y; pub use y::U;"),
            ("a::x", "use super::U;"),
            ("a::y", "pub struct U;"),
        ]));
        assert_eq!(edges(&levels), ["a: x -> y"]);
    }

    #[test]
    fn a_level_is_printed_from_the_top() {
        let levels = Level::all(&tree(&[
            ("", "mod a; mod b; mod c; mod d;"),
            ("a", ""),
            ("b", "use crate::{a, c};"),
            ("c", "use crate::a;"),
            ("d", ""),
        ]));
        assert_eq!(levels[0].top_down(), ["b", "c", "a", "d"]);
        assert_eq!(
            levels[0].to_string(),
            "  4 modules, unconnected: d\n    b -> a, c\n    c -> a"
        );
    }
}
