//! `wayword launch`: prints the script (Slurm) or manifest (Kubernetes) that starts many workers, or submits it.

pub(crate) mod args;
use crate::{
    cli::{WaywordCli, WaywordCommand, parse_arguments},
    launch::args::{LaunchArgs, LaunchCommand, LaunchKubernetes, LaunchSlurm},
};
use serde_json::json;
use std::{
    borrow::Cow,
    ffi::OsString,
    fs,
    io::Write,
    process::{Command, Stdio},
};
use wayword_queue::launch::{
    LaunchWorker,
    kubernetes::{KubernetesJob, SecretEnv, SecretFile, SharedFolder, write_manifest},
    slurm::{SlurmJob, write_script},
};
use wayword_run::{
    error::{CommandError, Exit},
    generate::{ChunkedItems, args::GenerateArgs},
    output::{CommandOutput, mask_credentials},
    settings_file::read_settings,
    stores::store_address,
};

pub(crate) fn run_launch(args: &LaunchArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    match &args.command {
        LaunchCommand::Slurm(args) => launch_slurm(args, output),
        LaunchCommand::Kubernetes(args) => launch_kubernetes(args, output),
    }
}

fn launch_slurm(args: &LaunchSlurm, output: &CommandOutput) -> Result<Exit, CommandError> {
    warn_of_idle_workers(&parse_worker_command(&args.arguments)?, args.workers, output)?;
    let worker = make_worker(&args.program, &args.arguments, args.workers)?;
    let text = write_script(&SlurmJob {
        name: args.name.clone(),
        gpus: args.gpus,
        cpus: args.cpus,
        memory: args.memory.clone(),
        partition: args.partition.clone(),
        account: args.account.clone(),
        logs: args.logs.clone(),
        export: args.export.clone(),
        ..SlurmJob::new(worker, &args.time)
    })?;
    if args.submit {
        // Slurm starts no job if it cannot write its log.
        fs::create_dir_all(&args.logs).map_err(CommandError::io(&args.logs, "make the folder of the logs"))?;
        let sbatch_output = submit_job(&text)?;
        output.print_result(&json!({ "submitted": sbatch_output }), &sbatch_output);
    } else {
        output.print_result(&json!({ "script": text }), &text);
    }
    Ok(Exit::Done)
}

fn launch_kubernetes(args: &LaunchKubernetes, output: &CommandOutput) -> Result<Exit, CommandError> {
    let command = parse_worker_command(&args.arguments)?;
    warn_of_idle_workers(&command, args.workers, output)?;
    refuse_unshared_folder(&command, args.shared_claim.as_ref().map(|shared| shared.right.as_str()))?;
    let secret = |typed: &str, flag: &str| {
        let (secret, key) = typed.split_once('/').ok_or_else(|| {
            CommandError::usage(format!("{flag}: there is no slash between the secret and its key"), "write SECRET/KEY")
        })?;
        Ok::<_, CommandError>(SecretFile { secret: secret.to_owned(), key: key.to_owned() })
    };
    let variables = args.secret.iter().map(|pair| {
        let SecretFile { secret, key } = secret(&pair.right, "--secret")?;
        Ok(SecretEnv { name: pair.left.clone(), secret, key })
    });
    let shared = args.shared_claim.clone().map(|pair| SharedFolder { claim: pair.left, mount: pair.right });
    let text = write_manifest(&KubernetesJob {
        name: args.name.clone(),
        namespace: args.namespace.clone(),
        cpus: args.cpus.clone(),
        memory: args.memory.clone(),
        gpus: args.gpus,
        shared,
        secrets: variables.collect::<Result<_, CommandError>>()?,
        pass_file: args.pass_file.as_deref().map(|typed| secret(typed, "--pass-file")).transpose()?,
        // The image starts the program by itself.
        ..KubernetesJob::new(make_worker("", &args.arguments, args.workers)?, &args.image)
    })?;
    output.print_result(&json!({ "manifest": text }), &text);
    Ok(Exit::Done)
}

