//! Parses one source file: its modules, and what they define, import and refer to.
//!
//! Code that is compiled for tests alone is left out.

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{Attribute, Expr, ImplItem, Item, ItemMod, Lit, Meta, UseTree};

use super::cfg::is_test;

/// A path as it is written: `crate`, `super` and `self` included.
pub type Path = Vec<String>;

/// One module of a file: the file itself, or one in braces.
#[derive(Default)]
pub struct Source {
    /// Names that it defines.
    pub items: Vec<String>,
    /// Names that its `use` items bring in, and their paths.
    pub imports: Vec<(String, Path)>,
    /// Paths of its `use path::*`.
    pub globs: Vec<Path>,
    /// Every path of two or more segments, and those of `use` items, with the line.
    pub references: Vec<(Path, usize)>,
    /// Modules in braces.
    pub inline: Vec<(String, Source)>,
    /// Modules in files of their own.
    pub files: Vec<File>,
    /// Those of them that are compiled for tests alone: nothing else of them is known.
    pub test_files: Vec<File>,
    /// How many items are around what is being visited: 0 at the module's top.
    depth: usize,
}

/// `mod name;`
pub struct File {
    /// The module's name.
    pub name: String,
    /// What `#[path]` names.
    pub path: Option<String>,
    /// The line of the declaration.
    pub line: usize,
}

impl File {
    fn new(module: &ItemMod) -> Self {
        Self {
            name: module.ident.to_string(),
            path: module.attrs.iter().find_map(path_attribute),
            line: module.ident.span().start().line,
        }
    }
}

/// Parses a file.
///
/// # Errors
/// When it is no Rust.
pub fn parse(text: &str) -> syn::Result<Source> {
    let mut source = Source::default();
    for item in &syn::parse_file(text)?.items {
        source.visit_item(item);
    }
    Ok(source)
}

impl Source {
    fn add_module(&mut self, module: &ItemMod) {
        let name = module.ident.to_string();
        if let Some((_, items)) = &module.content {
            let mut inner = Self::default();
            for item in items {
                inner.visit_item(item);
            }
            self.inline.push((name, inner));
        } else {
            self.files.push(File::new(module));
        }
    }

    /// The leaves of a `use` item. They are names of the whole module if it is at the module's top.
    fn add_use(&mut self, tree: &UseTree, prefix: &Path) {
        let top = self.depth == 0;
        let joined = |ident: &proc_macro2::Ident| {
            let mut path = prefix.clone();
            // `use a::{self}` is `use a`.
            if prefix.is_empty() || ident != "self" {
                path.push(ident.to_string());
            }
            path
        };
        let (name, path, line) = match tree {
            UseTree::Path(step) => return self.add_use(&step.tree, &joined(&step.ident)),
            UseTree::Group(group) => {
                let trees = group.items.iter();
                return trees.for_each(|tree| self.add_use(tree, prefix));
            }
            UseTree::Glob(glob) => {
                if top {
                    self.globs.push(prefix.clone());
                }
                let line = glob.star_token.spans[0].start().line;
                return self.references.push((prefix.clone(), line));
            }
            UseTree::Name(leaf) => {
                let path = joined(&leaf.ident);
                (path.last().cloned(), path, leaf.ident.span())
            }
            UseTree::Rename(leaf) => (
                Some(leaf.rename.to_string()),
                joined(&leaf.ident),
                leaf.ident.span(),
            ),
        };
        let line = line.start().line;
        if let Some(name) = name.filter(|_| top) {
            self.imports.push((name, path.clone()));
        }
        self.references.push((path, line));
    }

    /// Paths in a macro's arguments, which are tokens and nothing more.
    fn add_tokens(&mut self, tokens: TokenStream) {
        let (mut path, mut line, mut colons) = (Path::new(), 0, 0);
        for token in tokens {
            match token {
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.add_path(&mut path, line);
                    }
                    if path.is_empty() {
                        line = ident.span().start().line;
                    }
                    path.push(ident.to_string());
                    colons = 0;
                }
                TokenTree::Punct(punct) if punct.as_char() == ':' => colons += 1,
                TokenTree::Group(group) => {
                    self.add_path(&mut path, line);
                    self.add_tokens(group.stream());
                    colons = 0;
                }
                _ => {
                    self.add_path(&mut path, line);
                    colons = 0;
                }
            }
        }
        self.add_path(&mut path, line);
    }

    fn add_path(&mut self, path: &mut Path, line: usize) {
        let path = std::mem::take(path);
        if path.len() > 1 {
            self.references.push((path, line));
        }
    }
}

