//! `wayword perceive`: how well captions fit the labels of their views, for each way of asking a model. It can also measure a
//! detector against the labels.

pub mod args;
mod detector;
mod table;
mod views;

use crate::perceive::args::PerceiveArgs;
use serde::Serialize;
use std::path::Path;
use table::{DetectorCorrectedFigures, PerceptionTable};
use views::{LabelledView, labelled_views};
use wayword_checks::detection::DetectorFigures;
use wayword_core::{Caption, ModelError, Platform};
use wayword_run::{
    calls::ModelCalls,
    error::{CommandError, Exit},
    in_order::{core_count, in_order},
    interrupt,
    lookout::DetectorLookout,
    losses::LossCounter,
    output::CommandOutput,
    own_format,
    plan::RunPlan,
    platforms,
    run_folder::fresh_id,
    scene_selection,
    settings::{Perception, RolePlayer, RunJob, RunSettings},
    settings_file,
    team::RoleTeam,
    written_files::{find_output_place, write_file},
};
use wayword_synthesis::{
    detection::{CaptionDetector, seek_in_view},
    observe::caption_view,
    perception::{CaptionScore, score_caption},
};

pub use detector::{DetectorMeasurement, measure_detector};
pub use table::PerceptionRow;

/// The result of the measurement.
#[derive(Debug, Serialize)]
pub struct PerceptionMeasurement {
    /// Name of the platform.
    pub platform: String,
    /// Views with labels that were captioned.
    pub views: usize,
    /// Who asked, answered and summarised.
    pub roles: String,
    /// Whether labels answered, and no model.
    #[serde(skip)]
    labels_answered: bool,
    /// One per way of asking.
    pub rows: Vec<PerceptionRow>,
    /// The figures of the detector, if one was named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detector: Option<DetectorMeasurement>,
    /// Captions, where they were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    shown: Vec<ShownCaption>,
}

/// All ways of asking, the simplest first.
const ALL_PERCEPTIONS: [Perception; 5] =
    [Perception::Fixed, Perception::Single, Perception::Structured, Perception::FollowUp, Perception::Dialogue];

/// A caption with the objects in it that no label confirms.
#[derive(Debug, Serialize)]
struct ShownCaption {
    scene: String,
    heading_deg: f64,
    perception: Perception,
    caption: String,
    hallucinated: Vec<String>,
}

/// The caption of a view, with its score against the labels.
struct ScoredCaption {
    caption: Caption,
    score: CaptionScore,
}

/// Runs `wayword perceive`: has a model caption views, and prints the scores against labels.
///
/// # Errors
/// When the settings are wrong, the platform cannot be opened, a file cannot be written, and as [`measure_perception`].
pub fn run_perceive(args: &PerceiveArgs, output: &CommandOutput) -> Result<Exit, CommandError> {
    if args.views == 0 {
        return Err(CommandError::usage(
            "--views 0 asks for no view",
            "give at least 1, or leave the flag out for 100",
        ));
    }
    let place = args.figures.as_deref().map(find_output_place).transpose()?;
    let output = &place.map_or_else(|| output.clone(), |place| output.beside_data(&place));
    let mut asked = args.asked_settings().or_file(settings_file::read_settings(args.config.as_deref())?);
    // As many random paths as views are enough, because each new path gives at least one view.
    asked.walks.paths = asked.walks.episodes.is_none().then_some(args.views);
    let mut job = asked.into_job()?;
    ModelCalls::check_ready(&job, output)?;
    let platform = platforms::open_platform(&job.settings)?;
    job.settings = scene_selection::settle_left_out(&job.settings, platform.as_ref(), output)?;
    let ways =
        args.perception.clone().filter(|asked| !asked.is_empty()).unwrap_or_else(|| askable_perceptions(&job.settings));
    let measured = measure_perception(
        platform.as_ref(),
        &job,
        MeasurementExtent { views: args.views, show: args.show },
        &ways,
        output,
    )?;
    if let (Some(file), Some(detector)) = (&args.figures, &measured.detector) {
        write_detector_figures(file, &detector.figures)?;
    }
    output.print_result(&measured, PerceptionTable(&measured));
    Ok(if measured.rows.iter().all(|row| row.failed == 0) { Exit::Done } else { Exit::WithLoss })
}

/// How much to measure and to show.
#[derive(Debug, Clone, Copy)]
pub struct MeasurementExtent {
    /// Views that are captioned, at most.
    pub views: usize,
    /// Captions of each way of asking that are shown.
    pub show: usize,
}

