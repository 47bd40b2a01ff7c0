//! `wayword perceive`: how well captions fit the labels of their views, for each way of asking a model. It can also measure a
//! detector against the labels.

pub mod args;
mod detector;
mod table;
mod views;

use crate::perceive::args::Perceive;
use serde::Serialize;
use std::path::Path;
use table::{Table, WithDetector};
use views::{Labelled, labelled_views};
use wayword_checks::detected::DetectorFigures;
use wayword_core::{Caption, ModelError, Platform};
use wayword_run::{
    calls::Calls,
    error::{Error, Exit},
    in_order::{cores, in_order},
    interrupt,
    looking_for::Lookout,
    losses::Losses,
    output::Output,
    own_format,
    plan::Plan,
    platforms,
    run_folder::fresh_id,
    settings::{Job, Perception, Settings, is_in_process},
    settings_file as config,
    team::Team,
    usable,
};
use wayword_synthesis::{
    detection::{Seeker, seek_in},
    observe::talk_about,
    perception::{Score, score},
};

pub use detector::{OfDetector, measure as measure_detector};
pub use table::Row;

/// The result of the measurement.
#[derive(Debug, Serialize)]
pub struct Measured {
    /// Name of the platform.
    pub platform: String,
    /// Views with labels that were captioned.
    pub views: usize,
    /// Who asked, answered and summarised.
    pub roles: String,
    /// One per way of asking.
    pub rows: Vec<Row>,
    /// The figures of the detector, if one was named.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detector: Option<OfDetector>,
    /// Captions, where they were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    shown: Vec<Shown>,
}

/// All ways of asking, the simplest first.
const WAYS: [Perception; 5] =
    [Perception::Fixed, Perception::Single, Perception::Structured, Perception::FollowUp, Perception::Dialogue];

/// A caption with the objects in it that no label confirms.
#[derive(Debug, Serialize)]
struct Shown {
    scene: String,
    heading_deg: f64,
    perception: Perception,
    caption: String,
    hallucinated: Vec<String>,
}

/// The caption of a view, with its score against the labels.
struct Captioned {
    caption: Caption,
    score: Score,
}

pub fn run(args: &Perceive, output: &Output) -> Result<Exit, Error> {
    let mut asked = args.asked().or(config::read(args.config.as_deref())?);
    // As many random paths as views are enough, because each new path gives at least one view.
    asked.walks.paths = asked.walks.episodes.is_none().then_some(args.views);
    let mut job = asked.job()?;
    Calls::ready(&job, output)?;
    let platform = platforms::open(&job.settings)?;
    job.settings = usable::settled(&job.settings, platform.as_ref(), output)?;
    let ways = args.perception.clone().filter(|asked| !asked.is_empty()).unwrap_or_else(|| ways(&job.settings));
    let measured = perceive(platform.as_ref(), &job, Extent { views: args.views, show: args.show }, &ways, output)?;
    if let (Some(file), Some(detector)) = (&args.figures, &measured.detector) {
        keep(file, &detector.figures)?;
    }
    output.data(&measured, Table(&measured));
    Ok(if measured.rows.iter().all(|row| row.failed == 0) { Exit::Done } else { Exit::WithLoss })
}

/// How much to measure and to show.
#[derive(Debug, Clone, Copy)]
pub struct Extent {
    /// Views that are captioned, at most.
    pub views: usize,
    /// Captions of each way of asking that are shown.
    pub show: usize,
}

