//! A script for `sbatch`: an array of workers. Each of them is requeued until it has no more work.
//!
//! Slurm does not make the folder of the logs; make it before you submit the script.

use super::{
    LaunchError, LaunchWorker,
    check::{check_text, check_variable, check_word, value_error},
    quote::render_template,
};
use serde::Serialize;

const SLURM_TEMPLATE: &str = include_str!("slurm.j2");

/// The default of a cluster's `MaxArraySize`: 1001 workers, of which the last has index 1000.
const USUAL_ARRAY_WORKERS: u32 = 1001;
/// How long before the end of its time a worker gets a warning signal, seconds.
const WARNING_S: u32 = 120;
/// How long a worker may wait for answers after the warning before it is ended, seconds.
const PATIENCE_S: u32 = 90;
/// By how much Slurm may send the warning signal too early, seconds.
const MAX_EARLY_S: u32 = 60;
/// How often a worker is started again after it lost the simulator, a service or the disk.
const MAX_WORKER_RESTARTS: u32 = 3;
/// The environment variables that every program needs. The user names all others.
const USUAL_VARIABLES: [&str; 4] = ["HOME", "LANG", "PATH", "USER"];

/// An array of workers in Slurm.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SlurmJob {
    /// What each worker runs.
    pub worker: LaunchWorker,
    /// The array's name.
    pub name: String,
    /// How long one start of a worker may take, as Slurm writes it: `4:00:00`, `90`, `1-12`.
    pub time: String,
    /// GPUs of a worker.
    pub gpus: u32,
    /// CPUs of a worker.
    pub cpus: u32,
    /// Memory of a worker, as Slurm writes it: `16G`. The cluster's own figure without it.
    pub memory: Option<String>,
    /// Where to run: one partition, or some with commas between.
    pub partition: Option<String>,
    /// The account that the time is charged to.
    pub account: Option<String>,
    /// An existing folder for the logs, one for each worker.
    pub logs: String,
    /// Names of environment variables that workers get from the user who submits, for example `PGPASSFILE`.
    pub export: Vec<String>,
}

impl SlurmJob {
    /// An array that asks for one CPU and no GPU for each worker, and writes its logs into the folder it is submitted from.
    #[must_use]
    pub fn new(worker: LaunchWorker, time: &str) -> Self {
        Self {
            worker,
            name: "wayword".to_owned(),
            time: time.to_owned(),
            gpus: 0,
            cpus: 1,
            memory: None,
            partition: None,
            account: None,
            logs: ".".to_owned(),
            export: Vec::new(),
        }
    }

    /// Checks every value of the job.
    fn check_job(&self) -> Result<(), LaunchError> {
        self.worker.check_worker()?;
        check_text("the program", &self.worker.program)?;
        check_word("--name", &self.name, "._-")?;
        check_time(&self.time)?;
        if self.cpus == 0 {
            return Err(value_error("--cpus", "0", "is no number of CPUs", "give at least 1"));
        }
        self.memory.as_deref().map_or(Ok(()), check_memory)?;
        self.partition.as_deref().map_or(Ok(()), |name| check_word("--partition", name, "._,-"))?;
        self.account.as_deref().map_or(Ok(()), |name| check_word("--account", name, "._-"))?;
        check_logs(&self.logs)?;
        self.export.iter().try_for_each(|name| check_variable("--export", name))
    }

    /// The names of variables that workers get, each once.
    fn variable_names(&self) -> Vec<&str> {
        let mut names = USUAL_VARIABLES.to_vec();
        for name in &self.export {
            if !names.contains(&name.as_str()) {
                names.push(name);
            }
        }
        names
    }
}

/// The values of the template.
#[derive(Debug, Serialize)]
struct SlurmTemplateValues<'a> {
    name: &'a str,
    time: &'a str,
    gpus: u32,
    cpus: u32,
    memory: Option<&'a str>,
    partition: Option<&'a str>,
    account: Option<&'a str>,
    log: String,
    export: String,
    program: &'a str,
    arguments: &'a [String],
    workers: u32,
    /// The index of the last worker.
    last: u32,
    /// Whether the script adds each worker's part to its arguments.
    needs_part: bool,
    /// Whether the array is larger than clusters allow by default.
    is_long: bool,
    usual_array: u32,
    warning_s: u32,
    patience_s: u32,
    /// How often a worker is started again.
    tries: u32,
}

