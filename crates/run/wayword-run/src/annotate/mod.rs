//! `wayword annotate`: writes language into a copy of a LeRobot dataset.
//!
//! - `cuts`: where an episode has a decision. `phrases`: the words for a part by rules. `questions`: questions about single frames.
//! - `episode`: sees, cuts, writes and checks one episode. `records`: its record. `rows`: the same as rows of LeRobot's columns.
//!
//! The records lie in `meta/wayword` of the copy: a line for each finished episode, from which a stopped command goes on.

mod cuts;
mod episode;
mod phrases;
mod questions;
mod records;
mod rows;

pub use records::{AnnotatedFrame, AnnotatedPart, AnnotatedQuestion, DroppedText, EpisodeAnnotation, EpisodeText};

use crate::{
    annotate_args::AnnotateArgs,
    calls::ModelCalls,
    error::CommandError,
    follow::KnownScenes,
    in_order::{core_count, in_order},
    interrupt,
    lookout::DetectorLookout,
    output::{self, CommandOutput},
    pairs::PairPartState,
    plan::JobModels,
    run_folder::{FolderLock, Journal, fresh_id, lines::each_line, lock_folder},
    settings::RunJob,
    styles::{find_run_styles, measure_style},
    team::RoleTeam,
    written_files::{expect_own_folder, write_file},
};
use episode::{DatasetEpisode, EpisodeAnnotator};
use serde::Serialize;
use serde_json::Value;
use std::{
    collections::BTreeSet,
    fmt, fs,
    path::{Path as FilePath, PathBuf},
    sync::Arc,
};
use wayword_formats::training::{
    lerobot_language::{LanguageCopy, camera_features, expect_no_language, write_language_copy},
    lerobot_texts::read_lerobot_episodes,
};
use wayword_recording::{MAX_OPEN_RECORDINGS, RecordingPlatform};
use wayword_synthesis::style::parse_style;

/// The folder of the records, below the copy.
const KEPT_FOLDER: &str = "meta/wayword";
/// The lines of the episodes.
pub const ANNOTATIONS: &str = "annotations.jsonl";
/// The pictures of the page.
pub const PICTURES: &str = "pictures";
/// What was asked.
const ASKED: &str = "annotate.json";
/// The style of the texts about parts.
const SUBTASK_STYLE: &str = include_str!("subtask.toml");

/// The result of `wayword annotate`, which `--json` prints.
#[derive(Debug, Serialize)]
pub struct AnnotationReport {
    /// The copy with language.
    pub dataset: String,
    /// Episodes with language.
    pub episodes: usize,
    /// The parts of these episodes.
    pub parts: usize,
    /// Parts whose words speak of the motion alone.
    pub by_motion: usize,
    /// Texts about whole episodes.
    pub texts: usize,
    /// Texts that are kept although a claim of them could not be decided.
    pub unverified: usize,
    /// Questions about frames.
    pub questions: usize,
    /// Texts that were not kept.
    pub dropped: usize,
    /// Files that were linked.
    pub linked: usize,
    /// Files that were copied.
    pub copied: usize,
    /// The folder of the records.
    #[serde(skip)]
    pub kept: PathBuf,
}

