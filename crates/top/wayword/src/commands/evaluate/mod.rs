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
    platforms,
    run::write_whole,
};
use figures::{Drawn, Report};
use handed_in::{Scored, score_all};
use refusal::{Refusal, no_submission};
use std::{fs, path::Path};
use wayword_formats::submission;
use wayword_metrics::Rule;

pub(super) fn run(args: &Args, output: &Output) -> Result<Exit, Error> {
    refuse_to_overwrite(args)?;
    let platform = platforms::open_named(
        args.platform.name(),
        args.platform.data.as_deref(),
        args.platform.at.as_deref(),
        args.platform.island,
    )?;
    let episodes = episodes::read(&args.episodes, platform.as_ref())?;
    let limit = args.limit.map_or(usize::MAX, |limit| limit as usize).min(episodes.len());
    let (episodes, beyond) = episodes.split_at(limit);
    let reading = submission::read(&args.submission);
    if let Some(error) = no_submission(&args.submission, &reading) {
        return Err(error);
    }
    let all = match score_all(episodes, beyond, reading, &Demands::new(platform.as_ref()), args.partial)? {
        Ok(all) => all,
        Err(problems) => {
            let refusal = Refusal::new(&args.submission, problems);
            output.data(&refusal, &refusal);
            return Err(refusal.into_error());
        }
    };
    if all.scored.is_empty() {
        let problem = format!("{}: no instruction has a trajectory; nothing was scored", args.submission.display());
        return Err(Error::usage(problem, "check that the submission and --episodes belong to the same split"));
    }
    let rules = rules(args, &all.scored)?;
    if let Some(file) = &args.per_item {
        write_each(file, &all.scored)?;
    }
    let drawn = Drawn { resamples: args.resamples as usize, seed: args.seed };
    let report = Report::new(args, &all, &rules, drawn);
    output.data(&report, &report);
    Ok(Exit::Done)
}

/// Refuses a `--per-item` file that is one of the inputs, under whatever name.
fn refuse_to_overwrite(args: &Args) -> Result<(), Error> {
    let Some(Ok(per_item)) = args.per_item.as_ref().map(fs::canonicalize) else {
        // A file that does not exist yet is no input.
        return Ok(());
    };
    for input in [&args.submission, &args.episodes] {
        if fs::canonicalize(input).is_ok_and(|input| input == per_item) {
            let problem = format!("--per-item would overwrite {}, which this command reads", input.display());
            return Err(Error::usage(problem, "give --per-item another file name"));
        }
    }
    Ok(())
}

/// The rules of success that are asked for and can be applied.
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
