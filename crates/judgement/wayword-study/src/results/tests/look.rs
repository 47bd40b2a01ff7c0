//! The page itself, and one to look at.

use super::{
    figures::of,
    made::{large, small},
};
use crate::Mode;

#[test]
fn the_page_asks_nobody_for_anything_and_runs_nothing() {
    for mode in [Mode::Follow, Mode::Rate, Mode::Pair] {
        let files = of(&small(mode)).files().unwrap();
        let page = &files[0].1;
        for part in ["<script", "http://", "https://", "src=", "@import", "url(", " onload"] {
            assert!(!page.contains(part), "{mode:?}: {part}");
        }
        let count = |part: &str| page.matches(part).count();
        assert!(count("<svg") > 5);
        assert_eq!(count("<svg"), count("</title>") - 1, "every picture has a title");
        assert_eq!(count("<svg"), count("<desc"), "every picture is described");
        let mut ids: Vec<&str> = page.split(" id=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        let all = ids.len();
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), all, "ids are unique");
    }
}

/// Writes results to look at: `WAYWORD_LOOK=FOLDER cargo test -p wayword-study -- --ignored look`.
#[test]
#[ignore = "writes files to look at"]
fn write_results_to_look_at() {
    let folder = std::path::PathBuf::from(std::env::var("WAYWORD_LOOK").unwrap());
    for mode in [Mode::Follow, Mode::Rate, Mode::Pair] {
        of(&small(mode)).write(&folder.join(mode.name())).unwrap();
        let (data, begun) = (large(mode, 200), std::time::Instant::now());
        of(&data).write(&folder.join(format!("large-{}", mode.name()))).unwrap();
        println!("{} of 200 people: {:.1} s", mode.name(), begun.elapsed().as_secs_f64());
    }
}