/// Annotates a dataset, and writes the copy when all its episodes are done.
///
/// # Errors
/// When the dataset cannot be read or has language already, a model does not answer, or the copy cannot be written.
pub fn annotate_dataset(args: &AnnotateArgs, output: &CommandOutput) -> Result<AnnotationReport, CommandError> {
    expect_no_language(&args.dataset)?;
    let camera = chosen_camera(args)?;
    let job = args.asked_settings().into_job()?;
    let styles = find_run_styles(&job.settings)?;
    let subtask = measure_style(parse_style("subtask", SUBTASK_STYLE)?);
    let mut episodes = dataset_episodes(&args.dataset)?;
    episodes.truncate(args.limit.unwrap_or(usize::MAX));
    let hear = Arc::new(output::print_foreign_line);
    let platform = RecordingPlatform::open_dataset_camera(&args.dataset, &camera, hear)?;
    let mut kept = KeptAnnotations::open(&args.out, &asked_of(args, &camera, &job))?;
    let models = JobModels::for_job(&job)?;
    if !models.is_empty() {
        ModelCalls::check_ready(&job, output)?;
    }
    let calls = models.open_calls(&fresh_id("annotate"), output)?;
    let lookout = DetectorLookout::from_settings(&job.settings, calls.as_ref(), &styles)?;
    let team = RoleTeam::new(&job.settings, calls.as_ref(), &platform)?.with_lookout(lookout);
    let annotator = EpisodeAnnotator {
        platform: &platform,
        settings: &job.settings,
        team: &team,
        styles: &styles,
        subtask: &subtask,
        scenes: &KnownScenes::new(),
        keep: args.keep,
        sees: !team.sees_labels(),
        pictures: &kept.folder.join(PICTURES),
        threads: calls.as_ref().map_or(1, |calls| calls.views_at_once(episodes.len())),
    };
    let workers = calls.as_ref().map_or_else(core_count, ModelCalls::worker_count).min(MAX_OPEN_RECORDINGS);
    let annotations = annotate_all(&annotator, &episodes, workers, &mut kept, output)?;
    if let Some(calls) = &calls {
        calls.finish(output)?;
    }
    let languages = annotations.iter().map(|known| (known.episode, rows::language_rows(known, &camera))).collect();
    let copy = write_language_copy(&args.dataset, &args.out, &languages)?;
    Ok(AnnotationReport::new(args, &annotations, &copy, kept.folder.clone()))
}

/// The camera that is asked for, the only one, or that with "front" in its name.
fn chosen_camera(args: &AnnotateArgs) -> Result<String, CommandError> {
    let cameras = camera_features(&args.dataset)?;
    if let Some(named) = &args.camera {
        return Ok(named.clone());
    }
    let front: Vec<&String> = cameras.iter().filter(|name| name.to_lowercase().contains("front")).collect();
    match (cameras.as_slice(), front.as_slice()) {
        ([only], _) => Ok(only.clone()),
        (_, [front]) => Ok((*front).clone()),
        _ => {
            let problem = format!("{}: it has these cameras: {}", args.dataset.display(), cameras.join(", "));
            Err(CommandError::usage(problem, "name the one that looks ahead with --camera"))
        }
    }
}

/// The episodes of a dataset with their tasks.
fn dataset_episodes(dataset: &FilePath) -> Result<Vec<DatasetEpisode>, CommandError> {
    let episode = |episode: wayword_formats::Episode| {
        let number = episode.scene.as_str().rsplit('_').next().and_then(|number| number.parse().ok());
        Some(DatasetEpisode { number: number?, scene: episode.scene, tasks: episode.instructions })
    };
    Ok(read_lerobot_episodes(dataset)?.into_iter().filter_map(episode).collect())
}

/// What was asked, as one line: what another command made is not mixed in.
fn asked_of(args: &AnnotateArgs, camera: &str, job: &RunJob) -> String {
    let settings = &job.settings;
    let asked = serde_json::json!({
        "dataset": args.dataset.display().to_string(),
        "camera": camera,
        "style": settings.style,
        "per_path": settings.per_path,
        "keep": format!("{:?}", args.keep).to_lowercase(),
        "seed": settings.seed,
        "roles": settings.roles,
    });
    asked.to_string() + "\n"
}

