//! Names of types: no word for anything, and no name for two things.

use super::MODULES;
use std::collections::{BTreeMap, BTreeSet};

/// Names that say nothing: docs/CODE_WORDS.md.
const BANNED: [&str; 8] = ["Told", "Said", "Seen", "Kept", "Held", "Found", "Given", "Meant"];

/// Public names that several crates have. The list may only become shorter.
const SHARED: &[&str] = &[];

#[test]
fn no_type_has_a_banned_name() {
    for (name, modules) in MODULES.iter() {
        for module in modules.iter() {
            for banned in BANNED {
                let place = module.place.join("::");
                assert!(
                    !module.types.iter().any(|name| name == banned),
                    "{name}: {place}::{banned}; see docs/CODE_WORDS.md"
                );
            }
        }
    }
}

#[test]
fn public_type_names_are_unique_in_the_workspace() {
    let mut crates_of: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (name, modules) in MODULES.iter() {
        for module in modules.iter() {
            for public in &module.public_types {
                crates_of.entry(public.clone()).or_default().insert(name.clone());
            }
        }
    }
    crates_of.retain(|_, crates| crates.len() > 1);
    let shared: BTreeSet<&str> = crates_of.keys().map(String::as_str).collect();
    let allowed: BTreeSet<&str> = SHARED.iter().copied().collect();
    assert_eq!(shared, allowed, "left: names that several crates have; right: names that may be shared. {crates_of:?}");
}
