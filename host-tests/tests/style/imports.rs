//! Imports between the files of a crate: each name is followed over re-exports to the file that defines it.

use std::path::Path;

use syn::visit::Visit;

use crate::circles::Graph;
use crate::modules::{Module, ModulePath, Tree};

/// Steps over re-exports after which a name counts as not found.
const MAX_STEPS: usize = 16;

/// The graph of a crate's files.
pub fn imports(tree: &Tree) -> Graph {
    let mut graph = Graph::new();
    for (path, module) in &tree.modules {
        let mut used: Vec<Vec<String>> = module.imports.iter().map(|import| import.path.clone()).collect();
        let mut paths = Paths(&mut used);
        module.items.iter().for_each(|item| paths.visit_item(item));
        let file = name(&module.file);
        let targets = graph.entry(file.clone()).or_default();
        for used in used {
            if let Some(target) = defining_file(tree, path, &used, MAX_STEPS).map(name)
                && target != file
            {
                targets.insert(target);
            }
        }
    }
    graph
}

fn name(file: &Path) -> String {
    let file = file.to_string_lossy();
    file.rsplit_once("/../").map_or(file.as_ref(), |(_, name)| name).to_owned()
}

/// Paths of more than one segment in expressions, types and patterns.
struct Paths<'a>(&'a mut Vec<Vec<String>>);

impl<'ast> Visit<'ast> for Paths<'_> {
    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.segments.len() > 1 && path.leading_colon.is_none() {
            self.0.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        }
        syn::visit::visit_path(self, path);
    }
}

/// The file which defines what a path names, as seen from a module; `None` for names of other crates.
fn defining_file<'a>(tree: &'a Tree, from: &ModulePath, path: &[String], steps: usize) -> Option<&'a Path> {
    let mut module = from.clone();
    let mut rest = path;
    match rest.first()?.as_str() {
        "crate" => {
            module.clear();
            rest = &rest[1..];
        }
        "self" => rest = &rest[1..],
        "super" => {}
        first => {
            let mut child = module.clone();
            child.push(first.to_owned());
            if !tree.modules.contains_key(&child) {
                return local(tree, from, path, steps);
            }
        }
    }
    while rest.first().is_some_and(|first| first == "super") {
        module.pop()?;
        rest = &rest[1..];
    }
    find(tree, module, rest, steps)
}

/// A path that begins with a name which the module imports, such as `numeric::divide` after `use crate::numeric`.
fn local<'a>(tree: &'a Tree, from: &ModulePath, path: &[String], steps: usize) -> Option<&'a Path> {
    let first = path.first()?;
    let import = tree.modules.get(from)?.imports.iter().find(|import| import.name.as_ref() == Some(first))?;
    // `use tool::tool` would be followed without end.
    let steps = steps.checked_sub(1)?;
    let full: Vec<String> = import.path.iter().chain(&path[1..]).cloned().collect();
    if import.path.first() == Some(first) { None } else { defining_file(tree, from, &full, steps) }
}

/// Follows the rest of a path from a module.
fn find<'a>(tree: &'a Tree, mut module: ModulePath, path: &[String], steps: usize) -> Option<&'a Path> {
    let steps = steps.checked_sub(1)?;
    for (at, segment) in path.iter().enumerate() {
        let mut child = module.clone();
        child.push(segment.clone());
        if tree.modules.contains_key(&child) {
            module = child;
            continue;
        }
        let here = tree.modules.get(&module)?;
        if here.defined.contains(segment) {
            return Some(&here.file);
        }
        return reexported(tree, &module, here, &path[at..], steps).or(Some(&here.file));
    }
    tree.modules.get(&module).map(|module| module.file.as_path())
}

fn reexported<'a>(tree: &'a Tree, at: &ModulePath, module: &Module, path: &[String], steps: usize) -> Option<&'a Path> {
    let name = path.first()?;
    if let Some(import) = module.imports.iter().find(|import| import.name.as_ref() == Some(name)) {
        let full: Vec<String> = import.path.iter().chain(&path[1..]).cloned().collect();
        return defining_file(tree, at, &full, steps);
    }
    // Of globs only public ones bring a name to others.
    let mut globs = module.imports.iter().filter(|import| import.name.is_none() && import.is_public);
    globs.find_map(|import| {
        let full: Vec<String> = import.path.iter().chain(path).cloned().collect();
        defining_file(tree, at, &full, steps)
    })
}
