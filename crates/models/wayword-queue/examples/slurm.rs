//! Writes a script for Slurm, for `trials/scale/slurm.sh`:
//!
//! ```sh
//! cargo run --package wayword-queue --example slurm -- WORKERS TIME LOGS VARIABLE PROGRAM [ARGUMENT...] >script
//! ```

use std::{
    env,
    error::Error,
    io::{self, Write as _},
};
use wayword_queue::launch::{
    LaunchWorker,
    slurm::{SlurmJob, write_script},
};

fn main() -> Result<(), Box<dyn Error>> {
    let mut given = env::args().skip(1);
    let mut next = |what: &str| given.next().ok_or_else(|| format!("{what} is missing"));
    let workers = next("WORKERS")?.parse()?;
    let (time, logs, variable, program) = (next("TIME")?, next("LOGS")?, next("VARIABLE")?, next("PROGRAM")?);
    let worker = LaunchWorker { program, arguments: given.collect(), workers };
    let job = SlurmJob { logs, export: vec![variable], ..SlurmJob::new(worker, &time) };
    io::stdout().write_all(write_script(&job)?.as_bytes())?;
    Ok(())
}
