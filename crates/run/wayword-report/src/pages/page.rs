//! The top of a report: settings, roles and results of the run.

use super::records::{ReportRecords, RolesPlayed, StyleCounts};
use serde::Serialize;
use std::path::Path;
use wayword_run::{
    count::count_phrase,
    platforms::has_hops,
    settings::{EvidenceSources, Perception, RolePlayer, RunSettings, TargetMode},
};
use wayword_synthesis::walk::FrameSelection;

/// The template's values for the top of the report.
#[derive(Debug, Serialize)]
pub(super) struct ReportPageView {
    /// How many paths the run has, of how many if it is not finished.
    paths: String,
    is_unfinished: bool,
    settings: Vec<(&'static str, String)>,
    roles: Vec<RolesView>,
    outcome: Vec<StyleOutcomeView>,
    left_out: usize,
    /// Items that failed, shown or not.
    failed: usize,
    failed_left_out: usize,
    /// Claims that nothing decides.
    claims: usize,
    /// The cost of all answers of models, if there was any.
    usd: Option<String>,
    /// Whether the texts were checked again.
    checked: String,
}

/// Who asked, answered, wrote and checked: each line has a name and its part in the work.
#[derive(Debug, Serialize)]
struct RolesView {
    lines: Vec<(String, String)>,
}

#[derive(Debug, Serialize)]
struct StyleOutcomeView {
    name: String,
    passed: usize,
    unverified: usize,
    rejected: usize,
    wrong: usize,
    ambiguous: usize,
    doubtful: usize,
}

impl ReportPageView {
    pub(super) fn new(records: &ReportRecords<'_>) -> Self {
        let style = |(name, counts): (&String, &StyleCounts)| StyleOutcomeView {
            name: name.clone(),
            passed: counts.passed,
            unverified: counts.unverified,
            rejected: counts.rejected,
            wrong: counts.wrong,
            ambiguous: counts.ambiguous,
            doubtful: counts.doubtful,
        };
        let failed = records.failed.len() + records.failed_left_out;
        let all = StyleCounts::of_all(records.counts.values());
        let (paths, is_unfinished) = describe_progress(records, failed);
        Self {
            paths,
            is_unfinished,
            settings: settings_in_words(&records.settings),
            roles: records.roles.iter().map(role_lines).collect(),
            outcome: records.counts.iter().map(style).collect(),
            left_out: records.left_out,
            failed,
            failed_left_out: records.failed_left_out,
            claims: all.claims,
            usd: (records.usd > 0.0).then(|| format!("${:.2}", records.usd)),
            checked: describe_check(records),
        }
    }
}

/// How many paths the run has, and whether it lacks some.
fn describe_progress(records: &ReportRecords<'_>, failed: usize) -> (String, bool) {
    let done = records.items.len() + records.left_out;
    match records.planned {
        Some(planned) if done + failed < planned => {
            (format!("{done} of {} so far", count_phrase(planned, "path")), true)
        }
        _ if records.unwritten > 0 => (format!("{} so far", count_phrase(done, "path")), true),
        _ => (count_phrase(done, "path"), false),
    }
}

/// Whether the texts were checked again, and against what.
fn describe_check(records: &ReportRecords<'_>) -> String {
    match &records.again.checked_against[..] {
        [] => "verdicts of the run; the texts were not checked again".to_owned(),
        sources => format!("texts checked again against {}", sources.join(", ")),
    }
}

/// Each role's part in the work, in words that distinguish ground truth from perception.
fn role_lines(roles: &RolesPlayed) -> RolesView {
    let answered = match RolePlayer::Labels.is_named(&roles.answerer) {
        true => "answered: ground truth of the platform, not perception",
        false => "answered: perception by a model",
    };
    let checked = match roles.checked_against.as_str() {
        "labels" => "were the evidence for the checks: ground truth of the platform",
        "captions" => "were the evidence for the checks: they share the answerer's mistakes",
        _ => "was the evidence for the checks",
    };
    let wrote = match &roles.finished_for {
        None if RolePlayer::Rules.is_named(&roles.writer) => "wrote: no language model".to_owned(),
        None => "wrote".to_owned(),
        Some(first) => format!("wrote, after every text of {first} had failed its checks"),
    };
    let line = |who: &str, did: &str| (who.to_owned(), did.to_owned());
    RolesView {
        lines: vec![
            line(&roles.asker, "asked"),
            line(&roles.answerer, answered),
            line(&roles.summariser, "summarised"),
            line(&roles.writer, &wrote),
            line(&roles.checked_against, checked),
            line(&format!("Wayword {}", roles.wayword), "ran all of this"),
        ],
    }
}

/// The settings in words, without folders: a page that is passed on should not reveal its maker's machine.
fn settings_in_words(settings: &RunSettings) -> Vec<(&'static str, String)> {
    let file = |path: &Path| path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let (hops, length_m) = (&settings.request.hops, &settings.request.length_m);
    let hops = match has_hops(settings) {
        true => format!(", {} to {} hops", hops.start(), hops.end()),
        false => String::new(),
    };
    let paths = settings.episodes.as_deref().map_or_else(
        || format!("{} random{hops}, {} to {} m", settings.paths, length_m.start(), length_m.end()),
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
        Perception::Structured => "one structured request per view".to_owned(),
        Perception::FollowUp => {
            format!("one structured request per view, then at most {} about what it left open", settings.questions)
        }
        Perception::Single => "one request for a description, no dialogue".to_owned(),
    };
    let target = match settings.target {
        TargetMode::Given => "given to the writer",
        TargetMode::Free => "the writer's choice",
    };
    let EvidenceSources { labels, captions, detector } = settings.evidence;
    let without_labels = match (captions, detector) {
        (true, true) => "captions and the detector",
        (false, true) => "the detector only",
        (_, false) => "captions only",
    };
    let against = if labels {
        format!("labels if there are any, else {}", without_labels.trim_end_matches(" only"))
    } else {
        without_labels.to_owned()
    };
    let calibration = settings.calibration.as_deref().map(|path| ("Calibration of labels", file(path)));
    let mut rows = vec![
        ("Paths", paths),
        ("Styles", settings.style.iter().map(style).collect::<Vec<_>>().join(", ")),
        ("Views", views.to_owned()),
        ("Questions", questions),
        ("Object of the task", target.to_owned()),
        ("Texts are checked against", against),
        ("Repairs", format!("at most {}", settings.repairs)),
        ("Texts written, of which one is kept", settings.candidates.to_string()),
        ("Seed", settings.seed.to_string()),
    ];
    rows.extend(calibration);
    rows.extend(settings.roles.detector.clone().map(|name| ("Detector", name)));
    rows.extend(settings.reject_ambiguous.then(|| ("Ambiguous texts", "rejected".to_owned())));
    if !settings.scan.is_empty() {
        rows.insert(1, ("Scenes", settings.scan.join(", ")));
    }
    if let Some(limit) = settings.limit {
        rows.insert(1, ("Limit", format!("the first {limit}")));
    }
    rows
}
