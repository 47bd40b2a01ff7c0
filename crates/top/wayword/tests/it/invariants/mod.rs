//! Checks the source against what ARCHITECTURE.md promises about it.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod circles;
mod comments;
mod modules;
mod names;

use modules::CrateModules;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
    sync::LazyLock,
};

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..").canonicalize().unwrap()
}

/// The modules of all crates, read once for all tests of this file and its rooms.
static MODULES: LazyLock<Vec<(String, CrateModules)>> =
    LazyLock::new(|| crate_folders().into_iter().map(|(name, folder)| (name, CrateModules::read(&folder))).collect());

/// The folders of all crates of the workspace, by the crates' names.
fn crate_folders() -> Vec<(String, PathBuf)> {
    let root = workspace();
    let members = manifest(&root)["workspace"]["members"].as_array().unwrap().clone();
    let named = |member: &toml::Value| {
        let folder = root.join(member.as_str().unwrap());
        (manifest(&folder)["package"]["name"].as_str().unwrap().to_owned(), folder)
    };
    members.iter().map(named).collect()
}

fn manifest(folder: &Path) -> toml::Table {
    toml::from_str(&fs::read_to_string(folder.join("Cargo.toml")).unwrap()).unwrap()
}

/// Every Rust file below a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|end| end == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Only the role `labels`, the evidence of the checks and the platforms may read ground-truth labels. With a writer or
/// an asker that read them, the results would be out of any robot's reach.
#[test]
fn only_labels_and_evidence_look_at_ground_truth() {
    let allowed = [
        "crates/ground/wayword-core/src/view.rs",
        "crates/ground/wayword-testkit/src/played_detector.rs",
        "crates/ground/wayword-testkit/src/provider/barcode_platform.rs",
        "crates/judgement/wayword-navigation/src/agents/baselines.rs",
        "crates/judgement/wayword-navigation/src/grounders/view_labels.rs",
        // The agent `reader` gets rooms and labels, as its provenance reports.
        "crates/judgement/wayword-navigation/src/sight/sighting.rs",
        // Changed worlds change the labels of the platform.
        "crates/judgement/wayword-robustness/src/worlds/",
        "crates/words/wayword-checks/src/evidence/from_labels.rs",
        "crates/words/wayword-synthesis/src/offline/around_frame.rs",
        "crates/words/wayword-synthesis/src/offline/labels.rs",
        // A test that compares names of rooms with the plans of houses.
        "crates/world/wayword-habitat/src/semantics/rooms/tests/houses.rs",
        "crates/world/wayword-house/src/",
        "crates/world/wayword-world/src/episode_path.rs",
        "crates/world/wayword-world/src/survey.rs",
    ];
    let root = workspace();
    let mut used: BTreeSet<&str> = BTreeSet::new();
    for file in sources(&root.join("crates")) {
        let name = file.strip_prefix(&root).unwrap().to_str().unwrap().to_owned();
        let is_source = name.split('/').nth(3) == Some("src");
        if !is_source || !fs::read_to_string(&file).unwrap().contains("ground_truth") {
            continue;
        }
        let place = allowed.iter().find(|place| name.starts_with(**place));
        assert!(place.is_some(), "{name} looks at ground truth");
        used.extend(place);
    }
    assert_eq!(used.into_iter().collect::<Vec<_>>(), allowed, "a place that needs no permission has one");
}

/// The Wayword crates that each crate is built on.
fn edges() -> BTreeMap<String, BTreeSet<String>> {
    crate_folders()
        .into_iter()
        .map(|(name, folder)| {
            let manifest = manifest(&folder);
            let depends = manifest.get("dependencies").and_then(toml::Value::as_table).cloned().unwrap_or_default();
            (name, depends.keys().filter(|on| on.starts_with("wayword")).cloned().collect())
        })
        .collect()
}

/// The layers and crates of the table in ARCHITECTURE.md, in its order.
fn documented_crates() -> Vec<(String, String)> {
    let text = fs::read_to_string(workspace().join("ARCHITECTURE.md")).unwrap();
    let rows = text.lines().filter_map(|line| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let name = cells.get(2)?.strip_prefix('`')?.strip_suffix('`')?;
        name.starts_with("wayword").then(|| (cells[1].to_owned(), name.to_owned()))
    });
    rows.collect()
}