/// Captions views in several ways, and checks the captions against the views' labels.
///
/// # Errors
/// When no view has labels, a model cannot be reached, or no more calls are possible.
pub fn measure_perception(
    platform: &dyn Platform,
    job: &RunJob,
    extent: MeasurementExtent,
    ways: &[Perception],
    output: &CommandOutput,
) -> Result<PerceptionMeasurement, CommandError> {
    let plan = RunPlan::for_looking(job, platform)?;
    let views = labelled_views(&plan, extent.views)?;
    let calls = plan.models.open_calls(&fresh_id("perceive"), output)?;
    let _interrupt_guard = interrupt::finish_items_first(calls.as_ref());
    let mut measured = PerceptionMeasurement {
        platform: job.settings.platform.clone(),
        views: views.len(),
        roles: describe_roles(&job.settings),
        labels_answered: job.settings.roles.see == RolePlayer::Labels,
        rows: Vec::new(),
        detector: None,
        shown: Vec::new(),
    };
    let lookout = DetectorLookout::from_settings(&job.settings, calls.as_ref(), &[])?;
    measured.detector =
        lookout.as_ref().map(|lookout| measure_detector(&plan, extent.views, lookout, output)).transpose()?;
    let mut by_way = Vec::new();
    for &perception in ways {
        let settings = RunSettings { perception, ..job.settings.clone() };
        let (captions, row) = caption_views(platform, &settings, calls.as_ref(), &views, output)?;
        measured.rows.push(row);
        let shown = captions.iter().zip(&views).filter_map(|(captioned, view)| {
            let ScoredCaption { caption, score } = captioned.as_ref()?;
            Some(ShownCaption {
                scene: view.scene.to_string(),
                heading_deg: view.view.pose.heading.rad().to_degrees().round(),
                perception,
                caption: caption.text.clone(),
                hallucinated: score.hallucinated.clone(),
            })
        });
        measured.shown.extend(shown.take(extent.show));
        by_way.push(captions);
    }
    if let Some(lookout) = &lookout {
        let corrected = correct_captions(&by_way, &views, lookout, output)?;
        for (row, figures) in measured.rows.iter_mut().zip(corrected) {
            row.with_detector = Some(figures);
        }
    }
    if let Some(calls) = &calls {
        calls.finish(output)?;
        output.say(format_args!("models: {}", calls.spent_so_far()));
    }
    Ok(measured)
}

/// The ways of asking that work with the model that sees: one in process cannot be asked for JSON.
fn askable_perceptions(settings: &RunSettings) -> Vec<Perception> {
    let in_process = settings.roles.see.is_in_process();
    ALL_PERCEPTIONS.into_iter().filter(|way| !(in_process && way.is_structured())).collect()
}

fn describe_roles(settings: &RunSettings) -> String {
    let roles = &settings.roles;
    format!("asked by {}, answered by {}, summarised by {}", roles.ask, roles.see, roles.summarise)
}

/// Captions every view with one way of asking, and counts the calls.
fn caption_views(
    platform: &dyn Platform,
    settings: &RunSettings,
    calls: Option<&ModelCalls>,
    views: &[LabelledView],
    output: &CommandOutput,
) -> Result<(Vec<Option<ScoredCaption>>, PerceptionRow), CommandError> {
    let team = RoleTeam::new(settings, calls, platform)?;
    let calls_so_far = || calls.map_or(0, |calls| calls.spent_so_far().answered + calls.spent_so_far().from_ledger);
    let calls_before = calls_so_far();
    let bar = output.progress_bar(views.len(), "views");
    let mut captions = Vec::new();
    let make = |view: &LabelledView| caption_view(&view.view, team.observers());
    let mut losses = LossCounter::default();
    in_order(views, calls.map_or_else(core_count, ModelCalls::worker_count), make, |view, caption| {
        bar.inc(1);
        if losses.ends_command(caption.as_ref().err().map(ModelError::failure_kind))
            && let Err(error) = caption
        {
            // The model does not answer any more.
            return Err(error.into());
        }
        captions.push(score_answer(view, caption, output)?);
        interrupt::check_interrupt().map(|()| true)
    })?;
    bar.finish_and_clear();
    let row = PerceptionRow::from_captions(settings.perception, &captions, calls_so_far() - calls_before);
    Ok((captions, row))
}

/// Scores the captions again after a detector has struck out the things that it does not find in the views. It takes each view
/// with all ways of asking before the next one, because the detector caches its work on the last pictures.
fn correct_captions(
    by_way: &[Vec<Option<ScoredCaption>>],
    views: &[LabelledView],
    lookout: &DetectorLookout,
    output: &CommandOutput,
) -> Result<Vec<DetectorCorrectedFigures>, CommandError> {
    let seeker = CaptionDetector { nouns: &[], ..lookout.to_seeker() };
    let mut scores = vec![Vec::new(); by_way.len()];
    let bar = output.progress_bar(views.len(), "views");
    for (at, view) in views.iter().enumerate() {
        for (captions, scores) in by_way.iter().zip(&mut scores) {
            let Some(ScoredCaption { caption, .. }) = captions.get(at).and_then(Option::as_ref) else { continue };
            let corrected = seek_in_view(&view.view, caption.clone(), seeker)?;
            scores.push(score_caption(&corrected.text, &view.labels));
        }
        bar.inc(1);
        interrupt::check_interrupt()?;
    }
    bar.finish_and_clear();
    let corrected_figures = |(captions, after): (&Vec<Option<ScoredCaption>>, &Vec<CaptionScore>)| {
        DetectorCorrectedFigures::from_scores(captions.iter().flatten().map(|captioned| &captioned.score), after)
    };
    Ok(by_way.iter().zip(&scores).map(corrected_figures).collect())
}

/// Writes the figures of a detector to the file of `--figures`.
fn write_detector_figures(file: &Path, figures: &DetectorFigures) -> Result<(), CommandError> {
    let text =
        toml::to_string(figures).map_err(|error| CommandError::usage(error.to_string(), "report this as a defect"))?;
    write_file(file, own_format::with_header::<DetectorFigures>(&text))
}

/// Scores a caption against the labels of its view; `None`, with a message, if the model failed on this view.
///
/// # Errors
/// When no more calls are possible.
fn score_answer(
    view: &LabelledView,
    caption: Result<Caption, ModelError>,
    output: &CommandOutput,
) -> Result<Option<ScoredCaption>, CommandError> {
    match caption {
        Ok(caption) => Ok(Some(ScoredCaption { score: score_caption(&caption.text, &view.labels), caption })),
        Err(error) if error.ends_run() => Err(error.into()),
        Err(error) => {
            output.say(format_args!("{}: {error}", view.scene));
            Ok(None)
        }
    }
}