/// The command of the workers as they will read it. Refuses one that would end each of them at once.
///
/// # Errors
/// When it is not `generate`, its flags are wrong or do not fit together, or it names a part itself.
fn parse_worker_command(arguments: &[String]) -> Result<GenerateArgs, CommandError> {
    if arguments.first().map(String::as_str) != Some("generate") {
        let (problem, hint) = match arguments.first().map(String::as_str) {
            Some("wayword") => {
                ("the workers' command begins with wayword", "leave that word out, as in -- generate --out DIR")
            }
            _ => ("only `generate` has workers", "write it after two hyphens, as in -- generate --out DIR"),
        };
        return Err(CommandError::usage(problem, hint));
    }
    let words = ["wayword"].into_iter().chain(arguments.iter().map(String::as_str)).map(OsString::from).collect();
    let args = match parse_arguments(words) {
        Ok(WaywordCli { command: WaywordCommand::Generate(args), .. }) => args,
        Ok(_) => {
            return Err(CommandError::usage("only `generate` has workers", "write it first after the two hyphens"));
        }
        Err(error) => {
            let text = error.render().to_string();
            let first = text.lines().next().unwrap_or_default().trim_start_matches("error: ");
            let tip = text.lines().find_map(|line| line.trim_start().strip_prefix("tip: "));
            let hint = tip.unwrap_or("`wayword generate --help` lists its flags");
            return Err(CommandError::usage(format!("the workers' command: {first}"), hint));
        }
    };
    if args.workers.shard.is_some() || args.workers.plan || args.dry_run {
        return Err(CommandError::usage(
            "the workers' command has --shard, --plan or --dry-run, so that no worker would make its own part",
            "leave it out: each worker gets its part by its number",
        ));
    }
    // A settings file may lie where only the workers can read it.
    if let Ok(file) = read_settings(args.config.as_deref()) {
        args.asked.clone().or_file(file).resolve()?;
    }
    Ok(*args)
}

/// Refuses pods that would write into their own file systems, which end with them.
fn refuse_unshared_folder(command: &GenerateArgs, shared: Option<&str>) -> Result<(), CommandError> {
    let Some(out) = command.out.as_ref().filter(|out| store_address(out).is_none()) else { return Ok(()) };
    let problem = match shared {
        None => {
            "the workers share no folder, so each would write into its own file system, which ends with it".to_owned()
        }
        Some(shared) if !out.starts_with(shared) => {
            format!("--out {} is not in the folder that the workers share, {shared}", out.display())
        }
        Some(_) => return Ok(()),
    };
    Err(CommandError::usage(problem, "give --shared-claim CLAIM=/DIR, and the workers --out /DIR/NAME"))
}

/// Warns if the run has fewer chunks than workers, as far as this machine can know.
fn warn_of_idle_workers(command: &GenerateArgs, workers: u32, output: &CommandOutput) -> Result<(), CommandError> {
    let workers = usize::try_from(workers).unwrap_or(usize::MAX);
    let items = ChunkedItems::of_command(command, command.workers.queue.is_none().then_some(workers))?;
    let warning = items.and_then(|items| items.idle_warning(workers));
    warning.iter().for_each(|warning| output.say(warning));
    Ok(())
}

/// The command of each worker. Refuses one without a folder, and one that shows a secret.
fn make_worker(program: &str, arguments: &[String], workers: u32) -> Result<LaunchWorker, CommandError> {
    let has = |flag: &str| arguments.iter().any(|typed| typed == flag || typed.starts_with(&format!("{flag}=")));
    if !has("--out") && !has("--config") {
        return Err(CommandError::usage(
            "the workers have no folder",
            "add --out DIR, a folder that all of them share",
        ));
    }
    if arguments.iter().any(|typed| matches!(mask_credentials(typed), Cow::Owned(_))) {
        return Err(CommandError::usage(
            "an argument of the workers has a password, a key or a token in it, and the text would show it to others",
            "give it to the workers in an environment variable: --export, or --secret",
        ));
    }
    Ok(LaunchWorker { program: program.to_owned(), arguments: arguments.to_vec(), workers })
}

/// Hands a script to sbatch, and returns its output.
fn submit_job(script: &str) -> Result<String, CommandError> {
    let failed =
        |problem: String| CommandError::usage(problem, "submit the printed script by hand: leave --submit out");
    let started = Command::new("sbatch").stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut sbatch = started.map_err(|error| failed(format!("sbatch cannot be started: {error}")))?;
    if let Some(mut input) = sbatch.stdin.take() {
        input.write_all(script.as_bytes()).map_err(|error| failed(format!("sbatch took no script: {error}")))?;
    }
    let ended = sbatch.wait_with_output().map_err(|error| failed(format!("sbatch did not end: {error}")))?;
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
    if ended.status.success() {
        Ok(text(&ended.stdout))
    } else {
        Err(failed(format!("sbatch: {}", text(&ended.stderr))))
    }
}
