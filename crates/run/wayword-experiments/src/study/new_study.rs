//! `wayword study new`: chooses paths and texts, draws the pictures, and writes the folder of a study.

use super::{
    choose_paths::{ChosenWalks, StudyWalk, choose_walks, study_conditions},
    ground_survey::{GROUND_FILE, GroundSurvey},
    marks, pictures,
};
use crate::study_args::{StudyMode, StudyNew, StudyRecruiter};
use serde::Serialize;
use std::{collections::BTreeSet, fmt, fs, path::PathBuf};
use wayword_core::Platform;
use wayword_language::Language;
use wayword_report::view;
use wayword_run::{
    count::count_phrase, error::CommandError, interrupt, output::CommandOutput, terms, written_files::write_file,
};
use wayword_study::{
    CompletionCodes, PageTexts, RecruiterSettings, Study, StudyCondition, StudyDesign, StudyItem, StudyRoute,
    StudySettings, StudyTask, StudyText,
};
use wayword_synthesis::style::built_in;

/// The folder of the pictures, in that of the study.
const PICTURES_FOLDER: &str = "pictures";
/// Most examples of a style that raters see.
const MAX_STYLE_EXAMPLES: usize = 3;

/// A summary of the study that was made.
#[derive(Debug, Serialize)]
struct NewStudySummary {
    study: PathBuf,
    mode: StudyTask,
    conditions: Vec<String>,
    routes: usize,
    items: usize,
    answers: u64,
    pictures: usize,
    has_practice: bool,
    /// What the viewpoint graph is worth, where people walk over it.
    #[serde(skip_serializing_if = "Option::is_none")]
    ground: Option<GroundSurvey>,
}

impl fmt::Display for NewStudySummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (routes, items) = (count_phrase(self.routes, "path"), count_phrase(self.items, "item"));
        let practice = if self.has_practice { " and one more for practice" } else { "" };
        let answers = count_phrase(self.answers, "answer");
        writeln!(f, "{}: {routes}{practice}; {items}, {answers} wanted", self.study.display())?;
        writeln!(f, "conditions: {}", self.conditions.join(", "))?;
        if let Some(ground) = &self.ground {
            writeln!(f, "{ground}")?;
        }
        if !self.has_practice {
            writeln!(
                f,
                "there is no practice: no path was left for it whose text the study does not need; give more paths"
            )?;
        }
        write!(
            f,
            "next: word study.toml (title, contact, consent), then `wayword study serve {} --links 1`",
            self.study.display()
        )
    }
}

/// The message that there are fewer paths than the user asked for.
fn missing_paths(asked: u32, routes: usize, has_practice: bool) -> String {
    let fit = count_phrase(routes + usize::from(has_practice), "path");
    let verb = if routes + usize::from(has_practice) == 1 { "has" } else { "have" };
    let practice = if has_practice {
        format!("{routes} in the study, and one for practice")
    } else {
        "none for practice".to_owned()
    };
    let wanted = asked + u32::from(has_practice);
    format!(
        "--items {asked}: only {fit} {verb} a text of every condition: {practice}; a run of {wanted} or more such paths, and another --out, \
         give {asked}"
    )
}

/// The tag of the language that all texts are in, where it has other letters than English; else empty.
fn text_language(items: &[StudyItem]) -> String {
    let texts = items.iter().flat_map(|item| &item.texts);
    let tags: BTreeSet<Option<&str>> = texts.map(|text| Language::tag_of_script(&text.text)).collect();
    tags.first().filter(|_| tags.len() == 1).copied().flatten().unwrap_or_default().to_owned()
}

