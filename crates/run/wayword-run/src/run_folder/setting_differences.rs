//! What differs between two settings, for the error of a folder that holds another run.

use serde::Serialize;
use toml::{Table, Value};

/// Most differences that are listed; the others are counted.
const MAX_LISTED: usize = 12;
/// Longest value that is shown, characters.
const MAX_VALUE_CHARS: usize = 60;
/// Keys that say how a run grew. They differ whenever it grows.
const GROWTH_KEYS: [&str; 1] = ["raised_from"];
/// The table with hashes of input files and styles.
const INPUTS_KEY: &str = "inputs";

/// The settings that differ, each with its value before and now, as in "seed (0 before, 7 now)". Inputs whose content differs are
/// listed as "contents of NAME".
pub fn setting_differences<S: Serialize>(before: &S, now: &S) -> Vec<String> {
    let table = |settings: &S| Table::try_from(settings).unwrap_or_default();
    let (mut before, mut now) = (table(before), table(now));
    let inputs = [before.remove(INPUTS_KEY), now.remove(INPUTS_KEY)];
    for key in GROWTH_KEYS {
        before.remove(key);
        now.remove(key);
    }
    let mut listed = Vec::new();
    add_differences("", &before, &now, &mut listed);
    if let [Some(Value::Table(before)), Some(Value::Table(now))] = &inputs {
        let differs = |name: &&String| now.get(*name).is_some_and(|hash| before.get(*name) != Some(hash));
        listed.extend(before.keys().filter(differs).map(|name| format!("contents of {name}")));
    }
    let more = listed.len().saturating_sub(MAX_LISTED);
    if more > 0 {
        listed.truncate(MAX_LISTED);
        listed.push(format!("and {more} more"));
    }
    listed
}

/// Adds what differs between two tables. The names of keys in inner tables begin with those of the outer ones.
fn add_differences(within: &str, before: &Table, now: &Table, listed: &mut Vec<String>) {
    let mut keys: Vec<&String> = before.keys().chain(now.keys()).collect();
    keys.sort_unstable();
    keys.dedup();
    for key in keys {
        let name = format!("{within}{key}");
        match (before.get(key), now.get(key)) {
            (Some(Value::Table(before)), Some(Value::Table(now))) => {
                add_differences(&format!("{name}."), before, now, listed);
            }
            (before, now) if before != now => {
                listed.push(format!("{name} ({} before, {} now)", value_words(before), value_words(now)));
            }
            _ => {}
        }
    }
}

/// A value as it is shown.
fn value_words(value: Option<&Value>) -> String {
    let Some(value) = value else { return "not set".to_owned() };
    let text = value.to_string().replace('\n', " ");
    match text.char_indices().nth(MAX_VALUE_CHARS) {
        Some((end, _)) => format!("{} ...", &text[..end]),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn differences(before: &str, now: &str) -> Vec<String> {
        let table = |text: &str| toml::from_str::<Table>(text).unwrap();
        setting_differences(&table(before), &table(now))
    }

    #[test]
    fn each_difference_has_both_values() {
        let before = "seed = 0\nstyle = [\"r2r\"]\nraised_from = [1]\n[roles]\nwrite = \"rules\"\nsee = \"labels\"";
        let now = "seed = 7\nstyle = [\"r2r\"]\nlimit = 3\n[roles]\nwrite = \"a/b\"\nsee = \"labels\"";
        assert_eq!(
            differences(before, now),
            ["limit (not set before, 3 now)", "roles.write (\"rules\" before, \"a/b\" now)", "seed (0 before, 7 now)"]
        );
        assert_eq!(differences(before, before), <[&str; 0]>::default());
    }

    #[test]
    fn inputs_are_named_without_their_hashes() {
        let inputs = |hash: &str| format!("[inputs]\nepisodes = \"{hash}\"\nsame = \"1\"");
        assert_eq!(differences(&inputs("abc"), &inputs("def")), ["contents of episodes"]);
    }

    #[test]
    fn long_values_and_long_lists_are_cut() {
        let long = differences("a = 1", &format!("a = \"{}\"", "\u{e9}".repeat(200)));
        assert!(long[0].len() < 200 && long[0].ends_with(" ... now)"), "{long:?}");
        let many: String = (0..20).map(|key| format!("k{key:02} = 1\n")).collect();
        let told = differences("", &many);
        assert_eq!((told.len(), told.last().unwrap().as_str()), (MAX_LISTED + 1, "and 8 more"));
    }
}
