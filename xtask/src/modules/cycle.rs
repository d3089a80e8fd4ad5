//! Import cycles among the modules of a level.

use std::{collections::BTreeSet, fmt, path::Path};

use super::graph::Level;

/// Sites of an edge that are printed; of the others their number.
const MAX_SITES: usize = 3;

/// Modules each of which imports, directly or by others of them, every other one.
#[derive(PartialEq, Eq, Debug)]
pub struct Cycle {
    /// Their names.
    pub modules: BTreeSet<String>,
}

/// The cycles of a level: its strongly connected components of two modules or more.
pub fn find(level: &Level) -> Vec<Cycle> {
    let reachable = |from: &String| {
        let mut found = BTreeSet::new();
        let mut open = vec![from];
        while let Some(module) = open.pop() {
            for (importer, imported) in level.edges.keys() {
                if importer == module && found.insert(imported.clone()) {
                    open.push(imported);
                }
            }
        }
        found
    };
    let mut cycles: Vec<Cycle> = Vec::new();
    for module in &level.modules {
        let known = |cycle: &Cycle| cycle.modules.contains(module);
        let mut modules = reachable(module);
        if modules.contains(module) && !cycles.iter().any(known) {
            modules.retain(|other| reachable(other).contains(module));
            cycles.push(Cycle { modules });
        }
    }
    cycles
}

impl Cycle {
    /// With the places of all its imports, relative to `root`.
    pub fn display(&self, level: &Level, root: &Path) -> impl fmt::Display {
        let parent = [&["crate".to_owned()], &level.parent[..]].concat();
        let names: Vec<_> = self.modules.iter().map(String::as_str).collect();
        let mut text = format!(
            "IMPORT CYCLE in {}: {}",
            parent.join("::"),
            names.join(", ")
        );
        for ((from, to), sites) in &level.edges {
            if self.modules.contains(from) && self.modules.contains(to) {
                let shown: Vec<_> = sites.iter().take(MAX_SITES).collect();
                let places: Vec<_> = shown.iter().map(|site| site.below(root)).collect();
                text += &format!("\n  {from} -> {to}: {}", places.join(", "));
                if sites.len() > shown.len() {
                    text += &format!(" and {} more", sites.len() - shown.len());
                }
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::super::tree::tests::tree;
    use super::*;

    #[test]
    fn a_cycle_is_found_with_both_places() {
        let levels = Level::all(&tree(&[
            ("", "mod estimate; mod metric; mod teacher;"),
            ("estimate", "use crate::metric::M;\nuse crate::teacher::T;"),
            ("metric", ""),
            ("teacher", "mod loss;"),
            ("teacher::loss", "fn f() {\n crate::estimate::g()\n}"),
        ]));
        let cycles = find(&levels[0]);
        assert_eq!(cycles.len(), 1);
        let text = cycles[0].display(&levels[0], Path::new("")).to_string();
        assert_eq!(
            text,
            "IMPORT CYCLE in crate: estimate, teacher\n  \
             estimate -> teacher: estimate.rs:2\n  \
             teacher -> estimate: teacher/loss.rs:2"
        );
    }

    #[test]
    fn a_cycle_of_three_and_one_of_two_are_two() {
        let levels = Level::all(&tree(&[
            ("", "mod a; mod b; mod c; mod d; mod e; mod f;"),
            ("a", "use crate::b;"),
            ("b", "use crate::c;"),
            ("c", "use crate::a; use crate::d;"),
            ("d", "use crate::e;"),
            ("e", "use crate::d; use crate::f;"),
            ("f", ""),
        ]));
        let cycles = find(&levels[0]);
        let names: Vec<_> = cycles
            .iter()
            .map(|cycle| cycle.modules.iter().map(String::as_str).collect::<String>())
            .collect();
        assert_eq!(names, ["abc", "de"]);
    }

    #[test]
    fn imports_of_tests_make_no_cycle_and_neither_do_parents() {
        let levels = Level::all(&tree(&[
            ("", "mod a; mod b; use b::leaf::T;"),
            (
                "a",
                "use crate::b;\n#[cfg(test)] mod tests { use super::*; }",
            ),
            ("b", "mod leaf; #[cfg(test)] mod tests { use crate::a; }"),
            ("b::leaf", "use super::U;"),
        ]));
        assert!(levels.iter().all(|level| find(level).is_empty()));
    }
}
