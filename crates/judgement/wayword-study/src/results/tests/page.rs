//! The page itself.

use super::{figures::of, fixtures::small};
use crate::StudyTask;

#[test]
fn page_loads_no_resources_and_runs_no_scripts() {
    for mode in [StudyTask::Follow, StudyTask::Rate, StudyTask::Pair] {
        let files = of(&small(mode)).render_files().unwrap();
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
