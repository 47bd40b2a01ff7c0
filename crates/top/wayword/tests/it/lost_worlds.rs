//! A platform that dies at a random view: the same command continues, and the files end up the same byte for byte.
//!
//! `WAYWORD_KILLS` sets how often each platform dies (default 1).

#![cfg(all(unix, feature = "live"))]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test fails by panicking, and says what it skipped"
)]

use crate::common::{Building, Ran, files, free_port};
use rand::Rng;
use std::{
    env, fs,
    net::TcpListener,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    thread,
    time::Duration,
};
use wayword_core::seeded_rng;
use wayword_live::{tdw, virtualhome};

fn deaths() -> usize {
    env::var("WAYWORD_KILLS").map_or(1, |kills| kills.parse().unwrap())
}

/// Every file of a run folder except the lock.
fn contents(run: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    files(run).into_iter().filter(|(path, _)| !path.ends_with("run.lock")).collect()
}

/// Gives the same command until it is done. No text may be rejected on the way.
fn go_on(building: &Building, run: &str, command: &dyn Fn(&str) -> Ran) -> Vec<Ran> {
    let mut ran = Vec::new();
    for _ in 0..5 {
        ran.push(command(run));
        assert_eq!(fs::read(building.path(run).join("rejected.jsonl")).unwrap(), b"", "{ran:?}");
        if ran.last().unwrap().code == Some(0) {
            return ran;
        }
        assert!(matches!(ran.last().unwrap().code, Some(3 | 7)), "{ran:?}");
    }
    panic!("the same command does not get to the end: {ran:?}");
}

/// A world program: a room with things along its walls. It dies once, at the view that a file names.
const MORTAL: &str = r#"
import os, pathlib, sys
sys.path.insert(0, sys.argv[1])
import wayword.platform as kit

HERE = pathlib.Path(sys.argv[2])
THINGS = [("lamp", (1, 1, 1)), ("sofa", (9, 1, 1)), ("piano", (1, 9, 1)), ("table", (9, 9, 1)), ("plant", (5, 9.5, 1))]


class Room(kit.OpenPlatform):
    name, has_labels = "room", True

    def scenes(self):
        return ["room"]

    def bounds(self, scene):
        return (0, 0, 1.5), (10, 10, 1.5)

    def is_free(self, scene, place):
        return True

    def observe(self, scene, look):
        count = HERE / "count"
        looks = int(count.read_text()) + 1 if count.exists() else 1
        count.write_text(str(looks))
        if (HERE / "dies_at").exists() and looks == int((HERE / "dies_at").read_text()):
            os.kill(os.getpid(), 9)
        labels = [kit.Label(str(at), name, position=place) for at, (name, place) in enumerate(THINGS)]
        return kit.View(bytes([90, 90, 90]) * (look.width_px * look.height_px), labels)


kit.serve(Room)
"#;

/// A folder with a world program in Python, which gets the places of the kit and of the folder as arguments.
fn with_child(name: &str, script: &str) -> Option<Building> {
    if !Command::new("python3").arg("--version").output().is_ok_and(|output| output.status.success()) {
        println!("SKIPPED: there is no python3 here, so no child of the Python kit dies");
        return None;
    }
    let building = Building::new();
    let kit = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../python").canonicalize().unwrap();
    building.write(name, script);
    let here = building.path("");
    let command = ["python3", "-B", name, kit.to_str().unwrap(), here.to_str().unwrap()];
    building.write("world.json", serde_json::json!({ "command": command, "restarts": 100 }).to_string());
    Some(building)
}

#[test]
fn a_child_that_dies_costs_nothing() {
    let Some(building) = with_child("mortal.py", MORTAL) else { return };
    let generate = |run: &str| {
        let world = ["generate", "--platform", "process", "--data", "world.json", "--seed", "4"];
        building.wayword(&[&world[..], &["--paths", "6", "--style", "r2r", "--out", run]].concat())
    };
    let whole = generate("whole");
    assert_eq!(whole.code, Some(0), "{whole:?}");
    let looks: u64 = fs::read_to_string(building.path("count")).unwrap().parse().unwrap();
    let mut rng = seeded_rng(7, &["deaths of a child"]);
    for death in 0..deaths() {
        fs::remove_file(building.path("count")).unwrap();
        let at = rng.random_range(1..=looks);
        building.write("dies_at", at.to_string());
        let run = format!("run{death}");
        let ran = go_on(&building, &run, &generate);
        assert!(ran.len() > 1 && ran[0].out.contains("the same command tries again"), "look {at}: {ran:?}");
        assert!(contents(&building.path(&run)) == contents(&building.path("whole")), "look {at}");
    }
}

/// A world program that dies at every view of its scene "deadly"; its other scene works.
const POISONED: &str = r#"
import os, sys
sys.path.insert(0, sys.argv[1])
import wayword.platform as kit


