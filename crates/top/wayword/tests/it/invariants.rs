//! Checks the source against what ARCHITECTURE.md promises about it.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path, PathBuf},
};

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..").canonicalize().unwrap()
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
        "crates/ground/wayword-testkit/src/provider/pictured.rs",
        "crates/judgement/wayword-navigation/src/agents/baselines.rs",
        "crates/judgement/wayword-navigation/src/grounders/labels_of.rs",
        // The agent `reader` gets rooms and labels, as its provenance reports.
        "crates/judgement/wayword-navigation/src/sight/sighting.rs",
        // Changed worlds change the labels of the platform.
        "crates/judgement/wayword-robustness/src/worlds/",
        "crates/words/wayword-checks/src/evidence/from_labels.rs",
        "crates/words/wayword-synthesis/src/offline/distinguish.rs",
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
    let root = workspace();
    let manifest = |folder: &Path| -> toml::Table {
        toml::from_str(&fs::read_to_string(folder.join("Cargo.toml")).unwrap()).unwrap()
    };
    let members = manifest(&root)["workspace"]["members"].as_array().unwrap().clone();
    let crates = members.iter().map(|member| manifest(&root.join(member.as_str().unwrap())));
    crates
        .map(|manifest| {
            let name = manifest["package"]["name"].as_str().unwrap().to_owned();
            let depends = manifest.get("dependencies").and_then(toml::Value::as_table).cloned().unwrap_or_default();
            (name, depends.keys().filter(|on| on.starts_with("wayword")).cloned().collect())
        })
        .collect()
}

#[test]
fn no_crate_is_built_on_one_above_it() {
    let allowed: [(&str, &[&str]); 26] = [
        ("wayword-core", &[]),
        ("wayword-testkit", &["wayword-core"]),
        ("wayword-database", &[]),
        ("wayword-ledger", &["wayword-database"]),
        ("wayword-local", &["wayword-core", "wayword-ledger"]),
        ("wayword-remote", &["wayword-core", "wayword-ledger"]),
        ("wayword-formats", &["wayword-core"]),
        ("wayword-language", &["wayword-core"]),
        ("wayword-render", &["wayword-core"]),
        ("wayword-world", &["wayword-core"]),
        ("wayword-house", &["wayword-core", "wayword-render", "wayword-world"]),
        ("wayword-platforms", &["wayword-core", "wayword-render", "wayword-world"]),
        ("wayword-habitat", &["wayword-core", "wayword-render", "wayword-world"]),
        ("wayword-recording", &["wayword-core", "wayword-world"]),
        // Its stand-ins draw generated houses; they are not part of any program that users get.
        ("wayword-live", &["wayword-core", "wayword-house", "wayword-render", "wayword-world"]),
        ("wayword-checks", &["wayword-core", "wayword-language"]),
        ("wayword-follower", &["wayword-core", "wayword-language"]),
        ("wayword-synthesis", &["wayword-checks", "wayword-core", "wayword-language"]),
        ("wayword-metrics", &["wayword-core"]),
        ("wayword-robustness", &["wayword-checks", "wayword-core", "wayword-language", "wayword-metrics"]),
        ("wayword-study", &["wayword-core", "wayword-metrics"]),
        ("wayword-navigation", &["wayword-core", "wayword-follower", "wayword-language", "wayword-metrics"]),
        // It knows chunks by their numbers, and not the items in them.
        ("wayword-queue", &["wayword-database"]),
        (
            "wayword",
            &[
                "wayword-checks",
                "wayword-core",
                "wayword-database",
                "wayword-follower",
                "wayword-formats",
                "wayword-habitat",
                "wayword-house",
                "wayword-language",
                "wayword-ledger",
                "wayword-live",
                "wayword-local",
                "wayword-metrics",
                "wayword-navigation",
                "wayword-platforms",
                "wayword-queue",
                "wayword-recording",
                "wayword-remote",
                "wayword-render",
                "wayword-robustness",
                "wayword-study",
                "wayword-synthesis",
                "wayword-world",
            ],
        ),
        (
            "wayword-measure",
            &[
                "wayword",
                "wayword-checks",
                "wayword-core",
                "wayword-follower",
                "wayword-formats",
                "wayword-house",
                "wayword-language",
                "wayword-ledger",
                "wayword-local",
                "wayword-metrics",
                "wayword-navigation",
                "wayword-remote",
                "wayword-render",
                "wayword-robustness",
                "wayword-synthesis",
                "wayword-testkit",
                "wayword-world",
            ],
        ),
        // The Python package hands calls on, and has no logic.
        ("wayword-py", &["wayword", "wayword-core", "wayword-formats", "wayword-metrics", "wayword-platforms"]),
    ];
    let edges = edges();
    let names: BTreeSet<&str> = allowed.iter().map(|(name, _)| *name).collect();
    assert_eq!(
        edges.keys().map(String::as_str).collect::<BTreeSet<_>>(),
        names,
        "a new crate needs a place in this list"
    );
    for (name, below) in allowed {
        for on in &edges[name] {
            assert!(below.contains(&on.as_str()), "{name} is built on {on}");
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
        // Completions are a script, neither text nor JSON.
        "crates/top/wayword/src/commands/completions.rs",
        "crates/top/wayword/src/output.rs",
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
