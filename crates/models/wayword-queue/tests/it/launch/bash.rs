//! Runs scripts for Slurm in bash, with stand-ins for Slurm's commands. `trials/scale/slurm.sh` runs them in Slurm itself.

use super::HOSTILE;
use std::{
    fs,
    os::unix::fs::PermissionsExt as _,
    path::Path,
    process::{Child, Command, Stdio},
    thread::sleep,
    time::{Duration, Instant},
};
use tempfile::TempDir;
use wayword_queue::launch::{
    LaunchWorker,
    slurm::{SlurmJob, write_script},
};

/// A worker: writes its arguments to a file, reports its start by another, and ends as its variables ask.
const WORKER: &str = r#"#!/usr/bin/env bash
printf '%s\0' "$@" >arguments
trap 'echo TERM >>signals; [[ -n ${STUBBORN:-} ]] && STUBBORN= || exit 6' TERM
: >started
for ((at = 0; at < ${WAITS:-0}; at++)); do sleep 0.05; done
exit "${ENDS:-0}"
"#;

/// A stand-in for `scontrol`: the job's comment is in a file, and each request is appended to another.
const SCONTROL: &str = r#"#!/usr/bin/env bash
echo "$*" >>asked
[[ $1 == update ]] && echo "${3#Comment=}" >comment
exit "${REFUSES:-0}"
"#;
const SQUEUE: &str = "#!/usr/bin/env bash\ncat comment 2>/dev/null || echo '(null)'\n";

struct Trial {
    folder: TempDir,
}

impl Trial {
    fn new(arguments: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("it's a worker").display().to_string();
        for (name, text) in [("it's a worker", WORKER), ("scontrol", SCONTROL), ("squeue", SQUEUE)] {
            let path = folder.path().join(name);
            fs::write(&path, text).unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
        }
        let arguments = arguments.iter().map(|&text| text.to_owned()).collect();
        let job = SlurmJob::new(LaunchWorker { program, arguments, workers: 40 }, "90");
        // A second signal after 90 s is too long for a test.
        let text = write_script(&job).unwrap().replace("sleep 90", "sleep 0.3");
        fs::write(folder.path().join("script"), text).unwrap();
        Self { folder }
    }

    fn start(&self, variables: &[(&str, &str)]) -> Child {
        let path = format!("{}:{}", self.folder.path().display(), std::env::var("PATH").unwrap_or_default());
        let slurm = [("PATH", path.as_str()), ("SLURM_ARRAY_JOB_ID", "12"), ("SLURM_ARRAY_TASK_ID", "7")];
        Command::new("bash")
            .arg("script")
            .current_dir(self.folder.path())
            .envs(slurm)
            .envs(variables.iter().copied())
            .stdout(Stdio::null())
            .spawn()
            .unwrap()
    }

    fn run(&self, variables: &[(&str, &str)]) -> i32 {
        self.start(variables).wait().unwrap().code().unwrap()
    }

    /// Sends signals to the script alone once the worker is there.
    fn run_with_signals(&self, variables: &[(&str, &str)], signals: &[&str]) -> i32 {
        let mut child = self.start(variables);
        wait_for(&self.folder.path().join("started"));
        for signal in signals {
            Command::new("kill").args(["-s", signal, &child.id().to_string()]).status().unwrap();
            sleep(Duration::from_millis(100));
        }
        child.wait().unwrap().code().unwrap()
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.folder.path().join(name)).unwrap_or_default()
    }
}

fn wait_for(path: &Path) {
    let start = Instant::now();
    while !path.exists() {
        assert!(start.elapsed() < Duration::from_secs(20), "the worker did not start");
        sleep(Duration::from_millis(20));
    }
}

#[test]
fn arguments_reach_the_worker_as_they_were_given() {
    let trial = Trial::new(&HOSTILE);
    assert_eq!(trial.run(&[]), 0);
    let got = trial.read("arguments");
    let got: Vec<&str> = got.trim_end_matches('\0').split('\0').collect();
    assert_eq!(got, [HOSTILE.as_slice(), &["--shard", "7/40"]].concat());
    assert!(!trial.folder.path().join("hacked").exists());
}

