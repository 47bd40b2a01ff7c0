//! `wayword study`: makes a study from runs, serves it to people, and writes its results.

mod candidates;
mod choose_paths;
mod corrupted;
mod ground_survey;
mod lent_texts;
mod marks;
mod messages;
mod new_study;
mod pictures;
mod serve;

use crate::study_args::{
    StudyArgs as Args, StudyCommand, StudyForget, StudyInvite, StudyPlan, StudyResults, StudyStatus,
};
use messages::{ClosedNotice, PersonalLinks, ReconciliationTable, RemovalReport, StudyStatusReport, unused_links_note};
use serde::Serialize;
use std::{fmt, path::PathBuf};
use wayword_run::{
    count::count_phrase,
    error::{CommandError, Exit},
    output::CommandOutput,
    written_files::expect_output_folder,
};
use wayword_study::{
    ENGLISH_TEXTS, PageTexts, Study, now_ms,
    results::{PlanQuestion, StudyOutlook},
};

/// Runs `wayword study`: makes, serves and evaluates a study with people.
///
/// # Errors
/// When the study or another input cannot be read, the flags do not fit together, or a file cannot be written.
pub fn run_study(args: &Args, output: &CommandOutput) -> Result<Exit, CommandError> {
    match &args.command {
        StudyCommand::New(args) => new_study::make_study(args, output)?,
        StudyCommand::Serve(args) => return serve::run_serve(args, output),
        StudyCommand::Invite(args) => run_invite(args, output)?,
        StudyCommand::Plan(args) => show_plan(args, output)?,
        StudyCommand::Texts => output.print_result(&PageTexts::default(), ENGLISH_TEXTS.trim_end()),
        StudyCommand::Status(args) => show_status(args, output)?,
        StudyCommand::Results(args) => write_results(args, output)?,
        StudyCommand::Forget(args) => forget_participant(args, output)?,
        StudyCommand::Reconcile(args) => {
            let matched = Study::open(&args.study)?.reconcile_recruiter_list(&args.csv)?;
            output.print_result(&matched, ReconciliationTable(&matched));
        }
        StudyCommand::Close(args) => {
            Study::open(&args.study)?.close(args.even_if_live)?;
            output.print_result(&ClosedNotice, ClosedNotice);
        }
    }
    Ok(Exit::Done)
}

fn show_plan(args: &StudyPlan, output: &CommandOutput) -> Result<(), CommandError> {
    let question = PlanQuestion {
        effect: args.effect / 100.0,
        base_share: args.base / 100.0,
        person_sd: args.person_sd,
        route_sd: args.route_sd,
        routes: args.routes,
        participants: args.participants,
    };
    question.check()?;
    if let Some(doubt) = question.unit_question() {
        output.say(doubt);
    }
    let study = Study::open(&args.study)?;
    if let Some(file) = &args.out {
        Study::check_new_file("--out", file)?;
    }
    let outlook = StudyOutlook::new(&study.plan, &study.settings, &study.items, &question);
    if let Some(file) = &args.out {
        study.write_preregistration(&outlook, file)?;
    }
    output.print_result(&outlook, &outlook);
    Ok(())
}

fn run_invite(args: &StudyInvite, output: &CommandOutput) -> Result<(), CommandError> {
    let links = make_links(&Study::open(&args.study)?, args.count, &args.url)?;
    output.print_result(&links, &links);
    if let Some(note) = unused_links_note(links.links.len(), links.unused_before) {
        output.say(note);
    }
    Ok(())
}

/// New personal links to the site at an address.
fn make_links(study: &Study, count: u32, url: &str) -> Result<PersonalLinks, CommandError> {
    let made = study.invite_participants(count)?;
    let links = made.tokens.into_iter().map(|token| format!("{url}/t/{token}")).collect();
    Ok(PersonalLinks { links, unused_before: made.unused_before })
}

fn show_status(args: &StudyStatus, output: &CommandOutput) -> Result<(), CommandError> {
    let study = Study::open(&args.study)?;
    let progress = study.read_progress()?;
    // Results that were written before a deletion still contain the deleted answers.
    let exports = if progress.forgotten > 0 { study.list_exports()? } else { Vec::new() };
    let participants = args.participants.then(|| study.into_data().map(|data| data.participants)).transpose()?;
    let report = StudyStatusReport { progress, exports, participants };
    output.print_result(&report, &report);
    Ok(())
}

fn forget_participant(args: &StudyForget, output: &CommandOutput) -> Result<(), CommandError> {
    let study = Study::open(&args.study)?;
    let exports = study.list_exports()?;
    let removed = RemovalReport { removed: study.forget_participant(&args.participant, args.dry_run)?, exports };
    output.print_result(&removed, &removed);
    Ok(())
}

/// The files that `wayword study results` wrote.
#[derive(Debug, Serialize)]
struct WrittenResults {
    /// The number of answers that the figures are computed from.
    answers: usize,
    files: Vec<PathBuf>,
}

impl fmt::Display for WrittenResults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for file in &self.files {
            writeln!(f, "{}", file.display())?;
        }
        write!(f, "{}", count_phrase(self.answers, "answer"))
    }
}

fn write_results(args: &StudyResults, output: &CommandOutput) -> Result<(), CommandError> {
    let study = Study::open(&args.study)?;
    expect_output_folder(&args.out)?;
    Study::check_outside("--out", &args.out)?;
    study.note_export(&args.out)?;
    let data = study.into_data()?;
    let answers = data.slots.iter().filter(|slot| slot.answer.is_some() && slot.position.is_some()).count();
    let written =
        WrittenResults { answers, files: wayword_study::compute_results(&data, now_ms())?.write_files(&args.out)? };
    output.print_result(&written, &written);
    Ok(())
}
