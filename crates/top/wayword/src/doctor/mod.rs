//! `wayword doctor`: tries out platform, models, keys and prompts, and reports for each whether it works, with a hint if it does
//! not.

pub(crate) mod args;
mod scenes;
mod turning;

use crate::doctor::args::DoctorArgs;
use serde::Serialize;
use std::fmt;
use wayword_checks::Evidence;
use wayword_core::{Path, Platform, SceneCondition, SceneId, ViewGaze};
use wayword_remote::CheckLevel;
use wayword_run::{
    calls::ModelCalls,
    count::count_phrase,
    error::{CommandError, Exit},
    item::run_items,
    output::CommandOutput,
    platforms,
    run_folder::fresh_id,
    settings::{RolePlayer, RunSettings},
    settings_file,
    team::settings_prompts,
};

/// Most recordings of a folder that are opened.
const MAX_OPENED_RECORDINGS: usize = 50;

/// The severity of a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum DoctorGrade {
    /// It works.
    Ok,
    /// It works, but something is missing or unusual.
    Warning,
    /// It does not work. The exit code is then 1.
    Problem,
}

/// The result of one check.
#[derive(Debug, Serialize)]
struct DoctorFinding {
    state: DoctorGrade,
    /// The thing that was checked: a model, a scene, the platform.
    about: String,
    /// The result in words.
    told: String,
    /// How to fix the problem.
    #[serde(skip_serializing_if = "Option::is_none")]
    hint: Option<String>,
}

/// The results of all checks.
#[derive(Debug, Serialize)]
struct DoctorReport {
    /// The findings, in the order of the checks.
    findings: Vec<DoctorFinding>,
    /// The scenes of the data, if they were to be examined.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    scenes: Vec<SceneCondition>,
}

/// Runs `wayword doctor`. A failed check becomes a finding, and the other checks go on.
pub(crate) fn run_doctor(args: &DoctorArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    let mut job = args.to_asked().or_file(settings_file::read_settings(args.config.as_deref())?).into_job()?;
    let mut findings = Vec::new();
    let mut examined = Ok(Vec::new());
    if args.scenes {
        examined = scenes::examine_run_scenes(&mut job.settings, output);
        findings.extend(scenes::scene_findings(&examined));
    }
    findings.extend(world_findings(&job.settings));
    findings.extend(platforms::one_way_edges(&job.settings).map(|told| DoctorFinding {
        state: DoctorGrade::Warning,
        about: "viewpoint graphs".to_owned(),
        told,
        hint: Some("edges are walked in both directions; if one cannot be, take it out of the file".to_owned()),
    }));
    if job.settings.roles.prompts.is_some() {
        findings.push(match settings_prompts(&job.settings) {
            Ok(prompts) => {
                ok_finding("prompts", format!("every template can be filled; their hash is {}", prompts.hash()))
            }
            Err(error) => problem_finding("prompts", &error),
        });
    }
    match ModelCalls::open(&job, &fresh_id("doctor"), output) {
        Err(error) => findings.push(problem_finding("models", &error)),
        Ok(None) => {
            let none = "no model is named, so ground-truth labels answer, and rules ask and write; name models with \
                        --llm and --see";
            findings.push(ok_finding("models", none.to_owned()));
        }
        Ok(Some(calls)) => {
            for model in job.settings.roles.model_names() {
                output.say(format_args!("asking {model} (if no answer comes, it is asked again a few times) ..."));
                let sees = job.settings.roles.see.is_named(model);
                findings.extend(calls.check_model(model, sees).into_iter().map(|found| DoctorFinding {
                    state: match found.level {
                        CheckLevel::Ok => DoctorGrade::Ok,
                        CheckLevel::Warning => DoctorGrade::Warning,
                        CheckLevel::Problem => DoctorGrade::Problem,
                    },
                    about: model.to_owned(),
                    told: found.what,
                    hint: found.to_do,
                }));
            }
        }
    }
    let report = DoctorReport { findings, scenes: examined.unwrap_or_default() };
    output.print_result(&report, &report);
    let problems = report.findings.iter().any(|finding| finding.state == DoctorGrade::Problem);
    Ok(if problems { Exit::BadInput } else { Exit::Done })
}

