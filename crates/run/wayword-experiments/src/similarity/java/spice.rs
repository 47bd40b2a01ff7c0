//! Runs SPICE 1.0 in the same way as `spice.py` of `pycocoevalcap`: it gets texts as JSON in a file, and writes scores to another.

use super::{JavaProcess, TextWithReferences};
use crate::similarity::args::SimilarityArgs as Args;
use serde_json::{Value, json};
use std::{
    fs,
    path::{Path, PathBuf},
    process::{self, Command},
};
use wayword_run::error::CommandError;

/// Most bytes of the file of scores that is read, 256 MiB; a larger file counts as a failure of SPICE.
const MAX_SCORE_FILE_BYTES: u64 = 256 << 20;

/// The mean F score of a set of texts. Texts whose score is no number are left out, as in the reference.
pub(super) fn spice_score(args: &Args, jar: &Path, texts: &[TextWithReferences]) -> Result<f64, CommandError> {
    let folder = SpiceFolder::new()?;
    let [input_file, score_file, cache] = ["in.json", "out.json", "cache"].map(|name| folder.0.join(name));
    let to_entry =
        |(at, row): (usize, &TextWithReferences)| json!({ "image_id": at, "test": row.text, "refs": row.references });
    let all = Value::from(texts.iter().enumerate().map(to_entry).collect::<Vec<_>>());
    fs::write(&input_file, all.to_string()).map_err(CommandError::io(&input_file, "write"))?;
    fs::create_dir(&cache).map_err(CommandError::io(&cache, "make the folder"))?;
    let mut command = Command::new(&args.java);
    command
        .arg("-Xmx8G")
        .arg("-jar")
        .arg(absolute_path(jar))
        .arg(&input_file)
        .arg("-cache")
        .arg(&cache)
        .arg("-out")
        .arg(&score_file);
    command.args(["-subset", "-silent"]);
    let (running, pipes) = JavaProcess::start(&mut command)?;
    // Its output has no use, but is read, because a full pipe would block the program.
    drop(pipes.input);
    if let Some(mut output) = pipes.output {
        let _ = std::io::copy(&mut output, &mut std::io::sink());
    }
    let failed = || {
        let problem = format!("{}: the program failed, or did not answer as SPICE does", jar.display());
        CommandError::usage(problem, "use spice-1.0.jar with Stanford's models in lib/ beside it, and Java 8")
    };
    let is_there = fs::metadata(&score_file).is_ok_and(|file| file.len() <= MAX_SCORE_FILE_BYTES);
    if !running.wait_for_success() || !is_there {
        return Err(failed());
    }
    let text = fs::read_to_string(&score_file).map_err(CommandError::io(&score_file, "read"))?;
    let answers: Vec<Value> = serde_json::from_str(&text).map_err(|_| failed())?;
    let scores: Vec<f64> = answers.iter().filter_map(|answer| answer["scores"]["All"]["f"].as_f64()).collect();
    if answers.len() != texts.len() || scores.is_empty() {
        return Err(failed());
    }
    Ok(scores.iter().sum::<f64>() / scores.len() as f64)
}

fn absolute_path(file: &Path) -> PathBuf {
    file.canonicalize().unwrap_or_else(|_| file.to_owned())
}

/// A temporary folder, deleted when this value is dropped.
struct SpiceFolder(PathBuf);

impl SpiceFolder {
    fn new() -> Result<Self, CommandError> {
        let name = |number: u32| std::env::temp_dir().join(format!("wayword-spice-{}-{number}", process::id()));
        let made = (0..100).map(name).find(|folder| fs::create_dir(folder).is_ok());
        made.map(Self).ok_or_else(|| {
            let problem = format!("{}: no folder can be made there", std::env::temp_dir().display());
            CommandError::usage(problem, "make room, or set TMPDIR to a folder that can be written")
        })
    }
}

impl Drop for SpiceFolder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