fn annotate_all(
    annotator: &EpisodeAnnotator<'_>,
    episodes: &[DatasetEpisode],
    workers: usize,
    kept: &mut KeptAnnotations,
    output: &CommandOutput,
) -> Result<Vec<EpisodeAnnotation>, CommandError> {
    let wanted: BTreeSet<i64> = episodes.iter().map(|episode| episode.number).collect();
    let mut annotations = read_annotations(&kept.folder)?;
    annotations.retain(|known| wanted.contains(&known.episode));
    let done: BTreeSet<i64> = annotations.iter().map(|known| known.episode).collect();
    if !done.is_empty() {
        output.say(format_args!("continuing: {} of {} episodes done and kept", done.len(), episodes.len()));
    }
    let left: Vec<&DatasetEpisode> = episodes.iter().filter(|episode| !done.contains(&episode.number)).collect();
    let bar = output.progress_bar(left.len(), "episodes");
    let make = |episode: &&DatasetEpisode| {
        interrupt::check_interrupt()?;
        annotator.annotate(episode)
    };
    in_order(&left, workers, make, |_, annotation| {
        let annotation = annotation?;
        kept.journal.append(&annotation)?;
        annotations.push(annotation);
        bar.inc(1);
        Ok::<_, CommandError>(true)
    })?;
    bar.finish_and_clear();
    annotations.sort_by_key(|known| known.episode);
    Ok(annotations)
}

/// The finished episodes, in a folder where one command works at a time.
struct KeptAnnotations {
    folder: PathBuf,
    journal: Journal,
    _held: FolderLock,
}

impl KeptAnnotations {
    fn open(out: &FilePath, asked: &str) -> Result<Self, CommandError> {
        let folder = out.join(KEPT_FOLDER);
        let place = folder.join(ASKED);
        if !place.is_file() {
            expect_own_folder(out, |_| false)?;
        }
        let pictures = folder.join(PICTURES);
        fs::create_dir_all(&pictures).map_err(CommandError::io(&pictures, "make the folder"))?;
        let held = lock_folder(&folder)?;
        if place.is_file() {
            let before = fs::read_to_string(&place).map_err(CommandError::io(&place, "read"))?;
            if before != asked {
                let problem = format!("{}: it was begun with other settings: {}", out.display(), before.trim());
                return Err(CommandError::usage(problem, "give the same flags to go on, or another --out"));
            }
        } else {
            write_file(&place, asked)?;
        }
        let key = |line: &Value| line.get("episode").and_then(Value::as_i64).map(|number| number.to_string());
        Ok(Self { journal: Journal::open(&folder.join(ANNOTATIONS), key)?, folder, _held: held })
    }
}

/// The annotations in a folder of records.
///
/// # Errors
/// When they cannot be read.
pub fn read_annotations(kept: &FilePath) -> Result<Vec<EpisodeAnnotation>, CommandError> {
    let mut annotations = Vec::new();
    each_line(&kept.join(ANNOTATIONS), |line| {
        annotations.push(line.parse()?);
        Ok(())
    })?;
    Ok(annotations)
}

impl AnnotationReport {
    fn new(args: &AnnotateArgs, annotations: &[EpisodeAnnotation], copy: &LanguageCopy, kept: PathBuf) -> Self {
        let count = |of: &dyn Fn(&EpisodeAnnotation) -> usize| annotations.iter().map(of).sum::<usize>();
        let is_open = |state: PairPartState| state == PairPartState::Unverified;
        Self {
            dataset: args.out.display().to_string(),
            episodes: annotations.len(),
            parts: count(&|known| known.parts.len()),
            by_motion: count(&|known| known.parts.iter().filter(|part| part.by == "motion").count()),
            texts: count(&|known| known.texts.len()),
            unverified: count(&|known| {
                let parts = known.parts.iter().filter(|part| is_open(part.state)).count();
                parts + known.texts.iter().filter(|text| is_open(text.state)).count()
            }),
            questions: count(&|known| known.questions.len()),
            dropped: count(&|known| known.dropped.len()),
            linked: copy.linked,
            copied: copy.copied,
            kept,
        }
    }
}

impl fmt::Display for AnnotationReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: {} episodes in {} parts ({} told by their motion alone), {} texts about the whole, {} questions; {} texts kept unverified, {} not \
             kept; {} files linked, {} copied",
            self.dataset,
            self.episodes,
            self.parts,
            self.by_motion,
            self.texts,
            self.questions,
            self.unverified,
            self.dropped,
            self.linked,
            self.copied
        )
    }
}