#[test]
fn the_table_of_crates_has_each_crate_in_the_folder_of_its_layer() {
    let root = workspace();
    let layer = |folder: &Path| folder.parent().unwrap().file_name().unwrap().to_str().unwrap().to_owned();
    let found: BTreeSet<(String, String)> =
        crate_folders().into_iter().map(|(name, folder)| (layer(&folder), name)).collect();
    let documented: BTreeSet<(String, String)> = documented_crates().into_iter().collect();
    assert_eq!(found, documented, "left: the workspace {}; right: ARCHITECTURE.md", root.display());
}

/// What a crate may be built on.
enum Below {
    /// These crates.
    Crates(&'static [&'static str]),
    /// All crates of the layers above its own, and these of its own.
    LayersAnd(&'static [&'static str]),
}

const BELOW: [(&str, Below); 33] = [
    ("wayword-core", Below::Crates(&[])),
    ("wayword-testkit", Below::Crates(&["wayword-core"])),
    ("wayword-formats", Below::Crates(&["wayword-core", "wayword-language"])),
    ("wayword-language", Below::Crates(&["wayword-core"])),
    ("wayword-render", Below::Crates(&["wayword-core"])),
    ("wayword-world", Below::Crates(&["wayword-core"])),
    ("wayword-house", Below::Crates(&["wayword-core", "wayword-render", "wayword-world"])),
    ("wayword-platforms", Below::Crates(&["wayword-core", "wayword-render", "wayword-world"])),
    ("wayword-habitat", Below::Crates(&["wayword-core", "wayword-render", "wayword-world"])),
    // Walks of training data are recordings, and their layouts are formats.
    ("wayword-recording", Below::Crates(&["wayword-core", "wayword-formats", "wayword-world"])),
    // Its stand-ins draw generated houses; they are not part of any program that users get.
    ("wayword-live", Below::Crates(&["wayword-core", "wayword-house", "wayword-render", "wayword-world"])),
    ("wayword-database", Below::Crates(&[])),
    // It knows chunks by their numbers, and not what is made.
    ("wayword-queue", Below::Crates(&["wayword-database"])),
    ("wayword-ledger", Below::Crates(&["wayword-database"])),
    ("wayword-local", Below::Crates(&["wayword-core", "wayword-ledger"])),
    ("wayword-replies", Below::Crates(&["wayword-core", "wayword-language"])),
    ("wayword-remote", Below::Crates(&["wayword-core", "wayword-ledger", "wayword-replies"])),
    ("wayword-checks", Below::Crates(&["wayword-core", "wayword-language"])),
    ("wayword-follower", Below::Crates(&["wayword-core", "wayword-language"])),
    ("wayword-synthesis", Below::Crates(&["wayword-checks", "wayword-core", "wayword-language", "wayword-replies"])),
    ("wayword-metrics", Below::Crates(&["wayword-core"])),
    ("wayword-study", Below::Crates(&["wayword-core", "wayword-metrics"])),
    ("wayword-robustness", Below::Crates(&["wayword-checks", "wayword-core", "wayword-language", "wayword-metrics"])),
    (
        "wayword-navigation",
        Below::Crates(&["wayword-core", "wayword-follower", "wayword-language", "wayword-metrics", "wayword-replies"]),
    ),
    ("wayword-run", Below::LayersAnd(&[])),
    ("wayword-report", Below::LayersAnd(&["wayword-run"])),
    ("wayword-experiments", Below::LayersAnd(&["wayword-report", "wayword-run"])),
    ("wayword", Below::LayersAnd(&[])),
    // The Python package hands calls on, and has no logic.
    (
        "wayword-py",
        Below::Crates(&[
            "wayword",
            "wayword-core",
            "wayword-experiments",
            "wayword-formats",
            "wayword-metrics",
            "wayword-platforms",
            "wayword-run",
        ]),
    ),
    ("wayword-fit", Below::LayersAnd(&[])),
    ("wayword-quality", Below::LayersAnd(&["wayword-fit"])),
    ("wayword-measure", Below::LayersAnd(&["wayword-fit", "wayword-quality"])),
    ("wayword-trials", Below::LayersAnd(&[])),
];

