//! The modules of a crate: files, definitions, re-exports.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use syn::{Attribute, Item, Meta, UseTree, Visibility};

/// Names of a module from the crate's root; the root's is empty.
pub type ModulePath = Vec<String>;

/// A name that a module imports or re-exports.
pub struct Import {
    /// As written, from the importing module.
    pub path: Vec<String>,
    /// Its name here; `None` for a glob.
    pub name: Option<String>,
    pub is_public: bool,
}

/// A module.
pub struct Module {
    /// Its file; that of the parent where it stands inline.
    pub file: PathBuf,
    /// Names of its own items, modules left out.
    pub defined: BTreeSet<String>,
    pub imports: Vec<Import>,
    pub items: Vec<Item>,
}

/// All modules of a crate, without tests.
pub struct Tree {
    pub modules: BTreeMap<ModulePath, Module>,
}

impl Tree {
    /// Reads a crate from its root file.
    pub fn read(root: &Path) -> Self {
        let mut tree = Self { modules: BTreeMap::new() };
        let folder = root.parent().expect("a file is in a folder").to_owned();
        tree.read_file(root, &folder, Vec::new());
        tree
    }

    fn read_file(&mut self, file: &Path, folder: &Path, path: ModulePath) {
        let text = fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let parsed = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        self.add(file, folder, path, parsed.items);
    }

    fn add(&mut self, file: &Path, folder: &Path, path: ModulePath, items: Vec<Item>) {
        let mut module =
            Module { file: file.to_owned(), defined: BTreeSet::new(), imports: Vec::new(), items: Vec::new() };
        for item in items {
            match item {
                Item::Mod(child) if is_test(&child.attrs) => {}
                Item::Mod(child) => {
                    let name = child.ident.to_string();
                    let mut child_path = path.clone();
                    child_path.push(name.clone());
                    let child_folder = folder.join(&name);
                    if let Some((_, items)) = child.content {
                        self.add(file, &child_folder, child_path, items);
                    } else {
                        let flat = folder.join(format!("{name}.rs"));
                        let child_file = if flat.exists() { flat } else { child_folder.join("mod.rs") };
                        self.read_file(&child_file, &child_folder, child_path);
                    }
                }
                Item::Use(import) => {
                    let is_public = !matches!(import.vis, Visibility::Inherited);
                    flatten(&import.tree, &mut Vec::new(), is_public, &mut module.imports);
                }
                item => {
                    module.defined.extend(name(&item));
                    module.items.push(item);
                }
            }
        }
        self.modules.insert(path, module);
    }
}

fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::List(list) => list.path.is_ident("cfg") && list.tokens.to_string() == "test",
        _ => false,
    })
}

fn flatten(tree: &UseTree, path: &mut Vec<String>, is_public: bool, imports: &mut Vec<Import>) {
    let mut import = |path: Vec<String>, name| imports.push(Import { path, name, is_public });
    let with = |path: &[String], name: String| path.iter().cloned().chain([name]).collect::<Vec<_>>();
    match tree {
        UseTree::Path(tree) => {
            path.push(tree.ident.to_string());
            flatten(&tree.tree, path, is_public, imports);
            path.pop();
        }
        // `use a::{self}` imports a itself.
        UseTree::Name(tree) if tree.ident == "self" => import(path.clone(), path.last().cloned()),
        UseTree::Name(tree) => import(with(path, tree.ident.to_string()), Some(tree.ident.to_string())),
        UseTree::Rename(tree) => import(with(path, tree.ident.to_string()), Some(tree.rename.to_string())),
        UseTree::Glob(_) => import(path.clone(), None),
        UseTree::Group(tree) => tree.items.iter().for_each(|tree| flatten(tree, path, is_public, imports)),
    }
}

fn name(item: &Item) -> Option<String> {
    let name = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        Item::Macro(item) => item.ident.as_ref()?,
        _ => return None,
    };
    Some(name.to_string())
}
