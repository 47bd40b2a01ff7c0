//! `wayword doctor`: tries out platform, models, keys and prompts, and reports for each whether it works, with a hint if it does
//! not.

pub mod args;
mod scenes;

use crate::doctor::args::Doctor;
use serde::Serialize;
use std::fmt;
use wayword_checks::Evidence;
use wayword_core::{Condition, Gaze, Path};
use wayword_remote::Level;
use wayword_run::{
    calls::Calls,
    count::count,
    error::{Error, Exit},
    item::items,
    output::Output,
    platforms,
    run_folder::fresh_id,
    settings::{LABELS, Settings, is_model},
    settings_file as config,
    team::prompts,
};

/// The severity of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Grade {
    Ok,
    Warning,
    Problem,
}

/// The result of one check.
#[derive(Debug, Serialize)]
struct Finding {
    state: Grade,
    about: String,
    told: String,
    /// How to fix it.
    #[serde(skip_serializing_if = "Option::is_none")]
    hint: Option<String>,
}

/// The results of all checks.
#[derive(Debug, Serialize)]
struct Report {
    /// The findings, in the order of the checks.
    findings: Vec<Finding>,
    /// The scenes of the data, if they were to be examined.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    scenes: Vec<Condition>,
}

pub fn run(args: &Doctor, output: &Output) -> Result<Exit, Error> {
    let mut job = args.asked().or(config::read(args.config.as_deref())?).job()?;
    let mut findings = Vec::new();
    let mut examined = Ok(Vec::new());
    if args.scenes {
        examined = scenes::examine(&mut job.settings, output);
        findings.extend(scenes::findings(&examined));
    }
    findings.push(world_finding(&job.settings));
    if job.settings.roles.prompts.is_some() {
        findings.push(match prompts(&job.settings) {
            Ok(prompts) => ok("prompts", format!("every template can be filled; their hash is {}", prompts.hash())),
            Err(error) => problem("prompts", &error),
        });
    }
    match Calls::open(&job, &fresh_id("doctor"), output) {
        Err(error) => findings.push(problem("models", &error)),
        Ok(None) => {
            let none = "no model is named, so ground-truth labels answer, and rules ask and write; name models with \
                        --llm and --see";
            findings.push(ok("models", none.to_owned()));
        }
        Ok(Some(calls)) => {
            for model in job.settings.roles.models() {
                output.say(format_args!("asking {model} ..."));
                let sees = job.settings.roles.see == model;
                findings.extend(calls.check(model, sees).into_iter().map(|found| Finding {
                    state: match found.level {
                        Level::Ok => Grade::Ok,
                        Level::Warning => Grade::Warning,
                        Level::Problem => Grade::Problem,
                    },
                    about: model.to_owned(),
                    told: found.what,
                    hint: found.to_do,
                }));
            }
        }
    }
    let report = Report { findings, scenes: examined.unwrap_or_default() };
    output.data(&report, &report);
    let problems = report.findings.iter().any(|finding| finding.state == Grade::Problem);
    Ok(if problems { Exit::BadInput } else { Exit::Done })
}

fn ok(about: &str, told: String) -> Finding {
    Finding { state: Grade::Ok, about: about.to_owned(), told, hint: None }
}

fn problem(about: &str, error: &Error) -> Finding {
    let text = error.to_string();
    let (told, hint) = text.split_once("\nhint: ").unwrap_or((&text, ""));
    let hint = (!hint.is_empty()).then(|| hint.to_owned());
    Finding { state: Grade::Problem, about: about.to_owned(), told: told.to_owned(), hint }
}

/// Opens the platform and takes one view.
fn world_finding(settings: &Settings) -> Finding {
    let about = format!("platform {}", settings.platform);
    let look = || -> Result<Seen, Error> {
        let platform = platforms::open(settings)?;
        let one = Settings { limit: Some(1), ..settings.clone() };
        let items = items(&one, platform.as_ref())?;
        let path = items[0].path(settings, platform.as_ref())?;
        let view = platform.look(&path.scene, &path.frames[0], Gaze::quarter(path.frames[0].pose.heading))?;
        let picture = view.image.is_some();
        let one = Path { frames: vec![path.frames[0].clone()], ..path };
        let labels = Evidence::from_labels(&one, &[vec![view]]).is_some();
        Ok(Seen { scenes: platform.scenes()?.len(), picture, labels })
    };
    match look() {
        Err(error) => problem(&about, &error),
        Ok(seen) => seen.finding(about, settings),
    }
}

/// The number of scenes, and whether the first view has a picture and labels.
struct Seen {
    scenes: usize,
    picture: bool,
    labels: bool,
}

impl Seen {
    fn finding(&self, about: String, settings: &Settings) -> Finding {
        let Self { scenes, picture, labels } = *self;
        let has = match (picture, labels) {
            (true, true) => "a picture and labels",
            (true, false) => "a picture, but no labels",
            (false, true) => "labels, but no picture",
            (false, false) => "neither a picture nor labels",
        };
        let told = format!("{}; its first view has {has}", count(scenes, "scene"));
        let see = &settings.roles.see;
        let hint = if is_model(see) && !picture {
            Some(format!("{see} needs pictures: add them to the data folder, or use --see labels"))
        } else if see == LABELS && !labels {
            Some("name a model that sees: --see provider/model".to_owned())
        } else {
            None
        };
        let state = if hint.is_some() { Grade::Problem } else { Grade::Ok };
        Finding { state, about, told, hint }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, finding) in self.findings.iter().enumerate() {
            let mark = match finding.state {
                Grade::Ok => "ok      ",
                Grade::Warning => "warning ",
                Grade::Problem => "PROBLEM ",
            };
            let end = if at > 0 { "\n" } else { "" };
            write!(f, "{end}{mark} {}: {}", finding.about, finding.told)?;
            if let Some(hint) = &finding.hint {
                write!(f, "\n         hint: {hint}")?;
            }
        }
        Ok(())
    }
}
