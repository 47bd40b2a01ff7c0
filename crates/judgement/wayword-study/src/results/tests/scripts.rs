use super::figures::of;
use super::fixtures::small;
use super::reader::read;
use crate::StudyTask;
use std::collections::{BTreeMap, BTreeSet};

/// The names after a mark in a text, as `a$name`.
fn names_after<'a>(text: &'a str, mark: &str) -> BTreeSet<&'a str> {
    let name = |rest: &'a str| {
        let end = rest.find(|letter: char| !letter.is_ascii_alphanumeric() && letter != '_').unwrap_or(rest.len());
        &rest[..end]
    };
    text.split(mark).skip(1).map(name).filter(|name| !name.is_empty()).collect()
}

#[test]
fn every_column_that_the_script_names_is_in_the_file_that_it_reads() {
    for mode in [StudyTask::Follow, StudyTask::Rate, StudyTask::Pair] {
        let mut data = small(mode);
        data.settings.exclusions.min_seconds_per_item = 1.0;
        let files: BTreeMap<&str, String> = of(&data).render_files().unwrap().into_iter().collect();
        let script = &files["analysis.R"];
        assert!(script.contains("read_sheet(\"answers.csv\")"));
        let mut columns: BTreeSet<String> = read(&files["answers.csv"])[0].iter().cloned().collect();
        // In a comparison the script makes these itself.
        columns.extend(["condition", "gain"].map(str::to_owned).into_iter().filter(|_| mode == StudyTask::Pair));
        let named: BTreeSet<&str> =
            [" a$", "(own$", "= own$", " answers$"].iter().flat_map(|mark| names_after(script, mark)).collect();
        assert!(named.len() >= 4, "{named:?}");
        for name in named {
            // The part for comparisons runs in no other mode.
            let is_of_pairs = mode != StudyTask::Pair && ["preferred", "gain"].contains(&name);
            assert!(columns.contains(name) || is_of_pairs, "{mode:?}: no column {name}");
        }
        for version in ["everybody", "finished", "kept"] {
            assert!(script.contains(&format!("\"{version}\"")) && columns.contains(&format!("in_{version}")));
        }
        let measures = script.split("measures <- list(").nth(1).unwrap().split("\n)\n").next().unwrap();
        assert_eq!(measures.matches("list(share = ").count(), of(&data).measures.len());
    }
}

#[test]
fn names_of_conditions_stay_text_in_the_script() {
    let mut data = small(StudyTask::Follow);
    data.plan.conditions[0].name = "a\"); system(\"x\\".to_owned();
    let files: BTreeMap<&str, String> = of(&data).render_files().unwrap().into_iter().collect();
    let conditions = files["analysis.R"].lines().find(|line| line.starts_with("conditions <- ")).unwrap();
    assert!(conditions.contains(r#"c("a\"); system(\"x\\", "humans""#), "{conditions}");
}