#[test]
fn a_script_outside_slurm_ends_with_an_error() {
    let trial = Trial::new(&["generate"]);
    let ended = Command::new("bash").arg("script").current_dir(trial.folder.path()).output().unwrap();
    assert!(!ended.status.success());
    assert!(String::from_utf8_lossy(&ended.stderr).contains("this script is for sbatch"));
}

#[test]
fn only_temporary_failures_are_put_back_into_the_queue() {
    for (ends, expected, is_asked) in
        [("0", 0, false), ("1", 1, false), ("2", 2, false), ("4", 0, true), ("5", 5, false), ("6", 0, true)]
    {
        let trial = Trial::new(&["generate"]);
        assert_eq!(trial.run(&[("ENDS", ends)]), expected, "{ends}");
        let asked = if is_asked { "requeue 12_7\n" } else { "" };
        assert_eq!(trial.read("asked"), asked, "{ends}");
    }
}

#[test]
fn a_worker_that_loses_something_is_put_back_three_times() {
    let trial = Trial::new(&["generate"]);
    let ended: Vec<i32> = (0..5).map(|_| trial.run(&[("ENDS", "7")])).collect();
    assert_eq!(ended, [0, 0, 0, 7, 7]);
    assert_eq!(trial.read("asked").matches("requeue 12_7").count(), 3);
    assert_eq!(trial.read("comment"), "wayword-lost=3\n");
}

#[test]
fn a_foreign_job_comment_is_not_read_as_a_count() {
    let trial = Trial::new(&["generate"]);
    fs::write(trial.folder.path().join("comment"), "wayword-lost=a[$(touch hacked)]\n").unwrap();
    assert_eq!(trial.run(&[("ENDS", "7")]), 0);
    assert!(!trial.folder.path().join("hacked").exists());
}

#[test]
fn a_failed_requeue_ends_with_the_workers_exit_code() {
    for ends in ["4", "6", "7"] {
        let trial = Trial::new(&["generate"]);
        assert_eq!(trial.run(&[("ENDS", ends), ("REFUSES", "1")]).to_string(), ends);
    }
}

#[test]
fn before_its_time_is_up_a_worker_is_asked_once_and_put_back() {
    let trial = Trial::new(&["generate"]);
    // Slurm may send its signal more than once.
    assert_eq!(trial.run_with_signals(&[("WAITS", "400")], &["USR1", "USR1"]), 0);
    assert_eq!(trial.read("signals"), "TERM\n");
    assert_eq!(trial.read("asked"), "requeue 12_7\n");
}

#[test]
fn a_worker_that_does_not_end_when_asked_is_asked_again() {
    let trial = Trial::new(&["generate"]);
    assert_eq!(trial.run_with_signals(&[("WAITS", "400"), ("STUBBORN", "yes")], &["USR1"]), 0);
    assert_eq!(trial.read("signals"), "TERM\nTERM\n");
    assert_eq!(trial.read("asked"), "requeue 12_7\n");
}

#[test]
fn the_exit_code_is_the_workers_also_when_a_signal_came() {
    let trial = Trial::new(&["generate"]);
    // As Slurm cancels a job, but the worker does not hear of it and comes to its own end.
    assert_eq!(trial.run_with_signals(&[("WAITS", "20"), ("ENDS", "5")], &["TERM"]), 5);
    assert_eq!(trial.read("signals"), "", "a second signal would end a worker at once");
}

#[test]
fn a_cancelled_job_is_not_put_back() {
    let trial = Trial::new(&["generate"]);
    assert_eq!(trial.run_with_signals(&[("WAITS", "20"), ("ENDS", "6")], &["TERM"]), 6);
    assert_eq!(trial.read("asked"), "");
}