/// The script for `sbatch`.
///
/// # Errors
/// When a value cannot or must not be in a script: see [`LaunchError`].
pub fn write_script(job: &SlurmJob) -> Result<String, LaunchError> {
    job.check_job()?;
    let workers = job.worker.workers;
    let folder = job.logs.replace('%', "%%");
    let folder = folder.trim_end_matches('/');
    render_template(
        SLURM_TEMPLATE,
        SlurmTemplateValues {
            name: &job.name,
            time: &job.time,
            gpus: job.gpus,
            cpus: job.cpus,
            memory: job.memory.as_deref(),
            partition: job.partition.as_deref(),
            account: job.account.as_deref(),
            log: format!("{folder}/{}-%A_%a.log", job.name),
            export: job.variable_names().join(","),
            program: &job.worker.program,
            arguments: &job.worker.arguments,
            workers,
            last: workers.saturating_sub(1),
            needs_part: job.worker.needs_part(),
            is_long: workers > USUAL_ARRAY_WORKERS,
            usual_array: USUAL_ARRAY_WORKERS,
            warning_s: WARNING_S,
            patience_s: PATIENCE_S,
            tries: MAX_WORKER_RESTARTS,
        },
    )
}

/// Checks a time: Slurm must be able to read it, and it must be longer than the time from the earliest
/// possible warning to the end.
fn check_time(time: &str) -> Result<(), LaunchError> {
    let least = WARNING_S + MAX_EARLY_S;
    match parse_seconds(time) {
        None => Err(value_error("--time", time, "is no time", "write minutes, H:MM:SS, or D-HH:MM:SS, as in 4:00:00")),
        Some(total) if total <= u64::from(least) => Err(value_error(
            "--time",
            time,
            &format!("is too short: a worker is told {WARNING_S} to {least} s before its time is up"),
            "give at least 4 minutes; hours are better, because each start loads everything again",
        )),
        Some(_) => Ok(()),
    }
}

/// `MINUTES`, `MM:SS`, `HH:MM:SS`, `D-HH`, `D-HH:MM` or `D-HH:MM:SS` in seconds.
fn parse_seconds(time: &str) -> Option<u64> {
    let number = |text: &str| -> Option<u64> {
        let is_number = (1..=6).contains(&text.len()) && text.chars().all(|c| c.is_ascii_digit());
        if is_number { text.parse().ok() } else { None }
    };
    let (days, rest) = time.split_once('-').map_or((None, time), |(days, rest)| (Some(days), rest));
    let parts = rest.split(':').map(number).collect::<Option<Vec<u64>>>()?;
    let in_day = match (days, parts.as_slice()) {
        (None, [minutes]) => minutes * 60,
        (None, [minutes, seconds]) => minutes * 60 + seconds,
        (Some(_), [hours]) => hours * 3600,
        (Some(_), [hours, minutes]) => hours * 3600 + minutes * 60,
        (_, [hours, minutes, seconds]) => hours * 3600 + minutes * 60 + seconds,
        _ => return None,
    };
    Some(days.map_or(Some(0), number)? * 86400 + in_day)
}

/// Checks an amount of memory: a whole number, and a unit or none.
fn check_memory(memory: &str) -> Result<(), LaunchError> {
    let digits = memory.strip_suffix(['K', 'M', 'G', 'T']).unwrap_or(memory);
    match (1..=9).contains(&digits.len()) && digits.chars().all(|c| c.is_ascii_digit()) {
        true => Ok(()),
        false => {
            Err(value_error("--memory", memory, "is no amount of memory", "write a whole number and a unit, as in 16G"))
        }
    }
}

/// Checks the folder of the logs. Quotes and backslashes are refused, because sbatch reads them by its own rules.
fn check_logs(logs: &str) -> Result<(), LaunchError> {
    check_text("--logs", logs)?;
    match logs.contains(['"', '\\']) {
        true => Err(value_error(
            "--logs",
            logs,
            "has a quote or a backslash, which sbatch reads otherwise",
            "rename the folder",
        )),
        false => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_read_as_slurm_reads_them() {
        for (time, expected) in [
            ("90", 5400),
            ("5:30", 330),
            ("4:00:00", 14400),
            ("1-12", 129_600),
            ("1-12:30", 131_400),
            ("2-00:00:01", 172_801),
        ] {
            assert_eq!(parse_seconds(time), Some(expected), "{time}");
        }
        for wrong in ["", "4h", "1:2:3:4", "-1", "1-", "1-2-3", ":", "1:", "4:00:00\n", "9999999"] {
            assert_eq!(parse_seconds(wrong), None, "{wrong:?}");
        }
    }

    #[test]
    fn a_time_that_is_over_when_the_warning_comes_is_refused() {
        for wrong in ["3", "2:59", "0:03:00", "0"] {
            assert!(check_time(wrong).unwrap_err().to_string().contains("too short"), "{wrong}");
        }
        check_time("4").unwrap();
    }
}
