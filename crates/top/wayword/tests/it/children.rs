//! A platform's child process ends with the program, however the program ends. The processes that the child has started end as
//! well.
//!
//! Every process of a test has the test's folder in its environment. A process that still has it afterwards was left
//! behind.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    sync::Arc,
    thread,
    time::{Duration, Instant},
};
use wayword_core::Platform;
use wayword_platforms::process::{ProcessOptions, ProcessPlatform, end_all};

/// The variable that every process of a test has.
const MARK: &str = "WAYWORD_TEST_FOLDER";

/// A world program that starts two processes: one that keeps its pipes open, and one that does not.
const WORLD: &str = r#"
sleep 1000 &
sleep 1000 <&- >&- 2>&- &
while read -r line; do
    id=${line#*\"id\":}
    id=${id%%,*}
    case $line in
    *'"hello"'*)
        result='{"protocol":1,"frame":"z-up, metres, radians clockwise from +y","name":"x","offers":["graph","labels","rooms"]}'
        [ "$1" = strange ] && result='{"protocol":2}'
        ;;
    *)
        [ "$1" = dies ] && exit 3
        [ "$1" = hangs ] && { : > hangs; sleep 1000; }
        ;;
    esac
    case $line in
    *'"scenes"'*) result='{"scenes":["s"]}' ;;
    *'"graph"'*)
        result='{"viewpoints":[{"id":"a","position":[0,0,1.5]},{"id":"b","position":[0,3,1.5]},{"id":"c","position":[3,3,1.5]},'
        result=$result'{"id":"d","position":[3,6,1.5]},{"id":"e","position":[6,6,1.5]}],"edges":[["a","b"],["b","c"],["c","d"],["d","e"]]}'
        ;;
    *'"observe"'*) result='{"labels":[{"object":"7","name":"lamp","position":[4,8,1]}],"room":"kitchen"}' ;;
    esac
    echo "{\"id\":$id,\"result\":$result}"
done
"#;

/// A folder with the world program in it. When it is dropped, it kills what still runs.
struct Stage(tempfile::TempDir);

