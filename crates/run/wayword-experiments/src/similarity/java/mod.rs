//! Runs METEOR and SPICE, Java programs that the user has installed: starts each one, gives it texts, and reads the scores
//! within a time limit.

mod meteor;
mod spice;

use crate::similarity::args::SimilarityArgs as Args;
use serde::Serialize;
use std::{
    io::{BufRead, Read},
    path::Path,
    process::{Child, Command, Stdio},
    sync::{Arc, Mutex, PoisonError, mpsc},
    thread::{self, JoinHandle},
    time::Duration,
};
use wayword_metrics::captions::{CaptionRow, CaptionRowSets, CaptionVocabulary, NumberedText};
use wayword_run::error::CommandError;

/// Time limit for a program over one set of texts.
const JAVA_TIME_LIMIT: Duration = Duration::from_secs(1800);
/// Most bytes that are read of a line of a program's output, 64 MiB; the rest counts as the next line.
const MAX_LINE_BYTES: u64 = 64 << 20;

/// The scores of one program, over the same sets of texts as the other metrics.
#[derive(Debug, Serialize)]
pub(super) struct JavaScores {
    pub(super) name: &'static str,
    /// The score of A's texts against all of B's texts.
    pub(super) all: Option<f64>,
    /// The score of A's texts against all of B's texts but the first of each item.
    pub(super) rest: Option<f64>,
    /// The score of B's first text of each item against the others of the item.
    pub(super) person: Option<f64>,
    /// The score of another path's text against the same references.
    pub(super) other_path: Option<f64>,
}

/// A text and its references, in tokens with blanks between.
struct TextWithReferences {
    text: String,
    references: Vec<String>,
}

/// Scores one set of texts.
type JavaScorer = fn(&Args, &Path, &[TextWithReferences]) -> Result<f64, CommandError>;

/// Runs the programs that the user named, and gives their scores.
///
/// # Errors
/// When one cannot be started, ends early, takes too long, or answers something else.
pub(super) fn run_java_scorers(
    args: &Args,
    sets: &CaptionRowSets<'_>,
    vocabulary: &CaptionVocabulary,
) -> Result<Vec<JavaScores>, CommandError> {
    let words = vocabulary.words_by_number();
    let line = |text: &NumberedText| text.to_line(&words);
    let mut scores = Vec::new();
    let programs: [(&'static str, Option<&Path>, JavaScorer); 2] = [
        ("METEOR", args.meteor_jar.as_deref(), meteor::meteor_score),
        ("SPICE", args.spice_jar.as_deref(), spice::spice_score),
    ];
    for (name, jar, score) in programs {
        let Some(jar) = jar else { continue };
        if !jar.is_file() {
            let problem = format!("{}: there is no such file", jar.display());
            return Err(CommandError::usage(problem, "give the .jar of the program (docs/CRITICS.md)"));
        }
        let score_rows = |rows: &[CaptionRow<'_>]| -> Result<Option<f64>, CommandError> {
            let texts: Vec<TextWithReferences> = rows
                .iter()
                .map(|row| TextWithReferences {
                    text: line(row.text),
                    references: row.references.iter().map(|reference| line(reference)).collect(),
                })
                .collect();
            (!texts.is_empty()).then(|| score(args, jar, &texts)).transpose()
        };
        scores.push(JavaScores {
            name,
            all: score_rows(&sets.all)?,
            rest: score_rows(&sets.rest)?,
            person: score_rows(&sets.person)?,
            other_path: sets.other_path.as_deref().map_or(Ok(None), score_rows)?,
        });
    }
    Ok(scores)
}

/// A running program. It is killed when it exceeds the time limit, and when this value is dropped.
struct JavaProcess {
    child: Arc<Mutex<Child>>,
    /// The watching thread ends when this sender is dropped.
    done: Option<mpsc::Sender<()>>,
    /// The thread that kills the program at the time limit.
    watch: Option<JoinHandle<()>>,
}

impl JavaProcess {
    fn start(command: &mut Command) -> Result<(Self, JavaPipes), CommandError> {
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
        let name = command.get_program().to_string_lossy().into_owned();
        let mut child = command.spawn().map_err(|error| {
            CommandError::usage(
                format!("{name} cannot be started: {error}"),
                "install Java, or name it with --java PROGRAM",
            )
        })?;
        let pipes = JavaPipes { input: child.stdin.take(), output: child.stdout.take() };
        let child = Arc::new(Mutex::new(child));
        let (done, is_done) = mpsc::channel();
        let watched = Arc::clone(&child);
        let watch = thread::spawn(move || {
            if is_done.recv_timeout(JAVA_TIME_LIMIT) == Err(mpsc::RecvTimeoutError::Timeout) {
                let _ = watched.lock().unwrap_or_else(PoisonError::into_inner).kill();
            }
        });
        Ok((Self { child, done: Some(done), watch: Some(watch) }, pipes))
    }

    /// Waits until the program exits or is killed. Returns whether it was successful.
    fn wait_for_success(&self) -> bool {
        loop {
            let state = self.child.lock().unwrap_or_else(PoisonError::into_inner).try_wait();
            match state {
                Ok(Some(status)) => return status.success(),
                Ok(None) => thread::sleep(Duration::from_millis(20)),
                Err(_) => return false,
            }
        }
    }
}

impl Drop for JavaProcess {
    fn drop(&mut self) {
        drop(self.done.take());
        if let Some(watch) = self.watch.take() {
            let _ = watch.join();
        }
        let mut child = self.child.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = child.kill();
        let _ = child.wait();
    }
}

/// The ends of a program's pipes.
struct JavaPipes {
    input: Option<std::process::ChildStdin>,
    output: Option<std::process::ChildStdout>,
}

/// Reads a line of a program's output; `None` at its end.
fn read_output_line(from: &mut impl BufRead) -> Option<String> {
    let mut line = String::new();
    let count = from.by_ref().take(MAX_LINE_BYTES).read_line(&mut line).ok()?;
    (count > 0).then(|| line.trim().to_owned())
}
