//! What stands above the items: what the run was, who did it, and what came of it.

use super::records::{Counts, Minds, Records};
use crate::settings::{Against, Perception, Settings, TargetMode};
use serde::Serialize;
use std::path::Path;
use wayword_synthesis::walk::FrameSelection;

/// The page around its items.
#[derive(Debug, Serialize)]
pub(super) struct PageView {
    settings: Vec<(&'static str, String)>,
    minds: Vec<MindsView>,
    outcome: Vec<StyleView>,
    left_out: usize,
    /// Items that failed, shown or not.
    failed: usize,
    failed_left_out: usize,
}

/// Who perceived, wrote and checked: lines of a name and what it did.
#[derive(Debug, Serialize)]
struct MindsView {
    lines: Vec<(String, String)>,
}

#[derive(Debug, Serialize)]
struct StyleView {
    name: String,
    passed: usize,
    unverified: usize,
    rejected: usize,
}

impl PageView {
    pub(super) fn new(records: &Records) -> Self {
        let style = |(name, counts): (&String, &Counts)| StyleView {
            name: name.clone(),
            passed: counts.passed,
            unverified: counts.unverified,
            rejected: counts.rejected,
        };
        Self {
            settings: settings(&records.settings),
            minds: records.minds.iter().map(minds).collect(),
            outcome: records.counts.iter().map(style).collect(),
            left_out: records.left_out,
            failed: records.failed.len() + records.failed_left_out,
            failed_left_out: records.failed_left_out,
        }
    }
}

/// Who did what, said so that nobody takes ground truth for perception.
fn minds(minds: &Minds) -> MindsView {
    let answered = match minds.answerer.as_str() {
        "labels" => "answered: ground truth of the platform, not perception",
        _ => "answered: perception by a model",
    };
    let checked = match minds.checked_against.as_str() {
        "labels" => "is what the checks went by: ground truth of the platform",
        "captions" => "are what the checks went by: they share the answerer's mistakes",
        _ => "is what the checks went by",
    };
    let wrote = match (minds.writer.as_str(), &minds.finished_for) {
        ("rules", None) => "wrote: no language model".to_owned(),
        (_, Some(first)) => format!("wrote where every text of {first} had failed its checks"),
        (_, None) => "wrote".to_owned(),
    };
    let line = |who: &str, did: &str| (who.to_owned(), did.to_owned());
    MindsView {
        lines: vec![
            line(&minds.asker, "asked"),
            line(&minds.answerer, answered),
            line(&minds.summariser, "summed up"),
            line(&minds.writer, &wrote),
            line(&minds.checked_against, checked),
            line(&format!("Wayword {}", minds.wayword), "put it together"),
        ],
    }
}

/// The settings as a reader wants them; no folders, for a page that is passed on should not tell of its maker's machine.
fn settings(settings: &Settings) -> Vec<(&'static str, String)> {
    let file = |path: &Path| path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let (hops, length_m) = (&settings.request.hops, &settings.request.length_m);
    let paths = settings.episodes.as_deref().map_or_else(
        || {
            format!(
                "{} random, {} to {} hops, {} to {} m",
                settings.paths,
                hops.start(),
                hops.end(),
                length_m.start(),
                length_m.end()
            )
        },
        |episodes| format!("of {}", file(episodes)),
    );
    let style = |style: &String| match style.split_once('=') {
        Some((name, dataset)) => format!("{name} (texts of {})", file(Path::new(dataset))),
        None => file(Path::new(style)),
    };
    let views = match settings.frames {
        FrameSelection::Central => "central: the view along the heading",
        FrameSelection::Panoramic => "panoramic: four views, condensed",
    };
    let questions = match settings.perception {
        Perception::Dialogue => format!("dialogue, at most {} per view", settings.questions),
        Perception::Fixed => "fixed object and room queries, no dialogue".to_owned(),
        Perception::Single => "one request for a description, no dialogue".to_owned(),
    };
    let target = match settings.target {
        TargetMode::Given => "given to the writer",
        TargetMode::Free => "the writer's choice",
    };
    let against = match settings.evidence {
        Against::Labels => "labels where there are any, else captions",
        Against::Captions => "captions alone",
    };
    let mut told = vec![
        ("Paths", paths),
        ("Styles", settings.style.iter().map(style).collect::<Vec<_>>().join(", ")),
        ("Views", views.to_owned()),
        ("Questions", questions),
        ("Object of the task", target.to_owned()),
        ("Texts are held against", against.to_owned()),
        ("Repairs", format!("at most {}", settings.repairs)),
        ("Seed", settings.seed.to_string()),
    ];
    if !settings.scan.is_empty() {
        told.insert(1, ("Scenes", settings.scan.join(", ")));
    }
    if let Some(limit) = settings.limit {
        told.insert(1, ("Limit", format!("the first {limit}")));
    }
    told
}