fn ok_finding(about: &str, told: String) -> DoctorFinding {
    DoctorFinding { state: DoctorGrade::Ok, about: about.to_owned(), told, hint: None }
}

fn problem_finding(about: &str, error: &CommandError) -> DoctorFinding {
    let text = error.to_string();
    let (told, hint) = text.split_once("\nhint: ").unwrap_or((&text, ""));
    let hint = (!hint.is_empty()).then(|| hint.to_owned());
    DoctorFinding { state: DoctorGrade::Problem, about: about.to_owned(), told: told.to_owned(), hint }
}

/// Opens the platform and takes one view. In a world of another program, turns around there too.
fn world_findings(settings: &RunSettings) -> Vec<DoctorFinding> {
    let about = format!("platform {}", settings.platform);
    let look = || -> Result<(PlatformExamination, Vec<DoctorFinding>), CommandError> {
        let platform = platforms::open_platform(settings)?;
        let first_only = RunSettings { limit: Some(1), ..settings.clone() };
        let items = run_items(&first_only, platform.as_ref())?;
        let path = items[0].find_path(settings, platform.as_ref())?;
        let frame = &path.frames[0];
        let view = platform.look_from(&path.scene, frame, ViewGaze::quarter_view(frame.pose.heading))?;
        let more = match settings.platform.as_str() {
            "process" => turning::turning_finding(platform.as_ref(), &path.scene, frame)?.into_iter().collect(),
            "recording" => unreadable_recordings(platform.as_ref())?,
            _ => Vec::new(),
        };
        let picture = view.image.is_some();
        let first_stop = Path { frames: vec![frame.clone()], ..path.clone() };
        let labels = Evidence::from_labels(&first_stop, &[vec![view]]).is_some();
        Ok((PlatformExamination { scenes: platform.list_scenes()?.len(), picture, labels }, more))
    };
    match look() {
        Err(error) => vec![problem_finding(&about, &error)],
        Ok((seen, more)) => std::iter::once(seen.to_finding(about, settings)).chain(more).collect(),
    }
}

/// A problem for each recording of a folder that cannot be opened. The first ones are opened; of each that can, the platform says what it
/// holds.
fn unreadable_recordings(platform: &dyn Platform) -> Result<Vec<DoctorFinding>, CommandError> {
    let scenes = platform.list_scenes()?;
    let problem = |scene: &SceneId| {
        let error = platform.graph_for_scene(scene).err()?;
        Some(problem_finding(&format!("recording {scene}"), &error.into()))
    };
    Ok(scenes.iter().take(MAX_OPENED_RECORDINGS).filter_map(problem).collect())
}

/// The result of trying out a platform: the number of scenes, and whether the first view has a picture and labels.
struct PlatformExamination {
    scenes: usize,
    picture: bool,
    labels: bool,
}

impl PlatformExamination {
    fn to_finding(&self, about: String, settings: &RunSettings) -> DoctorFinding {
        let Self { scenes, picture, labels } = *self;
        let has = match (picture, labels) {
            (true, true) => "a picture and labels",
            (true, false) => "a picture, but no labels",
            (false, true) => "labels, but no picture",
            (false, false) => "neither a picture nor labels",
        };
        let told = format!("{}; its first view has {has}", count_phrase(scenes, "scene"));
        let see = &settings.roles.see;
        let hint = match see {
            RolePlayer::Model(name) if !picture => {
                Some(format!("{name} needs pictures: add them to the data folder, or use --see labels"))
            }
            RolePlayer::Labels if !labels => {
                Some("it is read, but without labels a model has to see: name one with --see provider/model".to_owned())
            }
            _ => None,
        };
        let state = if hint.is_some() { DoctorGrade::Problem } else { DoctorGrade::Ok };
        DoctorFinding { state, about, told, hint }
    }
}

impl fmt::Display for DoctorReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, finding) in self.findings.iter().enumerate() {
            let mark = match finding.state {
                DoctorGrade::Ok => "ok      ",
                DoctorGrade::Warning => "warning ",
                DoctorGrade::Problem => "PROBLEM ",
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