class Rooms(kit.OpenPlatform):
    name, has_labels = "rooms", True

    def scenes(self):
        return ["deadly", "sound"]

    def bounds(self, scene):
        return (0, 0, 1.5), (10, 10, 1.5)

    def is_free(self, scene, place):
        return True

    def observe(self, scene, look):
        if scene == "deadly":
            os.kill(os.getpid(), 9)
        labels = [kit.Label("1", "lamp", position=(1, 1, 1)), kit.Label("2", "sofa", position=(9, 9, 1))]
        return kit.View(bytes([90, 90, 90]) * (look.width_px * look.height_px), labels)


kit.serve(Rooms)
"#;

#[test]
fn a_scene_that_kills_its_world_does_not_keep_the_others_from_being_made() {
    let Some(building) = with_child("poisoned.py", POISONED) else { return };
    let generate = || {
        let world = ["generate", "--platform", "process", "--data", "world.json", "--style", "r2r"];
        building.wayword(&[&world[..], &["--paths", "12", "--out", "run"]].concat())
    };
    let first = generate();
    assert_eq!(first.code, Some(7), "{first:?}");
    assert!(building.records("run").is_empty(), "the deadly scene comes first");
    let second = generate();
    assert_eq!(second.code, Some(7), "{second:?}");
    assert_eq!(building.records("run").len(), 6, "what has failed is tried last: {second:?}");
}

#[test]
fn a_simulator_that_is_gone_for_good_ends_the_run_with_a_code_of_its_own() {
    let (building, address) = (Building::new(), free_port());
    let at = format!("http://{address}");
    let args = ["generate", "--platform", "virtualhome", "--at", &at, "--style", "r2r", "--paths", "6", "--out", "run"];
    // The listener accepts only the first connection, with which the program tests the port.
    let listener = TcpListener::bind(address).unwrap();
    let child = building.command(&args).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    drop(listener.accept().unwrap());
    drop(listener);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(7), "{}", String::from_utf8_lossy(&output.stderr));
    let errors = building.lines("run/errors.jsonl");
    assert_eq!(errors.len(), 5, "it gives up after five in a row");
    assert!(errors.iter().all(|line| line["failure"] == "lost"), "{errors:?}");
    assert!(building.lines("run/rejected.jsonl").is_empty());
}

#[test]
fn an_executable_that_dies_costs_nothing() {
    let (building, address) = (Building::new(), free_port());
    let at = format!("http://{address}");
    let world = ["generate", "--platform", "virtualhome", "--at", &at, "--scan", "home_0", "--style", "r2r"];
    let generate = |run: &str| building.wayword(&[&world[..], &["--paths", "4", "--out", run]].concat());
    let mut executable = virtualhome::stand_in::VirtualHomeStandIn::start(address).unwrap();
    assert_eq!(generate("whole").code, Some(0));
    let size = fs::metadata(building.path("whole/walks.jsonl")).unwrap().len();
    let mut rng = seeded_rng(8, &["deaths of an executable"]);
    for death in 0..deaths() {
        let run = format!("run{death}");
        let moment = rng.random_range(0..size * 3 / 4);
        let args = [&world[..], &["--paths", "4", "--out", &run]].concat();
        let mut child = building.command(&args).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        while fs::metadata(building.path(&run).join("walks.jsonl")).map_or(0, |file| file.len()) < moment {
            thread::sleep(Duration::from_millis(1));
        }
        // Between two items, or during one.
        thread::sleep(Duration::from_millis(rng.random_range(0..40)));
        drop(executable);
        assert!(matches!(child.wait().unwrap().code(), Some(0 | 3 | 7)));
        executable = virtualhome::stand_in::VirtualHomeStandIn::start(address).unwrap();
        go_on(&building, &run, &generate);
        assert!(contents(&building.path(&run)) == contents(&building.path("whole")), "at {moment} bytes");
    }
}

#[test]
fn a_build_that_breaks_costs_nothing() {
    let (building, address) = (Building::new(), free_port());
    let at = address.to_string();
    let world = ["generate", "--platform", "tdw", "--at", &at, "--scan", "floorplan_1a", "--style", "r2r"];
    let generate = |run: &str| building.wayword(&[&world[..], &["--paths", "4", "--out", run]].concat());
    let build = tdw::stand_in::TdwStandIn::start(address, tdw::stand_in::StandInOptions::default());
    assert_eq!(generate("whole").code, Some(0));
    drop(build);
    let mut rng = seeded_rng(9, &["deaths of a build"]);
    for death in 0..deaths() {
        let run = format!("run{death}");
        let breaks_after = Some(rng.random_range(1..200));
        let options = tdw::stand_in::StandInOptions { breaks_after, ..Default::default() };
        let _build = tdw::stand_in::TdwStandIn::start(address, options);
        go_on(&building, &run, &generate);
        assert!(contents(&building.path(&run)) == contents(&building.path("whole")), "after {breaks_after:?} answers");
    }
}