impl Stage {
    fn new(world: &str) -> Self {
        let stage = Self(tempfile::tempdir().unwrap());
        fs::write(stage.path("world.sh"), WORLD).unwrap();
        let file = serde_json::json!({"command": ["sh", "world.sh", world]});
        fs::write(stage.path("world.json"), file.to_string()).unwrap();
        stage
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// A run on this world program.
    fn generate(&self) -> Command {
        let mut command = crate::common::command(&["generate", "--platform", "process", "--data", "world.json"]);
        command.args(["--paths", "1", "--hops", "2..4", "--metres", "4..20", "--style", "r2r", "--out", "run"]);
        command.current_dir(self.0.path()).env(MARK, self.0.path());
        command
    }

    /// This test binary itself, as a program that plays a role with this world program.
    fn program(&self, role: &str) -> Command {
        let mut command = Command::new(std::env::current_exe().unwrap());
        command.args(["--exact", "children::the_program", "--nocapture"]).env("WAYWORD_TEST_ROLE", role);
        command.current_dir(self.0.path()).env(MARK, self.0.path()).stdin(Stdio::null());
        command.stdout(Stdio::null()).stderr(Stdio::null());
        command
    }

    /// Starts a program and waits until the world program hangs.
    fn hung(&self, command: &mut Command) -> Child {
        let child = command.spawn().unwrap();
        wait_for(&self.path("hangs"));
        child
    }

    fn running(&self) -> Vec<u32> {
        running(self.0.path())
    }

    fn nothing_is_left(&self) {
        let asked = Instant::now();
        while !self.running().is_empty() {
            assert!(asked.elapsed() < Duration::from_secs(5), "{:?} were left behind", self.running());
            thread::sleep(Duration::from_millis(10));
        }
    }
}

impl Drop for Stage {
    fn drop(&mut self) {
        for left in self.running() {
            signal(left, "-KILL");
        }
    }
}

/// The processes that have a folder in their environment. A process that waits to be reaped does not count as running.
fn running(folder: &Path) -> Vec<u32> {
    let mark = format!("{MARK}={}\0", folder.display()).into_bytes();
    let carries = |pid: &u32| {
        let environment = fs::read(format!("/proc/{pid}/environ")).unwrap_or_default();
        environment.windows(mark.len()).any(|part| part == mark)
    };
    let entries = fs::read_dir("/proc").unwrap();
    let pids = entries.filter_map(|entry| entry.unwrap().file_name().to_str()?.parse().ok());
    pids.filter(carries).collect()
}

fn signal(pid: u32, signal: &str) {
    Command::new("kill").args([signal, &pid.to_string()]).status().unwrap();
}

fn wait_for(file: &Path) {
    let asked = Instant::now();
    while !file.exists() {
        assert!(asked.elapsed() < Duration::from_secs(60), "{} does not come", file.display());
        thread::sleep(Duration::from_millis(5));
    }
}

/// Plays a program if the environment names a role. Otherwise this is an empty test.
#[test]
fn the_program() {
    let Ok(role) = std::env::var("WAYWORD_TEST_ROLE") else { return };
    let start = || {
        let guard = Some(PathBuf::from(env!("CARGO_BIN_EXE_wayword")).into());
        let options = ProcessOptions { guard, ..ProcessOptions::read_world_file(Path::new("world.json")).unwrap() };
        ProcessPlatform::start(options, Arc::new(|_: &str| ()))
    };
    let platform = Arc::new(start().unwrap());
    if role == "panics" {
        panic!("and drops the platform");
    }
    let asking = thread::spawn({
        let platform = Arc::clone(&platform);
        move || platform.list_scenes()
    });
    wait_for(Path::new("hangs"));
    match role.as_str() {
        "panics while it waits" => panic!("and cannot drop the platform"),
        "exits" => std::process::exit(0),
        _ => {}
    }
    let asked = Instant::now();
    end_all();
    let error = asking.join().unwrap().unwrap_err().to_string();
    assert!(asked.elapsed() < Duration::from_secs(2), "{error}");
    end_all();
    let error = start().err().unwrap().to_string();
    assert!(error.contains("this program is ending"), "{error}");
    let others = || running(&PathBuf::from(std::env::var(MARK).unwrap())).len() - 1;
    while others() > 0 {
        assert!(asked.elapsed() < Duration::from_secs(5), "{} were left behind", others());
    }
}

#[test]
fn a_run_that_ends_well_leaves_nothing_running() {
    let stage = Stage::new("behaves");
    let ran = crate::common::run(&mut stage.generate());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    stage.nothing_is_left();
}

#[test]
fn a_run_that_fails_leaves_nothing_running() {
    for world in ["strange", "dies"] {
        let stage = Stage::new(world);
        let asked = Instant::now();
        let ran = crate::common::run(&mut stage.generate());
        assert_ne!(ran.code, Some(0), "{ran:?}");
        // A process that the world program started keeps its output open; the run reports the death nevertheless.
        assert!(asked.elapsed() < Duration::from_secs(30), "{ran:?}");
        stage.nothing_is_left();
    }
}

#[test]
fn a_run_that_is_ended_while_its_world_hangs_leaves_nothing_running() {
    for with in ["-TERM", "-INT", "-HUP", "-KILL"] {
        let stage = Stage::new("hangs");
        let mut program = stage.hung(stage.generate().stdout(Stdio::null()).stderr(Stdio::null()));
        // The program, the guard, the world program, and two processes that the world program has started.
        assert!(stage.running().len() >= 5, "{:?}", stage.running());
        signal(program.id(), with);
        assert_ne!(program.wait().unwrap().code(), Some(0), "{with}");
        stage.nothing_is_left();
    }
}

#[test]
fn a_program_that_panics_or_exits_leaves_nothing_running() {
    for (role, code) in [("panics while it waits", 101), ("exits", 0)] {
        let stage = Stage::new("hangs");
        let mut program = stage.hung(&mut stage.program(role));
        assert_eq!(program.wait().unwrap().code(), Some(code), "{role}");
        stage.nothing_is_left();
    }
    let stage = Stage::new("behaves");
    assert_eq!(stage.program("panics").status().unwrap().code(), Some(101));
    stage.nothing_is_left();
}

#[test]
fn all_children_can_be_ended_at_once_and_no_other_starts() {
    let stage = Stage::new("hangs");
    let mut program = stage.hung(&mut stage.program("ends all"));
    assert!(program.wait().unwrap().success());
    stage.nothing_is_left();
}

#[test]
fn a_guard_that_is_started_by_hand_is_no_command() {
    let ran = crate::common::run(&mut crate::common::command(&["guard-children"]));
    assert_eq!(ran.code, Some(2), "{ran:?}");
}
