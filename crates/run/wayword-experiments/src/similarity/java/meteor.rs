//! Runs METEOR 1.5 in the same way as `meteor.py` of `pycocoevalcap`: it sends `SCORE` for each text, then `EVAL` for all of them.

use super::{JavaProcess, TextWithReferences, read_output_line};
use crate::similarity::args::SimilarityArgs as Args;
use std::{
    io::{BufReader, Write},
    path::Path,
    process::Command,
};
use wayword_run::error::CommandError;

/// The METEOR score of a set of texts.
pub(super) fn meteor_score(args: &Args, jar: &Path, texts: &[TextWithReferences]) -> Result<f64, CommandError> {
    let mut command = Command::new(&args.java);
    command.args(["-Xmx2G", "-jar"]).arg(jar).args(["-", "-", "-stdio", "-l", "en", "-norm"]);
    let (_running, pipes) = JavaProcess::start(&mut command)?;
    let failed = || {
        let problem = format!("{}: the program ended, or did not answer as METEOR does", jar.display());
        CommandError::usage(problem, "use meteor-1.5.jar, with its folder data/ beside it")
    };
    let (Some(mut input), Some(output)) = (pipes.input, pipes.output) else { return Err(failed()) };
    let mut output = BufReader::new(output);
    let mut ask = |question: String| writeln!(input, "{question}").and_then(|()| input.flush()).map_err(|_| failed());
    let mut statistics = String::from("EVAL");
    for TextWithReferences { text, references } in texts {
        let parts: Vec<String> = references.iter().chain([text]).map(|part| without_bars(part)).collect();
        ask(format!("SCORE ||| {}", parts.join(" ||| ")))?;
        statistics.push_str(" ||| ");
        statistics.push_str(&read_output_line(&mut output).ok_or_else(failed)?);
    }
    ask(statistics)?;
    // A score for each text, then that of all.
    let scores: Vec<f64> =
        (0..=texts.len()).map_while(|_| read_output_line(&mut output)).map_while(|score| score.parse().ok()).collect();
    scores.get(texts.len()).copied().filter(|score| score.is_finite()).ok_or_else(failed)
}

/// Removes bars from a text, because they separate the texts of a line.
fn without_bars(text: &str) -> String {
    text.replace("|||", "").split_whitespace().collect::<Vec<_>>().join(" ")
}
