//! World programs that mirror their pictures or turn the other way: `doctor` turns on the spot and says so, and so does a run whose
//! labels contradict their boxes.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a test fails by panicking, and says what it skipped")]

use crate::common::Building;
use std::{path::Path, process::Command};

/// A room with posts all around. An argument says what is wrong with it.
const POSTS: &str = r#"
import math, sys
sys.path.insert(0, sys.argv[1])
import wayword.platform as kit

FAULT = sys.argv[2]
POSTS = [(str(at), at * math.tau / 12 + 0.1) for at in range(12)]


class Posts(kit.OpenPlatform):
    name, has_labels = "posts", True

    def scenes(self):
        return ["yard"]

    def bounds(self, scene):
        return (0, 0, 1.5), (8, 8, 1.5)

    def is_free(self, scene, place):
        return True

    def observe(self, scene, look):
        faced = -look.heading_rad if FAULT == "counter-clockwise" else look.heading_rad
        row, labels = bytearray(), []
        for column in range(look.width_px):
            tangent = (column + 0.5) / look.width_px * 2 - 1
            angle = faced + math.atan(tangent)
            level = int(127 + 60 * math.sin(5 * angle) + 40 * math.sin(13 * angle + 1))
            row += bytes([level] * 3)
        if FAULT == "mirrored":
            row = b"".join(row[at:at + 3] for at in range(len(row) - 3, -1, -3))
        for name, heading in POSTS:
            right = (heading - faced + math.pi) % math.tau - math.pi
            if abs(right) < 0.7:
                side = -1 if FAULT in ("mirrored", "mirrored boxes") else 1
                x = (1 + side * math.tan(right)) * look.width_px / 2
                box = (max(0, x - 15), 100, 30 - max(0, 15 - x) - max(0, x + 15 - look.width_px), 80)
                boxed = None if FAULT == "mirrored" else box
                labels.append(kit.Label(name, "post", heading_rad=heading % math.tau, box_px=boxed))
        return kit.View(bytes(row) * look.height_px, labels)


kit.serve(Posts)
"#;

fn world(fault: &str) -> Option<Building> {
    if !Command::new("python3").arg("--version").output().is_ok_and(|output| output.status.success()) {
        println!("SKIPPED: there is no python3 here, so no world program of the Python kit turns");
        return None;
    }
    let building = Building::new();
    let kit = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../python").canonicalize().unwrap();
    building.write("posts.py", POSTS);
    let command = ["python3", "-B", "posts.py", kit.to_str().unwrap(), fault];
    building
        .write("world.json", serde_json::json!({ "command": command, "width_px": 320, "height_px": 240 }).to_string());
    Some(building)
}

#[test]
fn doctor_tells_a_world_that_turns_the_wrong_way() {
    for (fault, code, told) in [
        ("none", 0, "when the walker turns right, things move to the left, as they should"),
        ("mirrored", 1, "when the walker turns right, the things in the pictures move to the right"),
        ("mirrored boxes", 1, "as if left and right were swapped"),
        ("counter-clockwise", 1, "`box_px` contradicts `position` or `heading_rad`"),
    ] {
        let Some(building) = world(fault) else { return };
        let ran = building.wayword(&["doctor", "--platform", "process", "--data", "world.json", "--see", "labels"]);
        assert_eq!(ran.code, Some(code), "{fault}: {ran:?}");
        assert!(format!("{ran:?}").contains(told), "{fault}: {ran:?}");
    }
}

#[test]
fn a_run_does_not_take_labels_from_mirrored_boxes() {
    let Some(building) = world("mirrored boxes") else { return };
    let command = ["generate", "--platform", "process", "--data", "world.json", "--paths", "3", "--style", "r2r"];
    let ran = building.wayword(&[&command[..], &["--metres", "2..9", "--hops", "2..6", "--out", "run"]].concat());
    assert!(ran.code != Some(0) && format!("{ran:?}").contains("left and right were swapped"), "{ran:?}");
}
