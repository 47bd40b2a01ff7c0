//! The source files of the workspace as modules, without what only tests use.

use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};
use syn::{Attribute, Item, UseTree, Visibility};

/// A module's place in its crate: `["report", "page"]` is `crate::report::page`.
pub(super) type ModulePath = Vec<String>;

/// One source file of a crate.
pub(super) struct SourceModule {
    /// Its place in the crate.
    pub(super) place: ModulePath,
    /// Names that its `use` lines bring in, and where they come from, with whether it passes them on.
    imports: BTreeMap<String, Import>,
    /// Modules that it imports everything of, and whether it passes all of that on.
    globs: Vec<(Vec<String>, bool)>,
    /// The names that it defines.
    defined: BTreeSet<String>,
    /// Paths of at least two words in its code.
    paths: Vec<Vec<String>>,
    /// Its public types.
    pub(super) public_types: Vec<String>,
    /// All its types.
    pub(super) types: Vec<String>,
}

struct Import {
    target: Vec<String>,
    is_public: bool,
}

/// All source files of a crate, by their places.
pub(super) struct CrateModules(BTreeMap<ModulePath, SourceModule>);

impl CrateModules {
    /// Reads the crate in a folder.
    pub(super) fn read(crate_folder: &Path) -> Self {
        let root = crate_folder.join("src");
        let files = super::sources(&root);
        let modules = files.iter().filter_map(|file| SourceModule::read(&root, file));
        Self(modules.map(|module| (module.place.clone(), module)).collect())
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &SourceModule> {
        self.0.values()
    }

    /// The modules that a module uses, wherever the names come from in the end: re-exports are followed.
    pub(super) fn used_by(&self, module: &SourceModule) -> BTreeSet<ModulePath> {
        let imported = module.imports.values().map(|import| import.target.clone());
        let globs = module.globs.iter().map(|(target, _)| [target.as_slice(), &["*".to_owned()]].concat());
        let paths = module.paths.iter().filter_map(|path| {
            let first = path.first()?;
            match module.imports.get(first) {
                Some(import) => Some([&import.target, &path[1..]].concat()),
                None if is_relative(first) || self.0.contains_key(&joined(&module.place, first)) => Some(path.clone()),
                None => None,
            }
        });
        imported.chain(globs).chain(paths).filter_map(|path| self.owner(&module.place, &path, 0)).collect()
    }

    /// The module that owns what a path names; `None` if that is a module, or belongs to another crate.
    fn owner(&self, from: &ModulePath, path: &[String], depth: usize) -> Option<ModulePath> {
        let mut place = from.clone();
        let mut rest = path;
        match rest.first()?.as_str() {
            "crate" => (place, rest) = (Vec::new(), &rest[1..]),
            "self" | "super" => {}
            first if self.0.contains_key(&joined(from, first)) => {}
            _ => return None,
        }
        while let Some(word) = rest.first() {
            match word.as_str() {
                "self" => {}
                "super" => {
                    place.pop()?;
                }
                word if self.0.contains_key(&joined(&place, word)) => place.push(word.to_owned()),
                "*" => return Some(place),
                word => return self.definer(&place, word, depth),
            }
            rest = &rest[1..];
        }
        None
    }

    /// The module that defines a name which a module has, perhaps by passing it on.
    fn definer(&self, place: &ModulePath, name: &str, depth: usize) -> Option<ModulePath> {
        const MAX_RE_EXPORTS: usize = 8;
        let module = self.0.get(place)?;
        if module.defined.contains(name) || depth > MAX_RE_EXPORTS {
            return Some(place.clone());
        }
        if let Some(import) = module.imports.get(name) {
            return match self.owner(place, &import.target, depth + 1) {
                Some(owner) => Some(owner),
                // Another crate's, or a module.
                None => import.is_public.then(|| place.clone()),
            };
        }
        let through = module.globs.iter().filter(|(_, is_public)| *is_public).find_map(|(target, _)| {
            let path = [target.as_slice(), &[name.to_owned()]].concat();
            self.owner(place, &path, depth + 1)
                .filter(|owner| self.0.get(owner).is_some_and(|module| module.defined.contains(name)))
        });
        through.or_else(|| Some(place.clone()))
    }
}

impl SourceModule {
    /// `None` for files that only tests use.
    fn read(root: &Path, file: &Path) -> Option<Self> {
        let within: PathBuf = file.strip_prefix(root).unwrap().with_extension("");
        let mut place: ModulePath = within.iter().map(|part| part.to_str().unwrap().to_owned()).collect();
        if place.iter().any(|part| ["tests", "testing", "bin"].contains(&part.as_str())) {
            return None;
        }
        if place.last().is_some_and(|last| ["mod", "lib", "main"].contains(&last.as_str())) {
            place.pop();
        }
        let mut module = Self {
            place,
            imports: BTreeMap::new(),
            globs: Vec::new(),
            defined: BTreeSet::new(),
            paths: Vec::new(),
            public_types: Vec::new(),
            types: Vec::new(),
        };
        let source = fs::read_to_string(file).unwrap();
        let parsed = syn::parse_file(&source).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        for item in parsed.items {
            module.add(&item);
        }
        Some(module)
    }