/// Captions views in several ways, and checks the captions against the views' labels.
///
/// # Errors
/// When no view has labels, a model cannot be reached, or no more calls are possible.
pub fn perceive(
    platform: &dyn Platform,
    job: &Job,
    extent: Extent,
    ways: &[Perception],
    output: &Output,
) -> Result<Measured, Error> {
    let plan = Plan::looking(job, platform)?;
    let views = labelled_views(&plan, extent.views)?;
    let calls = plan.models.open(&fresh_id("perceive"), output)?;
    let _graceful = interrupt::finish_first(calls.as_ref());
    let mut measured = Measured {
        platform: job.settings.platform.clone(),
        views: views.len(),
        roles: roles(&job.settings),
        rows: Vec::new(),
        detector: None,
        shown: Vec::new(),
    };
    let lookout = Lookout::of(&job.settings, calls.as_ref(), &[])?;
    measured.detector =
        lookout.as_ref().map(|lookout| measure_detector(&plan, extent.views, lookout, output)).transpose()?;
    let mut by_way = Vec::new();
    for &perception in ways {
        let settings = Settings { perception, ..job.settings.clone() };
        let (captions, row) = measure(platform, &settings, calls.as_ref(), &views, output)?;
        measured.rows.push(row);
        let shown = captions.iter().zip(&views).filter_map(|(captioned, view)| {
            let Captioned { caption, score } = captioned.as_ref()?;
            Some(Shown {
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
        let corrected = corrected(&by_way, &views, lookout, output)?;
        for (row, with) in measured.rows.iter_mut().zip(corrected) {
            row.with_detector = Some(with);
        }
    }
    if let Some(calls) = &calls {
        calls.record()?;
        output.say(format_args!("models: {}", calls.spent()));
    }
    Ok(measured)
}

/// The ways of asking that work with the model that sees: one in process cannot be asked for JSON.
fn ways(settings: &Settings) -> Vec<Perception> {
    let in_process = is_in_process(&settings.roles.see);
    WAYS.into_iter().filter(|way| !(in_process && way.is_structured())).collect()
}

fn roles(settings: &Settings) -> String {
    let roles = &settings.roles;
    format!("asked by {}, answered by {}, summarised by {}", roles.ask, roles.see, roles.summarise)
}

/// Captions every view with one way of asking, and counts the calls.
fn measure(
    platform: &dyn Platform,
    settings: &Settings,
    calls: Option<&Calls>,
    views: &[Labelled],
    output: &Output,
) -> Result<(Vec<Option<Captioned>>, Row), Error> {
    let team = Team::new(settings, calls, platform)?;
    let asked = || calls.map_or(0, |calls| calls.spent().answered + calls.spent().from_ledger);
    let before = asked();
    let bar = output.progress(views.len(), "views");
    let mut captions = Vec::new();
    let make = |view: &Labelled| talk_about(&view.view, team.observers());
    let mut losses = Losses::default();
    in_order(views, calls.map_or_else(cores, Calls::workers), make, |view, caption| {
        bar.inc(1);
        if losses.are_enough(caption.as_ref().err().map(ModelError::failure))
            && let Err(error) = caption
        {
            // The model does not answer any more.
            return Err(error.into());
        }
        captions.push(captioned(view, caption, output)?);
        interrupt::check().map(|()| true)
    })?;
    bar.finish_and_clear();
    let row = Row::of(settings.perception, &captions, asked() - before);
    Ok((captions, row))
}

/// Scores the captions again after a detector has struck out the things that it does not find in the views. It takes each view
/// with all ways of asking before the next one, because the detector caches its work on the last pictures.
fn corrected(
    by_way: &[Vec<Option<Captioned>>],
    views: &[Labelled],
    lookout: &Lookout,
    output: &Output,
) -> Result<Vec<WithDetector>, Error> {
    let seeker = Seeker { nouns: &[], ..lookout.seeker() };
    let mut scores = vec![Vec::new(); by_way.len()];
    let bar = output.progress(views.len(), "views");
    for (at, view) in views.iter().enumerate() {
        for (captions, scores) in by_way.iter().zip(&mut scores) {
            let Some(Captioned { caption, .. }) = captions.get(at).and_then(Option::as_ref) else { continue };
            let seen = seek_in(&view.view, caption.clone(), seeker)?;
            scores.push(score(&seen.text, &view.labels));
        }
        bar.inc(1);
        interrupt::check()?;
    }
    bar.finish_and_clear();
    let with = |(captions, after): (&Vec<Option<Captioned>>, &Vec<Score>)| {
        WithDetector::of(captions.iter().flatten().map(|captioned| &captioned.score), after)
    };
    Ok(by_way.iter().zip(&scores).map(with).collect())
}

/// Writes the figures of a detector to the file of `--figures`.
fn keep(file: &Path, figures: &DetectorFigures) -> Result<(), Error> {
    let text = toml::to_string(figures).map_err(|error| Error::usage(error.to_string(), "report this as a defect"))?;
    std::fs::write(file, own_format::headed::<DetectorFigures>(&text)).map_err(Error::io(file, "write"))
}

/// Scores a caption against the labels of its view; `None`, with a message, if the model failed on this view.
///
/// # Errors
/// When no more calls are possible.
fn captioned(
    view: &Labelled,
    caption: Result<Caption, ModelError>,
    output: &Output,
) -> Result<Option<Captioned>, Error> {
    match caption {
        Ok(caption) => Ok(Some(Captioned { score: score(&caption.text, &view.labels), caption })),
        Err(error) if error.ends_run() => Err(error.into()),
        Err(error) => {
            output.say(format_args!("{}: {error}", view.scene));
            Ok(None)
        }
    }
}