#[test]
fn no_crate_is_built_on_one_above_it() {
    let table = documented_crates();
    let mut layers: Vec<&str> = table.iter().map(|(layer, _)| layer.as_str()).collect();
    layers.dedup();
    let layer = |name: &str| {
        let (layer, _) =
            table.iter().find(|(_, known)| known == name).unwrap_or_else(|| panic!("{name} is not in the table"));
        layers.iter().position(|known| known == layer).unwrap()
    };
    let edges = edges();
    let known: BTreeSet<&str> = BELOW.iter().map(|(name, _)| *name).collect();
    assert_eq!(
        edges.keys().map(String::as_str).collect::<BTreeSet<_>>(),
        known,
        "a new crate needs a place in this list"
    );
    for (name, below) in BELOW {
        for on in &edges[name] {
            let is_allowed = match below {
                Below::Crates(crates) => crates.contains(&on.as_str()),
                Below::LayersAnd(crates) => layer(on) < layer(name) || crates.contains(&on.as_str()),
            };
            assert!(is_allowed, "{name} is built on {on}");
        }
    }
}

/// Texts are written and checked in memory, so that the result is the same for every platform and every caller.
#[test]
fn words_are_made_and_checked_without_a_file_or_a_connection() {
    let crates =
        ["ground/wayword-language", "words/wayword-checks", "words/wayword-follower", "words/wayword-synthesis"];
    for file in crates.iter().flat_map(|name| sources(&workspace().join("crates").join(name).join("src"))) {
        let text = fs::read_to_string(&file).unwrap();
        for way_out in ["fs", "net", "process", "File", "TcpStream"] {
            let used = text
                .match_indices(&format!("{way_out}::"))
                .any(|(at, _)| !text[..at].ends_with(|before: char| before.is_alphanumeric() || before == '_'));
            let imported = text.contains(&format!("std::{way_out}")) || text.contains(&format!(" {way_out},"));
            assert!(!used && !imported, "{} uses {way_out}", file.display());
        }
    }
}

/// Only one module prints, so that `--json` and `--quiet` work for every command.
#[test]
fn only_the_output_module_prints() {
    let root = workspace();
    let mut printing = Vec::new();
    for file in sources(&root.join("crates")) {
        let name = file.strip_prefix(&root).unwrap().to_str().unwrap().to_owned();
        let text = fs::read_to_string(&file).unwrap();
        let prints = ["println!(", "print!(", "io::stdout()", "io::stderr()"].iter().any(|way| text.contains(way));
        let is_test = name.ends_with("/tests.rs") || name.contains("/tests/");
        if prints && !is_test && name.split('/').nth(3) == Some("src") {
            printing.push(name);
        }
    }
    let allowed = [
        "crates/run/wayword-run/src/output.rs",
        // Completions are a script, neither text nor JSON.
        "crates/top/wayword/src/completions.rs",
        // A program of its own, for trials.
        "crates/world/wayword-live/src/bin/stand_in.rs",
    ];
    assert_eq!(printing, allowed);
}

/// Sines differ in their last digit between C libraries, and headings are written to files. `libm` gives the same value
/// on every machine.
#[test]
fn no_crate_asks_the_standard_library_for_a_sine() {
    let functions = ["sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sin_cos", "sinh", "cosh", "tanh"];
    let calls = |line: &str| {
        let called = |name: &&str| {
            [format!(".{name}("), format!("f64::{name}"), format!("f32::{name}")].iter().any(|way| line.contains(way))
        };
        // glam calls the standard library too.
        let rotates =
            ["from_rotation_", "from_axis_angle", "from_euler", "from_scaled_axis", "slerp(", "angle_between("];
        functions.iter().any(called) || rotates.iter().any(|way| line.contains(way))
    };
    let root = workspace();
    for file in sources(&root.join("crates")) {
        let name = file.strip_prefix(&root).unwrap().to_str().unwrap().to_owned();
        // Values that only a test computes are not written to files.
        if name.split('/').nth(3) != Some("src") || name.ends_with("tests.rs") {
            continue;
        }
        let text = fs::read_to_string(&file).unwrap();
        let shipped = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        for (at, line) in shipped.lines().enumerate().filter(|(_, line)| !line.trim_start().starts_with("//")) {
            assert!(!calls(line), "{name}:{}: {line}", at + 1);
        }
    }
}
