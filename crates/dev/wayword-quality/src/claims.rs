//! Measures how often the checks refuse true claims about a path and catch false ones.
//!
//! The claims are checked twice: against the platform's labels, and against captions. The captions come from a scripted model that
//! hallucinates some objects and doubts others, so the truth about each claim is known.

mod made;

use crate::stage::{Stage, World};
use made::{Claim, Kind, Known};
use rayon::prelude::*;
use std::{collections::BTreeMap, path::PathBuf};
use wayword_checks::{Evidence, Subject, check};
use wayword_core::{Check, Observation, Style, Verdict, rng};
use wayword_run::{
    error::Error,
    output::Output,
    pipeline::{panoramas, path},
    plan::Plan,
    platforms::Remembering,
    run_folder::fresh_id,
    settings::{Job, LABELS, Perception, RULES, Settings, Sources},
    team::Team,
};
use wayword_synthesis::{observe::observe, walk::Walk};

/// The flags of `claims`.
#[derive(Debug, clap::Args)]
pub struct Flags {
    /// The platform.
    #[command(flatten)]
    world: World,
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
struct Count {
    all: usize,
    failed: usize,
    unverified: usize,
}

/// Counts by the source of the evidence (`labels` or `captions`) and the kind of claim.
type Counts = BTreeMap<(&'static str, Kind), Count>;

pub fn measure(flags: &Flags, output: &Output) -> Result<(), Error> {
    let stage = Stage::new(&flags.world, flags.hallucinated)?;
    let job = job(&stage, flags)?;
    let plan = Plan::looking(&job, &stage.world)?;
    let calls = plan.models.open(&fresh_id("claims"), output)?;
    let team = Team::new(&job.settings, calls.as_ref(), &stage.world)?;
    let known: Vec<Known> = plan
        .items
        .par_iter()
        .filter_map(|item| {
            let world = Remembering::new(&stage.world);
            let path = path(item, &job.settings, &world).ok()?;
            Some(observe(&world, &path, job.settings.frames, team.observers()).map_err(Error::from).and_then(|seen| {
                let panoramas = panoramas(&world, &path)?;
                Ok((Walk::new(path, seen), panoramas))
            }))
        })
        .filter_map(|made| match made {
            Ok((walk, panoramas)) => {
                let labels = Evidence::from_labels(&walk.path, &panoramas)?;
                let captions = walk.evidence()?;
                Some(Ok(Known { walk, labels, captions }))
            }
            Err(error) => Some(Err(error)),
        })
        .collect::<Result<_, _>>()?;
    let (counts, wrong) = counted(&known, flags);
    for line in wrong {
        output.say(line);
    }
    output.data(&(), told(&known, &counts, flags));
    Ok(())
}

/// A job in which only the eye is a model; rules play all other roles.
fn job(stage: &Stage, flags: &Flags) -> Result<Job, Error> {
    let mut job = stage.job(flags.paths)?;
    let roles = &mut job.settings.roles;
    (roles.ask, roles.summarise, roles.write) = (RULES.to_owned(), RULES.to_owned(), RULES.to_owned());
    debug_assert!(roles.see != LABELS);
    let Settings { perception, evidence, .. } = &mut job.settings;
    (*perception, *evidence) = (Perception::Structured, Sources::default());
    if flags.episodes.is_some() {
        job.settings.episodes.clone_from(&flags.episodes);
        job.settings.paths = 0;
        job.settings.limit = Some(flags.paths);
    }
    Ok(job)
}

fn counted(known: &[Known], flags: &Flags) -> (Counts, Vec<String>) {
    let names = made::Names::of(known);
    let style = Style { name: "claims".to_owned(), ..Style::default() };
    let mut counts = Counts::new();
    let mut shown: BTreeMap<(&str, Kind), usize> = BTreeMap::new();
    let mut wrong = Vec::new();
    for one in known {
        let mut rng = rng(flags.world.seed, &["claims", &one.walk.path.id]);
        for Claim { kind, text } in made::claims(one, &names, flags.claims, &mut rng) {
            for (source, evidence) in [("labels", &one.labels), ("captions", &one.captions)] {
                let checked = check(&text, Subject::closed(evidence, &style, None));
                let places = |check| matches!(check, Check::Landmarks | Check::Order | Check::Turns);
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
                        one.walk.path.id
                    ));
                }
            }
        }
    }
    (counts, wrong)
}

fn told(known: &[Known], counts: &Counts, flags: &Flags) -> String {
    let views: usize =
        known.iter().map(|one| one.walk.observations.iter().map(|seen| seen.looks.len()).sum::<usize>()).sum();
    let transcripts = |seen: &Observation| seen.looks.iter().map(|look| look.caption.transcript.len()).sum::<usize>();
    let calls: usize = known.iter().flat_map(|one| &one.walk.observations).map(transcripts).sum();
    let mut lines = vec![
        format!(
            "{} paths, {views} views, {:.2} requests a view; a scripted eye with {:.0} % hallucinated objects and doubts",
            known.len(),
            calls as f64 / views.max(1) as f64,
            100.0 * flags.hallucinated
        ),
        "held against  claims                      number  passed  unverified  failed".to_owned(),
    ];
    for ((source, kind), Count { all, failed, unverified }) in counts {
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
