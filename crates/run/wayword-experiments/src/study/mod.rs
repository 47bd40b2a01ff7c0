//! `wayword study`: makes a study from runs, serves it to people, and writes its results.

mod marks;
mod new;
mod pictures;
mod serve;
mod told;
mod walks;

use crate::study_args::{Study as Args, StudyCommand, StudyForget, StudyInvite, StudyResults, StudyStatus};
use serde::Serialize;
use std::{fmt, path::PathBuf};
use told::{Closed, Links, Matched, Removed, Standing};
use wayword_run::{
    count::count,
    error::{Error, Exit},
    output::Output,
};
use wayword_study::{Study, now_ms, results::Outlook};

pub fn run(args: &Args, output: &Output) -> Result<Exit, Error> {
    match &args.command {
        StudyCommand::New(args) => new::make(args, output)?,
        StudyCommand::Serve(args) => return serve::run(args, output),
        StudyCommand::Invite(args) => invite(args, output)?,
        StudyCommand::Plan(args) => {
            let study = Study::open(&args.study)?;
            let outlook = Outlook::new(&study.plan, &study.settings, &study.items);
            output.data(&outlook, &outlook);
        }
        StudyCommand::Status(args) => status(args, output)?,
        StudyCommand::Results(args) => results(args, output)?,
        StudyCommand::Forget(args) => forget(args, output)?,
        StudyCommand::Reconcile(args) => {
            let matched = Study::open(&args.study)?.reconcile(&args.csv)?;
            output.data(&matched, Matched(&matched));
        }
        StudyCommand::Close(args) => {
            Study::open(&args.study)?.close(args.even_if_live)?;
            output.data(&Closed, Closed);
        }
    }
    Ok(Exit::Done)
}

fn invite(args: &StudyInvite, output: &Output) -> Result<(), Error> {
    let links = links(&Study::open(&args.study)?, args.count, &args.url)?;
    output.data(&links, &links);
    Ok(())
}

/// New personal links to the site at an address.
fn links(study: &Study, count: u32, url: &str) -> Result<Links, Error> {
    let tokens = study.invite(count)?.tokens;
    Ok(Links { links: tokens.into_iter().map(|token| format!("{url}/t/{token}")).collect() })
}

fn status(args: &StudyStatus, output: &Output) -> Result<(), Error> {
    let study = Study::open(&args.study)?;
    let progress = study.progress()?;
    // Results that were written before a deletion still contain the deleted answers.
    let exports = if progress.forgotten > 0 { study.exports()? } else { Vec::new() };
    let participants = args.participants.then(|| study.data().map(|data| data.participants)).transpose()?;
    let standing = Standing { progress, exports, participants };
    output.data(&standing, &standing);
    Ok(())
}

fn forget(args: &StudyForget, output: &Output) -> Result<(), Error> {
    let study = Study::open(&args.study)?;
    let exports = study.exports()?;
    let removed = Removed { removed: study.forget(&args.participant, args.dry_run)?, exports };
    output.data(&removed, &removed);
    Ok(())
}

/// The files that `wayword study results` wrote.
#[derive(Debug, Serialize)]
struct Written {
    /// The number of answers that the figures are computed from.
    answers: usize,
    files: Vec<PathBuf>,
}

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for file in &self.files {
            writeln!(f, "{}", file.display())?;
        }
        write!(f, "{}", count(self.answers, "answer"))
    }
}

fn results(args: &StudyResults, output: &Output) -> Result<(), Error> {
    let study = Study::open(&args.study)?;
    study.note_export(&args.out)?;
    let data = study.data()?;
    let answers = data.slots.iter().filter(|slot| slot.answer.is_some() && slot.position.is_some()).count();
    let written = Written { answers, files: wayword_study::results(&data, now_ms())?.write(&args.out)? };
    output.data(&written, &written);
    Ok(())
}