    fn add(&mut self, item: &Item) {
        if is_for_tests(attributes(item)) {
            return;
        }
        if let Item::Use(item) = item {
            let is_public = !matches!(item.vis, Visibility::Inherited);
            self.import(&item.tree, Vec::new(), is_public);
            return;
        }
        let name = match item {
            Item::Const(item) => Some(&item.ident),
            Item::Enum(item) => Some(self.add_type(&item.ident, &item.vis)),
            Item::Fn(item) => Some(&item.sig.ident),
            Item::Macro(item) => item.ident.as_ref(),
            Item::Static(item) => Some(&item.ident),
            Item::Struct(item) => Some(self.add_type(&item.ident, &item.vis)),
            Item::Trait(item) => Some(self.add_type(&item.ident, &item.vis)),
            Item::Type(item) => Some(self.add_type(&item.ident, &item.vis)),
            Item::Mod(item) if item.content.is_some() => Some(&item.ident),
            _ => None,
        };
        self.defined.extend(name.map(ToString::to_string));
        collect_paths(item.to_token_stream(), &mut self.paths);
    }

    fn add_type<'i>(&mut self, name: &'i syn::Ident, visibility: &Visibility) -> &'i syn::Ident {
        self.types.push(name.to_string());
        if matches!(visibility, Visibility::Public(_)) {
            self.public_types.push(name.to_string());
        }
        name
    }

    fn import(&mut self, tree: &UseTree, mut before: Vec<String>, is_public: bool) {
        match tree {
            UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.import(&path.tree, before, is_public);
            }
            UseTree::Name(name) if name.ident == "self" => {
                if let Some(last) = before.last().cloned() {
                    self.imports.insert(last, Import { target: before, is_public });
                }
            }
            UseTree::Name(name) => {
                before.push(name.ident.to_string());
                self.imports.insert(name.ident.to_string(), Import { target: before, is_public });
            }
            UseTree::Rename(rename) => {
                if rename.ident != "self" {
                    before.push(rename.ident.to_string());
                }
                self.imports.insert(rename.rename.to_string(), Import { target: before, is_public });
            }
            UseTree::Glob(_) => self.globs.push((before, is_public)),
            UseTree::Group(group) => {
                for tree in &group.items {
                    self.import(tree, before.clone(), is_public);
                }
            }
        }
    }
}

fn is_relative(word: &str) -> bool {
    ["crate", "self", "super"].contains(&word)
}

fn joined(place: &ModulePath, word: &str) -> ModulePath {
    [place.as_slice(), &[word.to_owned()]].concat()
}

fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        let tokens = attribute.meta.to_token_stream().to_string().replace(' ', "");
        tokens == "cfg(test)" || tokens.starts_with("cfg(all(test")
    })
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// The paths of at least two words in code, also in the arguments of macros, which are no syntax yet.
fn collect_paths(tokens: TokenStream, paths: &mut Vec<Vec<String>>) {
    let mut path: Vec<String> = Vec::new();
    let mut colons = 0;
    for token in tokens {
        match token {
            TokenTree::Ident(word) if path.is_empty() || colons == 2 => {
                path.push(word.to_string());
                colons = 0;
                continue;
            }
            TokenTree::Punct(mark) if mark.as_char() == ':' && !path.is_empty() && colons < 2 => {
                colons += 1;
                continue;
            }
            TokenTree::Ident(word) => {
                finish_path(&mut path, paths);
                path.push(word.to_string());
            }
            TokenTree::Group(group) => {
                finish_path(&mut path, paths);
                collect_paths(group.stream(), paths);
            }
            TokenTree::Punct(_) | TokenTree::Literal(_) => finish_path(&mut path, paths),
        }
        colons = 0;
    }
    finish_path(&mut path, paths);
}

fn finish_path(path: &mut Vec<String>, paths: &mut Vec<Vec<String>>) {
    let path = std::mem::take(path);
    if path.len() > 1 {
        paths.push(path);
    }
}
