//! The imports between modules, checked: no cycle between modules of one level, no file over the
//! limit of lines.
//!
//! A level is the set of modules with one parent: those of a crate's root, and those of each folder.
//! An import from `a::b` to `c::d` is an edge from `a` to `c` at the root; one from `a::b` to `a::c`
//! is an edge from `b` to `c` inside `a`. Imports between a module and its own parent are no edge.
//! The sources are parsed and not compiled, so features, targets and unfinished work do not matter.

mod cfg;
mod cycle;
mod graph;
mod length;
mod parse;
mod resolve;
mod tree;
mod workspace;

use std::{env, path::PathBuf};

use anyhow::{Result, ensure};

use graph::Level;
use tree::Tree;

/// What to check.
#[derive(clap::Args)]
pub struct Arguments {
    /// Folder of another workspace to check; otherwise this one.
    #[arg(long, value_name = "DIR")]
    workspace: Option<PathBuf>,
}

/// Prints the module graph of every crate and the files that are too long.
///
/// # Errors
/// When there is an import cycle, or a file that is too long; also when a source cannot be read or
/// parsed.
pub fn check(arguments: &Arguments) -> Result<()> {
    let root = match &arguments.workspace {
        Some(folder) => folder.clone(),
        None => crate::workspace(),
    };
    let root = env::current_dir()?.join(root).canonicalize()?;
    let (mut cycles, mut missing, mut tests) = (0, 0, Vec::new());
    for target in workspace::targets(&root)? {
        let tree = Tree::load(&target.root)?;
        let levels = Level::all(&tree);
        if !levels.is_empty() {
            println!("{}", target.name);
        }
        tests.extend_from_slice(tree.tests());
        for module in tree.missing() {
            missing += 1;
            let site = module.site.below(&root);
            println!("NO FILE of the module {}: {site}", module.name);
        }
        for level in &levels {
            println!("{level}");
            for cycle in cycle::find(level) {
                cycles += 1;
                println!("{}", cycle.display(level, &root));
            }
        }
    }
    let lengths = length::check(&root, &tests)?;
    println!("{lengths}");
    let faults = lengths.faults();
    ensure!(
        cycles == 0 && missing == 0 && faults == 0,
        "{cycles} import cycles, {missing} modules without a file, {faults} faults of file length"
    );
    println!("no import cycle, no file over {} lines", length::LIMIT);
    Ok(())
}