impl<'ast> Visit<'ast> for Source {
    fn visit_item(&mut self, item: &'ast Item) {
        let (attributes, name) = describe(item);
        if attributes.iter().any(is_test) {
            if let Item::Mod(module) = item
                && module.content.is_none()
            {
                self.test_files.push(File::new(module));
            }
            return;
        }
        self.items.extend(name.filter(|_| self.depth == 0));
        match item {
            Item::Mod(module) => self.add_module(module),
            // `use ::name` is another crate.
            Item::Use(item) if item.leading_colon.is_none() => {
                self.add_use(&item.tree, &Path::new());
            }
            Item::Use(_) => {}
            _ => {
                self.depth += 1;
                visit::visit_item(self, item);
                self.depth -= 1;
            }
        }
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        let is_test_only = match item {
            ImplItem::Const(item) => item.attrs.iter().any(is_test),
            ImplItem::Fn(item) => item.attrs.iter().any(is_test),
            ImplItem::Type(item) => item.attrs.iter().any(is_test),
            _ => false,
        };
        if !is_test_only {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let segments = path.segments.iter();
        let mut names = segments.map(|segment| segment.ident.to_string()).collect();
        if path.leading_colon.is_none()
            && let Some(first) = path.segments.first()
        {
            self.add_path(&mut names, first.ident.span().start().line);
        }
        visit::visit_path(self, path);
    }

    fn visit_token_stream(&mut self, tokens: &'ast TokenStream) {
        self.add_tokens(tokens.clone());
    }
}

/// An item's attributes, and the name that it defines, if it does.
fn describe(item: &Item) -> (&[Attribute], Option<String>) {
    let (attributes, name) = match item {
        Item::Const(item) => (&item.attrs, Some(&item.ident)),
        Item::Enum(item) => (&item.attrs, Some(&item.ident)),
        Item::Fn(item) => (&item.attrs, Some(&item.sig.ident)),
        Item::ForeignMod(item) => (&item.attrs, None),
        Item::Impl(item) => (&item.attrs, None),
        Item::Macro(item) => (&item.attrs, item.ident.as_ref()),
        Item::Mod(item) => (&item.attrs, Some(&item.ident)),
        Item::Static(item) => (&item.attrs, Some(&item.ident)),
        Item::Struct(item) => (&item.attrs, Some(&item.ident)),
        Item::Trait(item) => (&item.attrs, Some(&item.ident)),
        Item::Type(item) => (&item.attrs, Some(&item.ident)),
        Item::Union(item) => (&item.attrs, Some(&item.ident)),
        Item::Use(item) => (&item.attrs, None),
        _ => return (&[], None),
    };
    (attributes, name.map(ToString::to_string))
}

fn path_attribute(attribute: &Attribute) -> Option<String> {
    match &attribute.meta {
        Meta::NameValue(meta) if meta.path.is_ident("path") => match &meta.value {
            Expr::Lit(literal) => match &literal.lit {
                Lit::Str(path) => Some(path.value()),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn references(text: &str) -> Vec<(String, usize)> {
        let source = parse(text).unwrap();
        let joined = |(path, line): (Path, usize)| (path.join("::"), line);
        source.references.into_iter().map(joined).collect()
    }

    fn names(text: &str) -> Vec<String> {
        references(text).into_iter().map(|(path, _)| path).collect()
    }

    #[test]
    fn every_leaf_of_a_use_is_a_reference_with_its_line() {
        let text = "use crate::{a::{self, B as C},\n d::*};\nuse e;";
        let expected = [
            ("crate::a", 1),
            ("crate::a::B", 1),
            ("crate::d", 2),
            ("e", 3),
        ];
        assert_eq!(
            references(text),
            expected.map(|(path, line)| (path.to_owned(), line))
        );
        let imports = parse(text).unwrap().imports;
        let imports: Vec<_> = imports.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(imports, ["a", "C", "e"]);
    }

    #[test]
    fn paths_in_code_types_and_macros_are_references() {
        let text =
            "fn f(x: super::T<crate::a::U>) -> T { println!(\"{}\", [crate::b::c(x: d::e)]) }";
        assert_eq!(
            names(text),
            ["super::T", "crate::a::U", "crate::b::c", "d::e"]
        );
        assert_eq!(names("fn f() { use crate::g::h; }"), ["crate::g::h"]);
        assert!(
            parse("fn f() { use crate::g::h; }")
                .unwrap()
                .imports
                .is_empty()
        );
        // A path of another crate, whatever modules are called here.
        assert!(names("fn f() { ::g::h() }").is_empty());
    }

    #[test]
    fn code_for_tests_is_left_out() {
        for text in [
            "#[cfg(test)] fn f() { crate::a::b() }",
            "#[cfg(test)] use crate::a::b;",
            "impl T { #[cfg(test)] fn f() { crate::a::b() } }",
        ] {
            assert!(names(text).is_empty(), "{text}");
        }
        let text = "#[cfg(unix)] fn f() { crate::a::b() }";
        assert_eq!(names(text), ["crate::a::b"]);
    }

    #[test]
    fn modules_are_in_braces_or_in_files() {
        let text = "mod a { use super::b; }\n#[path = \"x/y.rs\"] mod c;\n#[cfg(test)] mod tests;";
        let source = parse(text).unwrap();
        assert_eq!(source.inline[0].0, "a");
        assert_eq!(source.inline[0].1.references.len(), 1);
        let [file] = &source.files[..] else {
            panic!("one file");
        };
        assert_eq!((file.name.as_str(), file.line), ("c", 2));
        assert_eq!(file.path.as_deref(), Some("x/y.rs"));
        let tests: Vec<_> = source.test_files.iter().map(|file| &file.name).collect();
        assert_eq!(tests, ["tests"]);
    }

    #[test]
    fn what_is_no_rust_is_refused() {
        assert!(parse("fn {").is_err());
    }
}