pub(super) fn make_study(args: &StudyNew, output: &CommandOutput) -> Result<(), CommandError> {
    let _interrupt_guard = interrupt::finish_items_first(None);
    let mode = match args.mode {
        StudyMode::Follow => StudyTask::Follow,
        StudyMode::Rate => StudyTask::Rate,
        StudyMode::Pair => StudyTask::Pair,
    };
    let platform = view::open_platform(&args.platform)?;
    check_pictures(args, mode, &*platform)?;
    if Study::is_in(&args.out) {
        let problem = format!("{}: there is a study already", args.out.display());
        return Err(CommandError::usage(problem, "give another --out; a study that people see is not changed"));
    }
    Study::check_outside("--out", &args.out)?;
    let conditions = study_conditions(args)?;
    let texts = args.texts.as_deref().map_or_else(|| Ok(PageTexts::default()), PageTexts::read)?;
    let ChosenWalks { mut walks, routes, has_practice } = choose_walks(args, mode, &conditions, &*platform, output)?;
    if routes < args.items as usize {
        output.say(missing_paths(args.items, routes, has_practice));
    }
    marks::mark_doubts(&mut walks, &conditions, &*platform, output)?;
    let ground = match mode {
        StudyTask::Follow => Some(GroundSurvey::of_walks(&walks, &*platform, args.seed)?),
        StudyTask::Rate | StudyTask::Pair => None,
    };
    let new_folder = NewFolder::make(&args.out)?;
    let folder = new_folder.pictures();
    let scenes = match mode {
        StudyTask::Follow => pictures::draw_scenes(&walks, &*platform, &folder, output)?,
        StudyTask::Rate | StudyTask::Pair => Vec::new(),
    };
    let study_routes = draw_routes(&walks, mode, &*platform, &folder, output)?;
    let pictures = scenes.iter().map(|scene| scene.places.len()).sum::<usize>()
        + study_routes.iter().map(|route| route.film.len()).sum::<usize>();
    let items = study_items(&walks, mode, has_practice);
    let style = first_style(args);
    let per_participant = args.per_participant.min(u32::try_from(routes).unwrap_or(u32::MAX));
    let mut settings = StudySettings::in_language(mode, per_participant, &texts);
    settings.recruiter = recruiter_settings(args.recruiter);
    settings.codes = completion_codes(args.recruiter);
    settings.examples = style_examples(&style);
    settings.text_language = text_language(&items);
    let plan = StudyDesign { mode, seed: args.seed, per_item: args.per_item, per_participant, conditions, style };
    let wanted = items.iter().filter(|item| !item.is_practice).count();
    let summary = NewStudySummary {
        study: args.out.clone(),
        mode,
        conditions: plan.conditions.iter().map(|condition: &StudyCondition| condition.name.clone()).collect(),
        routes,
        items: wanted,
        answers: wanted as u64 * u64::from(args.per_item),
        pictures,
        has_practice,
        ground,
    };
    if let Some(ground) = &summary.ground {
        let file = args.out.join(GROUND_FILE);
        let json = serde_json::to_vec_pretty(ground)
            .map_err(|error| CommandError::usage(format!("{}: {error}", file.display()), "report this fault"))?;
        write_file(&file, json)?;
    }
    Study { folder: args.out.clone(), plan, settings, texts, items, routes: study_routes, scenes }.create()?;
    new_folder.keep();
    output.print_result(&summary, &summary);
    Ok(())
}

/// The folder of a study in the making. Unless it is kept, dropping it removes what this command made, so that a study that failed
/// leaves nothing behind. A command that was interrupted keeps its pictures: the same command goes on with them.
struct NewFolder {
    folder: PathBuf,
    /// The outermost folder that did not exist before.
    made: Option<PathBuf>,
    is_kept: bool,
}

impl NewFolder {
    fn make(out: &std::path::Path) -> Result<Self, CommandError> {
        let pictures = out.join(PICTURES_FOLDER);
        let made = pictures.ancestors().take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists()).last();
        let new = Self { folder: out.to_owned(), made: made.map(std::path::Path::to_owned), is_kept: false };
        fs::create_dir_all(&pictures).map_err(CommandError::io(&pictures, "make the folder"))?;
        Ok(new)
    }

    fn pictures(&self) -> PathBuf {
        self.folder.join(PICTURES_FOLDER)
    }

    fn keep(mut self) {
        self.is_kept = true;
    }
}

impl Drop for NewFolder {
    fn drop(&mut self) {
        if let Some(made) = self.made.as_ref().filter(|_| !self.is_kept && interrupt::check_interrupt().is_ok()) {
            // What cannot be removed stays; the error of the command matters more.
            let _ = fs::remove_dir_all(made);
        }
    }
}

/// Refuses a platform in which participants cannot walk, and pictures that the user may not show to them.
fn check_pictures(args: &StudyNew, mode: StudyTask, platform: &dyn Platform) -> Result<(), CommandError> {
    let name = platform.name();
    if mode == StudyTask::Follow && name == "recording" {
        let problem = "--mode follow: a recording shows one way only, and has no viewpoint graph that one could walk";
        return Err(CommandError::usage(problem, "use --mode rate or --mode pair"));
    }
    let problem = format!("the pictures of platform {name} are somebody's, and participants would see them");
    terms::check_right(name, args.i_have_the_right, problem, "show")
}

