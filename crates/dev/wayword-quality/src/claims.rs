//! Measures how often the checks refuse true claims about a path and catch false ones.
//!
//! The claims are checked twice: against the platform's labels, and against captions. The captions come from a scripted model that
//! hallucinates some objects and doubts others, so the truth about each claim is known.

mod seeded;

use crate::stage::{MeasuredWorldArgs, MeasurementStage};
use rayon::prelude::*;
use seeded::{ClaimedPath, SeededClaim, SeededClaimKind};
use std::{collections::BTreeMap, path::PathBuf};
use wayword_checks::{CheckSubject, Evidence, check_text};
use wayword_core::{CheckKind, FrameObservation, InstructionStyle, Verdict, seeded_rng};
use wayword_run::{
    error::CommandError,
    output::CommandOutput,
    pipeline::{item_path, path_panoramas},
    plan::RunPlan,
    platforms::RememberingPlatform,
    run_folder::fresh_id,
    settings::RunJob,
    team::RoleTeam,
};
use wayword_synthesis::{observe::observe_path, walk::ObservedWalk};

/// The flags of `claims`.
#[derive(Debug, clap::Args)]
pub struct ClaimsArgs {
    /// The platform.
    #[command(flatten)]
    world: MeasuredWorldArgs,
    /// Take the paths of a dataset instead of random ones.
    #[arg(long)]
    episodes: Option<PathBuf>,
    /// Paths that claims are made about.
    #[arg(long, default_value_t = 60)]
    paths: usize,
    /// Claims of each kind about each path, at most.
    #[arg(long, default_value_t = 4)]
    claims: usize,
    /// Share of the objects named by the eye that are not there.
    #[arg(long, default_value_t = 0.15)]
    hallucinated: f64,
    /// How many wrong verdicts of each kind to show.
    #[arg(long, default_value_t = 0)]
    show: usize,
}

/// How many claims of a kind there were, how many failed, and how many could not be checked.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct SeededClaimCount {
    all: usize,
    failed: usize,
    unverified: usize,
}

