//! Files that use each other in a circle. Whoever changes one of them has to know all of them.

use super::{
    MODULES,
    modules::{CrateModules, ModulePath},
};
use petgraph::{algo::tarjan_scc, graph::DiGraph};
use std::collections::{BTreeMap, BTreeSet};

/// The circles that there are. The list may only become shorter.
const ALLOWED: &[&str] = &["wayword-ledger: call, checksum"];

/// Folders over which the files of a circle may be spread.
const MAX_FOLDERS: usize = 2;

/// The circles of a crate: files of which each uses the next. A file and the folder's file above it may use each other.
fn circles(modules: &CrateModules) -> Vec<BTreeSet<ModulePath>> {
    let mut graph: DiGraph<&ModulePath, ()> = DiGraph::new();
    let nodes: BTreeMap<&ModulePath, _> =
        modules.iter().map(|module| (&module.place, graph.add_node(&module.place))).collect();
    for module in modules.iter() {
        for used in modules.used_by(module) {
            let is_related = used.starts_with(&module.place) || module.place.starts_with(&used);
            if let Some(used) = nodes.get(&used).filter(|_| !is_related) {
                graph.add_edge(nodes[&module.place], *used, ());
            }
        }
    }
    let circles = tarjan_scc(&graph).into_iter().filter(|circle| circle.len() > 1);
    circles.map(|circle| circle.into_iter().map(|node| graph[node].clone()).collect()).collect()
}

fn folder(place: &ModulePath) -> ModulePath {
    place[..place.len().saturating_sub(1)].to_vec()
}

#[test]
fn no_new_circle_between_files() {
    let mut found = BTreeSet::new();
    for (name, modules) in MODULES.iter() {
        for circle in circles(modules) {
            let folders: BTreeSet<ModulePath> = circle.iter().map(folder).collect();
            let files: Vec<String> = circle.iter().map(|place| place.join("::")).collect();
            let circle = format!("{name}: {}", files.join(", "));
            assert!(folders.len() <= MAX_FOLDERS, "a circle over {} folders: {circle}", folders.len());
            found.insert(circle);
        }
    }
    let allowed: BTreeSet<String> = ALLOWED.iter().map(|circle| (*circle).to_owned()).collect();
    assert_eq!(
        found, allowed,
        "left: circles that there are; right: circles that are allowed. Move what closes a new one"
    );
}