/// The routes of the study. The last one is for practice.
fn draw_routes(
    walks: &[StudyWalk],
    mode: StudyTask,
    platform: &dyn Platform,
    folder: &std::path::Path,
    output: &CommandOutput,
) -> Result<Vec<StudyRoute>, CommandError> {
    let is_watched = mode != StudyTask::Follow;
    let bar = output.progress_bar(walks.len(), "paths");
    let route = |(id, walk): (u32, &StudyWalk)| {
        let film = if is_watched { pictures::draw_film(walk, platform, folder)? } else { Vec::new() };
        bar.inc(1);
        Ok(StudyRoute {
            id,
            name: walk.name.clone(),
            scene: walk.path.scene.clone(),
            viewpoints: walk.viewpoints.clone(),
            start_heading: walk.start_heading,
            film,
        })
    };
    let routes = (0..).zip(walks).map(route).collect();
    bar.finish_and_clear();
    routes
}

/// The items of the study: each route with each of its texts, or, if people compare pairs, with each two of them. The last route
/// is for practice, and gets only one item.
fn study_items(walks: &[StudyWalk], mode: StudyTask, has_practice: bool) -> Vec<StudyItem> {
    let mut items: Vec<StudyItem> = Vec::new();
    for (route, walk) in (0..).zip(walks) {
        let is_practice = has_practice && route as usize == walks.len() - 1;
        let text_groups: Vec<Vec<StudyText>> = match mode {
            StudyTask::Pair => text_pairs(&walk.condition_texts),
            StudyTask::Follow | StudyTask::Rate => walk.condition_texts.iter().map(|text| vec![text.clone()]).collect(),
        };
        let text_groups = if is_practice { &text_groups[..1] } else { &text_groups[..] };
        for texts in text_groups {
            let id = u32::try_from(items.len()).unwrap_or(u32::MAX);
            items.push(StudyItem { id, route, is_practice, texts: texts.clone() });
        }
    }
    items
}

/// Each two of these texts, in their order.
fn text_pairs(texts: &[StudyText]) -> Vec<Vec<StudyText>> {
    let pairs_with_later = |at: usize| texts[at + 1..].iter().map(move |other| vec![texts[at].clone(), other.clone()]);
    (0..texts.len()).flat_map(pairs_with_later).collect()
}

/// The style of the first run, if its source names one; otherwise empty.
fn first_style(args: &StudyNew) -> String {
    args.run.first().and_then(|set| set.source.rsplit_once('#')).map(|(_, style)| style.to_owned()).unwrap_or_default()
}

fn style_examples(style: &str) -> Vec<String> {
    built_in(style).map(|style| style.references.into_iter().take(MAX_STYLE_EXAMPLES).collect()).unwrap_or_default()
}

fn recruiter_settings(recruiter: StudyRecruiter) -> RecruiterSettings {
    let parameters = |person: &str, session: &str, study: &str| RecruiterSettings::Parameters {
        person: person.to_owned(),
        session: session.to_owned(),
        study: study.to_owned(),
        only_study: String::new(),
    };
    match recruiter {
        StudyRecruiter::Links => RecruiterSettings::Links,
        StudyRecruiter::Prolific => parameters("PROLIFIC_PID", "SESSION_ID", "STUDY_ID"),
        StudyRecruiter::Mturk => parameters("workerId", "assignmentId", "hitId"),
    }
}

fn completion_codes(recruiter: StudyRecruiter) -> CompletionCodes {
    let return_url = match recruiter {
        StudyRecruiter::Prolific => "https://app.prolific.com/submissions/complete?cc={code}".to_owned(),
        StudyRecruiter::Links | StudyRecruiter::Mturk => String::new(),
    };
    CompletionCodes { return_url, ..CompletionCodes::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_that_is_not_kept_goes_with_all_that_was_made() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("deep/study");
        drop(NewFolder::make(&out).unwrap());
        assert!(!folder.path().join("deep").exists());
        NewFolder::make(&out).unwrap().keep();
        assert!(out.join(PICTURES_FOLDER).is_dir());
        fs::write(out.join("notes.txt"), "mine").unwrap();
        drop(NewFolder::make(&out).unwrap());
        assert!(out.join("notes.txt").exists() && out.join(PICTURES_FOLDER).exists(), "they were there before");
    }
}