/// Counts by the source of the evidence (`labels` or `captions`) and the kind of claim.
type SeededClaimCounts = BTreeMap<(&'static str, SeededClaimKind), SeededClaimCount>;

/// Checks true and false claims about paths, and prints how many the checks refuse and catch, by labels and by captions.
///
/// # Errors
/// When the platform cannot be opened, a view cannot be had, or no more calls are possible.
pub fn measure_claims(flags: &ClaimsArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let stage = MeasurementStage::new(&flags.world, flags.hallucinated)?;
    let job = claims_job(&stage, flags)?;
    let plan = RunPlan::for_looking(&job, &stage.world)?;
    let calls = plan.models.open_calls(&fresh_id("claims"), output)?;
    let team = RoleTeam::new(&job.settings, calls.as_ref(), &stage.world)?;
    let known: Vec<ClaimedPath> = plan
        .items
        .par_iter()
        .filter_map(|item| {
            let world = RememberingPlatform::new(&stage.world);
            let path = item_path(item, &job.settings, &world).ok()?;
            Some(
                observe_path(&world, &path, job.settings.frames, team.observers())
                    .map_err(CommandError::from)
                    .and_then(|seen| {
                        let panoramas = path_panoramas(&world, &path)?;
                        Ok((ObservedWalk::new(path, seen), panoramas))
                    }),
            )
        })
        .filter_map(|made| match made {
            Ok((walk, panoramas)) => {
                let labels = Evidence::from_labels(&walk.path, &panoramas)?;
                let captions = walk.evidence()?;
                Some(Ok(ClaimedPath { walk, labels, captions }))
            }
            Err(error) => Some(Err(error)),
        })
        .collect::<Result<_, _>>()?;
    let (counts, wrong) = count_verdicts(&known, flags);
    for line in wrong {
        output.say(line);
    }
    output.print_result(&(), describe_counts(&known, &counts, flags));
    Ok(())
}

/// A job in which only the eye is a model.
fn claims_job(stage: &MeasurementStage, flags: &ClaimsArgs) -> Result<RunJob, CommandError> {
    let mut job = stage.looking_job(flags.paths)?;
    if flags.episodes.is_some() {
        job.settings.episodes.clone_from(&flags.episodes);
        job.settings.paths = 0;
        job.settings.limit = Some(flags.paths);
    }
    Ok(job)
}

/// Checks claims of every kind about each path. Also returns a line for each wrong verdict that is shown.
fn count_verdicts(known: &[ClaimedPath], flags: &ClaimsArgs) -> (SeededClaimCounts, Vec<String>) {
    let names = seeded::ClaimNamePool::from_paths(known);
    let style = InstructionStyle { name: "claims".to_owned(), ..InstructionStyle::default() };
    let mut counts = SeededClaimCounts::new();
    let mut shown: BTreeMap<(&str, SeededClaimKind), usize> = BTreeMap::new();
    let mut wrong = Vec::new();
    for path in known {
        let mut rng = seeded_rng(flags.world.seed, &["claims", &path.walk.path.id]);
        for SeededClaim { kind, text } in seeded::make_claims(path, &names, flags.claims, &mut rng) {
            for (source, evidence) in [("labels", &path.labels), ("captions", &path.captions)] {
                let checked = check_text(&text, CheckSubject::closed_world(evidence, &style, None));
                let places = |check| matches!(check, CheckKind::Landmarks | CheckKind::Order | CheckKind::Turns);
                let verdicts = checked.findings.iter().filter(|finding| places(finding.check));
                let verdict = verdicts.map(|finding| finding.verdict).max().unwrap_or(Verdict::Unverified);
                let count = counts.entry((source, kind)).or_default();
                count.all += 1;
                count.failed += usize::from(verdict == Verdict::Fail);
                count.unverified += usize::from(verdict == Verdict::Unverified);
                let is_wrong = if kind.is_true() { verdict == Verdict::Fail } else { verdict == Verdict::Pass };
                let shown = shown.entry((source, kind)).or_default();
                if is_wrong && *shown < flags.show {
                    *shown += 1;
                    let why =
                        checked.findings.iter().find(|finding| finding.verdict == verdict && places(finding.check));
                    let why = why.map_or("", |finding| finding.reason.as_str());
                    wrong.push(format!(
                        "{source}, {}: {verdict:?}: {text} ({why}) [{}]",
                        kind.name(),
                        path.walk.path.id
                    ));
                }
            }
        }
    }
    (counts, wrong)
}

/// The lines of the table that is printed.
fn describe_counts(known: &[ClaimedPath], counts: &SeededClaimCounts, flags: &ClaimsArgs) -> String {
    let views: usize =
        known.iter().map(|path| path.walk.observations.iter().map(|seen| seen.looks.len()).sum::<usize>()).sum();
    let transcripts =
        |seen: &FrameObservation| seen.looks.iter().map(|look| look.caption.transcript.len()).sum::<usize>();
    let calls: usize = known.iter().flat_map(|path| &path.walk.observations).map(transcripts).sum();
    let mut lines = vec![
        format!(
            "{} paths, {views} views, {:.2} requests a view; a scripted eye with {:.0} % hallucinated objects and doubts",
            known.len(),
            calls as f64 / views.max(1) as f64,
            100.0 * flags.hallucinated
        ),
        "held against  claims                      number  passed  unverified  failed".to_owned(),
    ];
    for ((source, kind), SeededClaimCount { all, failed, unverified }) in counts {
        let share = |part: usize| 100.0 * part as f64 / (*all).max(1) as f64;
        lines.push(format!(
            "{source:<12}  {:<26}  {all:>6}  {:>5.1}%  {:>9.1}%  {:>5.1}%",
            kind.name(),
            share(all - failed - unverified),
            share(*unverified),
            share(*failed)
        ));
    }
    lines.push(
        "A true claim is refused where it fails; a false one is caught where it fails or is unverified.".to_owned(),
    );
    lines.join("\n")
}
