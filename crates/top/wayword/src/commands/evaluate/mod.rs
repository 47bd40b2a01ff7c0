//! `wayword evaluate`.

mod figures;
mod handed_in;
mod refusal;

use crate::{
    cli::Evaluate as Args,
    demands::Demands,
    episodes,
    error::{Error, Exit},
    output::Output,
    run::write_whole,
    world,
};
use figures::{Drawn, Report};
use handed_in::{Scored, score_all};
use refusal::{Problem, Refusal};
use std::path::Path;
use wayword_formats::submission;
use wayword_metrics::Rule;

pub(super) fn run(args: &Args, output: &Output) -> Result<Exit, Error> {
    let platform = world::open_named(args.world.platform.as_deref().unwrap_or("house"), args.world.data.as_deref())?;
    let episodes = episodes::read(&args.episodes, platform.as_ref())?;
    let submitted = match submission::read(&args.submission) {
        Ok(submitted) => submitted,
        Err(submission::Refused(problems)) => {
            let told = problems.told.iter().map(|problem| Problem::of_file(&problem.to_string())).collect();
            return refuse(Refusal::new(&args.submission, told, problems.untold), output);
        }
    };
    let scored = match score_all(&episodes, submitted, &Demands::new(platform.as_ref()))? {
        Ok(scored) => scored,
        Err(problems) => return refuse(Refusal::new(&args.submission, problems, 0), output),
    };
    let rules = rules(args, &scored)?;
    if let Some(file) = &args.per_item {
        write_each(file, &scored)?;
    }
    let drawn = Drawn { resamples: args.resamples as usize, seed: args.seed };
    let report = Report::new(args, &scored, &rules, drawn);
    output.data(&report, &report);
    Ok(Exit::Done)
}

/// Tells what is wrong; nothing is scored.
fn refuse(refusal: Refusal, output: &Output) -> Result<Exit, Error> {
    output.data(&refusal, &refusal);
    Err(refusal.into_error())
}

/// The rules that are asked for and can be applied.
fn rules(args: &Args, scored: &[Scored<'_>]) -> Result<Vec<Rule>, Error> {
    let has_visible = scored.iter().any(|scored| scored.score.visible.is_some());
    match args.rule.map(Rule::from) {
        Some(Rule::Visible) if !has_visible => Err(Error::usage(
            format!("--rule visible: no item of {} names an object whose place is known", args.episodes.display()),
            "judge by distance with --rule distance",
        )),
        Some(rule) => Ok(vec![rule]),
        None if has_visible => Ok(vec![Rule::Visible, Rule::Distance]),
        None => Ok(vec![Rule::Distance]),
    }
}

fn write_each(file: &Path, scored: &[Scored<'_>]) -> Result<(), Error> {
    let mut lines = String::new();
    for scored in scored {
        let line = serde_json::to_string(scored).map_err(|error| Error::io(file, "write")(error.into()))?;
        lines.push_str(&line);
        lines.push('\n');
    }
    write_whole(file, &lines)
}
