//! Tests of the launchers' texts: their content, how bash and Kubernetes read them, and the values that are refused.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[cfg(unix)]
mod bash;
mod kubernetes;
mod rules;
mod schema;
mod slurm;

use wayword_queue::launch::LaunchWorker;

/// Arguments that mean something to bash, YAML, sbatch or Kubernetes unless they are quoted.
const HOSTILE: [&str; 14] = [
    "it's",
    "$(touch hacked) `touch hacked` ${HOME}",
    "$(JOB_COMPLETION_INDEX) $$(X) $$",
    "\"; touch hacked #",
    "a: b # c",
    "*.rs",
    "~",
    "!tag &anchor *alias %",
    "{a,b} [0]=x",
    "\\",
    "",
    "ä 你好 🦀",
    "---",
    "- yes",
];

fn worker(arguments: &[&str], workers: u32) -> LaunchWorker {
    let arguments = arguments.iter().map(|&text| text.to_owned()).collect();
    LaunchWorker { program: "wayword".to_owned(), arguments, workers }
}

fn by_part() -> LaunchWorker {
    worker(&["generate", "--platform", "habitat", "--paths", "100000", "--out", "runs/it's big"], 40)
}

fn by_queue(workers: u32) -> LaunchWorker {
    worker(&["generate", "--out", "runs/big", "--queue", "postgresql://wayword@db:5432/wayword"], workers)
}
