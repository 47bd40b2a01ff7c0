//! `wayword study plan`, `texts` and `new --texts` as their users see them.

#![cfg(feature = "study")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use crate::common::{Ran, command, run};
use std::path::Path;

fn wayword(folder: &Path, args: &[&str]) -> Ran {
    run(command(args).current_dir(folder))
}

#[test]
fn a_study_is_translated_planned_and_preregistered() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let made = wayword(
        folder,
        &["generate", "--paths", "3", "--scan", "house2-1", "--style", "r2r", "--seed", "3", "--out", "run"],
    );
    assert_eq!(made.code, Some(0), "{made:?}");
    let english = wayword(folder, &["study", "texts"]).out;
    let new = |texts: &str| {
        std::fs::write(folder.join("de.toml"), texts).unwrap();
        let args = ["study", "new", "--run", "a=run#r2r", "--include", "other-path", "--mode", "rate", "--items", "2"];
        wayword(folder, &[&args[..], &["--texts", "de.toml", "--out", "study"]].concat())
    };
    let refused = new(&english.replace("go_on =", "goon ="));
    for said in ["de.toml", "[base] go_on is missing", "did you mean \"go_on\"?", "study texts"] {
        assert!(refused.refused().contains(said), "{said}: {refused:?}");
    }
    assert!(!folder.join("study").exists(), "nothing is drawn for a file that cannot be used");
    let made = new(&english.replace("language = \"en\"", "language = \"de\"").replace("\"Continue\"", "\"Weiter\""));
    assert_eq!(made.code, Some(0), "{made:?}");
    assert!(std::fs::read_to_string(folder.join("study/texts.toml")).unwrap().contains("Weiter"));

    for (flag, value) in
        [("--effect", "0"), ("--effect", "100"), ("--base", "100"), ("--person-sd", "-1"), ("--routes", "0")]
    {
        let flags = format!("{flag}={value}");
        let refused = wayword(folder, &["study", "plan", "study", &flags]);
        assert!(refused.refused().contains(flag), "{refused:?}");
    }
    let sheet = ["study", "plan", "study", "--effect", "30", "--out", "sheet.md"];
    let planned = wayword(folder, &sheet);
    assert!(planned.out.contains("find 30 points"), "{planned:?}");
    assert!(
        std::fs::read_to_string(folder.join("sheet.md"))
            .unwrap()
            .contains("Smallest difference of interest: 30 points")
    );
    let again = wayword(folder, &sheet);
    assert!(again.code == Some(1) && again.err.contains("sheet.md"), "{again:?}");
}
