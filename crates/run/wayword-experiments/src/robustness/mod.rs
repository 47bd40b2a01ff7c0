//! `wayword robustness`: writes the texts of a run again in changed worlds, and measures how much the texts change.

pub mod args;
mod arm;
mod base;
mod elsewhere;
mod eye;
mod figures;
mod making;
mod names;
mod other;
mod reader;
mod record;
mod screen;
mod sets;
mod world;

use crate::{demands::Demands, robustness::args::Robustness};
use arm::Arm;
use base::Base;
use elsewhere::Elsewhere;
use figures::Lines;
use making::{Crew, InArm, Unchanged};
use record::{Line, key};
use serde::{Deserialize, Serialize};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::{Path as FilePath, PathBuf},
};
use wayword_core::{Path, Platform};
use wayword_report::pages as report;
use wayword_report::pages::robustness::results::{Refused, Results};
use wayword_robustness::{Change, Sees, Setting, ratio::Drawing, worlds::EyeOf};
use wayword_run::{
    calls::Calls,
    error::{Error, Exit},
    follow::KnownScenes,
    in_order::{cores, in_order},
    interrupt,
    looking_for::Lookout,
    output::Output,
    own_format::OwnFormat,
    plan::Models,
    platforms::{self, Remembering},
    run_folder as run,
    run_folder::{Journal, hash_of_file, lines},
    settings::{Asked, Job, LABELS, Settings},
    settings_file as config,
    team::Team,
};

/// Names of the files in the folder, except `config.toml`.
mod file {
    /// The texts, a line for each arm and path.
    pub(super) const TEXTS: &str = "texts.jsonl";
    /// The results.
    pub(super) const RESULTS: &str = "robustness.json";
}

/// Level of the intervals.
const LEVEL: f64 = 0.95;

/// The settings with which a folder was begun. They stay the same, but more changes may be added later.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    /// The run.
    run: PathBuf,
    /// Hash of its paths.
    walks: String,
    /// The scripted eye.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    eye: Option<String>,
    /// The names that the run's scenes have on other platforms.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    scene_names: names::Names,
    /// Only this many paths.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    limit: Option<u32>,
    /// Seed of everything random.
    seed: u64,
}

impl OwnFormat for Kept {
    const NAME: &str = "wayword-robustness/1";
}

pub fn run(args: &Robustness, output: &Output) -> Result<Exit, Error> {
    let changes = changes(&args.change)?;
    if args.list {
        output.data(&screen::listed(), screen::list());
        return Ok(Exit::Done);
    }
    if !args.compared.is_empty() {
        let drawing = Drawing { resamples: args.resamples as usize, level: LEVEL, seed: args.seed };
        let found = sets::of(&args.compared, drawing)?;
        output.data(&found, &found);
        return Ok(Exit::Done);
    }
    let (Some(folder), Some(out)) = (&args.run, &args.out) else {
        return Err(Error::usage("a run and a folder are needed", "give --run DIR and --out DIR"));
    };
    let base = Base::read(folder, args.limit)?;
    let eye = args.eye.as_deref().map(eye::parse).transpose()?;
    if eye.is_some() && base.settings.roles.see != LABELS {
        let problem = format!(
            "--eye: in {} {} sees, and the eye would take its place",
            folder.display(),
            base.settings.roles.see
        );
        return Err(Error::usage(problem, "give a run in which labels see"));
    }
    let job = job(args, &base.settings)?;
    Calls::ready(&job, output)?;
    let platform = platforms::open(&job.settings)?;
    let (changes, refused) = sorted_out(changes, &setting(&base, platform.as_ref(), eye.is_some())?);
    for Refused { reason, .. } in &refused {
        output.say(format_args!("not made: {reason}"));
    }
    if changes.is_empty() {
        return Err(Error::usage("no change is left to make", "see `wayword robustness --list`"));
    }
    let _held = begin(args, &base, out)?;
    let id = run::id_of(out, "robustness")?;
    let calls = Models::of(&job)?.open(&id, output)?;
    if calls.is_some() {
        run::keep_id(out, &id)?;
    }
    let failed = make(args, &base, &changes, eye, (platform.as_ref(), calls.as_ref()), output)?;
    if let Some(calls) = &calls {
        calls.record()?;
        output.say(format_args!("models: {}", calls.spent()));
    }
    let results = found(args, &base, &changes, eye, refused, &read(out)?);
    let json = serde_json::to_string_pretty(&results)
        .map_err(|error| Error::usage(format!("the results cannot be written: {error}"), "report this as a bug"))?;
    run::write_whole(&out.join(file::RESULTS), &json)?;
    report::robustness::write(&out.join(run::file::REPORT), &results)?;
    output.data(&results, screen::results(&results));
    output.say(format_args!("texts, figures and page: {}", out.display()));
    Ok(if failed == 0 { Exit::Done } else { Exit::WithLoss })
}

/// The changes that were typed, or the default set.
fn changes(typed: &[String]) -> Result<Vec<Change>, Error> {
    let mut changes: Vec<Change> = Vec::new();
    for text in typed {
        let parsed = Change::parse(text)
            .map_err(|error| Error::usage(format!("--change {text}: {error}"), "see `wayword robustness --list`"))?;
        for change in parsed {
            if !changes.contains(&change) {
                changes.push(change);
            }
        }
    }
    Ok(if typed.is_empty() { Change::default_set() } else { changes })
}

/// The job of the run, with how models are reached now.
fn job(args: &Robustness, settings: &Settings) -> Result<Job, Error> {
    let Asked { service, providers, .. } = config::calls(args.config.as_deref())?;
    let asked = Asked { service: args.service.clone(), ..Asked::default() };
    let asked = asked.or(Asked { service, providers, ..Asked::default() });
    Ok(Job { settings: settings.clone(), ..asked.job()? })
}

/// The properties of the run on which it depends which changes can be made.
fn setting<'a>(base: &'a Base, platform: &dyn Platform, has_eye: bool) -> Result<Setting<'a>, Error> {
    let name = base.settings.platform.as_str();
    let graph = name == "matterport" || name == "process" && !platform.graph(&base.paths[0].scene)?.is_empty();
    Ok(Setting {
        platform: name,
        sees: match base.settings.roles.see.as_str() {
            _ if has_eye => Sees::Eye,
            LABELS => Sees::Labels,
            _ => Sees::Pictures,
        },
        has_poses: base.paths.iter().all(|path| path.motion.is_known()),
        draws: !matches!(name, "matterport" | "recording"),
        graph,
    })
}

/// Separates the changes that can be made from the refused ones, which get a reason.
fn sorted_out(changes: Vec<Change>, setting: &Setting<'_>) -> (Vec<Change>, Vec<Refused>) {
    let (mut made, mut refused) = (Vec::new(), Vec::new());
    for change in changes {
        let unknown = || if let Change::Platform(spec) = &change { elsewhere::refusal(spec) } else { None };
        match unknown().or_else(|| change.refusal(setting)) {
            Some(reason) => refused.push(Refused { change: change.to_string(), reason }),
            None => made.push(change),
        }
    }
    (made, refused)
}

/// Makes or continues the folder, and locks it against other processes.
fn begin(args: &Robustness, base: &Base, out: &FilePath) -> Result<run::Held, Error> {
    run::refuse_file(out)?;
    let folder = &base.folder;
    let kept = Kept {
        run: folder.canonicalize().map_err(Error::io(folder, "find"))?,
        walks: hash_of_file(&folder.join(run::file::WALKS))?,
        eye: args.eye.clone(),
        scene_names: names::of(&args.scene_name)?,
        limit: args.limit,
        seed: args.seed,
    };
    fs::create_dir_all(out).map_err(Error::io(out, "make the folder"))?;
    let held = run::hold(out)?;
    run::keep_config(out, &kept)?;
    Ok(held)
}

/// Writes all texts that are not in the folder yet. Returns how many items failed.
fn make(
    args: &Robustness,
    base: &Base,
    changes: &[Change],
    eye: Option<EyeOf>,
    (platform, calls): (&dyn Platform, Option<&Calls>),
    output: &Output,
) -> Result<usize, Error> {
    let settings = &base.settings;
    let out = args.out.as_deref().unwrap_or(FilePath::new("."));
    let labels = Remembering::labels_of(platform);
    // If no model takes part, no pictures are needed, and all views of the run fit into memory.
    let world: &dyn Platform = if settings.roles.models().is_empty() { &labels } else { platform };
    let team = |sample| {
        let lookout = Lookout::of(settings, calls, &base.styles)?;
        Ok::<_, Error>(Team::of_sample(settings, calls, platform, sample)?.with(lookout))
    };
    let (team, again) = (team(0)?, team(1)?);
    let threads = calls.map_or(1, |calls| calls.views_at_once(base.paths.len()));
    let crew = Crew { base, platform: world, team: &team, again: &again, eye, seed: args.seed, threads };
    let mut journal = Journal::open(&out.join(file::TEXTS), Line::key_of)?;
    let _graceful = interrupt::finish_first(calls);
    let workers = calls.map_or_else(cores, Calls::workers);
    let arms = Arm::of(changes);
    let names = names::of(&args.scene_name)?;
    let bar = output.progress(arms.len() * base.paths.len(), "texts");
    let mut failed = 0;
    let mut unchanged = Unchanged::new();
    for arm in &arms {
        bar.set_message(arm.said());
        let walks = making::walked(arm, world);
        let left: Vec<&Path> = base.paths.iter().filter(|path| !journal.has(&key(&arm.id(), &path.id))).collect();
        let elsewhere = match arm {
            Arm::Changed(Change::Platform(spec)) if !left.is_empty() => {
                Some(Elsewhere::open(spec, base, platform, (out, &names))?)
            }
            _ => None,
        };
        let (scenes, demands) = (KnownScenes::new(), Demands::new(walks.as_ref()));
        let within = InArm { arm, scenes, walks: walks.as_ref(), demands, elsewhere, unchanged: &unchanged };
        bar.inc((base.paths.len() - left.len()) as u64);
        let making = |path: &&Path| {
            interrupt::check()?;
            crew.line(&within, path)
        };
        let mut keep = |path: &&Path, made: Result<Line, Error>| {
            bar.inc(1);
            match made {
                Ok(line) => journal.append(&line)?,
                Err(error) if error.failure().is_none() => return Err(error),
                Err(error) => {
                    failed += 1;
                    output.say(format_args!("{}, path {}: {error}", arm.said(), path.id));
                }
            }
            Ok(true)
        };
        if within.elsewhere.is_some() {
            // A simulator shows one scene at a time, and takes seconds to show another.
            for paths in by_scene(left) {
                in_order(&paths, workers, making, &mut keep)?;
            }
        } else {
            in_order(&left, workers, making, &mut keep)?;
        }
        if *arm == Arm::Unchanged {
            unchanged = read(out)?.remove(&arm.id()).unwrap_or_default();
        }
    }
    bar.finish_and_clear();
    journal.sync()?;
    Ok(failed)
}

/// Groups paths by scene.
fn by_scene(paths: Vec<&Path>) -> impl Iterator<Item = Vec<&Path>> {
    let mut scenes: BTreeMap<_, Vec<&Path>> = BTreeMap::new();
    for path in paths {
        scenes.entry(&path.scene).or_default().push(path);
    }
    scenes.into_values()
}

/// Reads all lines of `texts.jsonl`, by arm and path.
fn read(out: &FilePath) -> Result<Lines, Error> {
    let mut all = Lines::new();
    lines::each(&out.join(file::TEXTS), |line| {
        let line: Line = line.parse()?;
        all.entry(line.arm.clone()).or_default().insert(line.path.id.clone(), line);
        Ok(())
    })?;
    Ok(all)
}

/// Computes all figures from the lines.
fn found(
    args: &Robustness,
    base: &Base,
    changes: &[Change],
    eye: Option<EyeOf>,
    refused: Vec<Refused>,
    lines: &Lines,
) -> Results {
    let drawing = Drawing { resamples: args.resamples as usize, level: LEVEL, seed: args.seed };
    let unchanged = lines.get(&Arm::Unchanged.id());
    let texts = unchanged.into_iter().flat_map(BTreeMap::values).flat_map(|line| {
        line.texts.iter().map(|told| (line.path.id.as_str(), told.style.as_str(), told.text.as_deref()))
    });
    let roles = &base.settings.roles;
    let styles = base.styles.iter().map(|style| figures::of_style(base, &style.style.name, changes, lines, drawing));
    let sees = eye.map_or_else(|| format!("Who sees: {}", roles.see), |eye| eye::said(&eye));
    Results {
        platform: base.settings.platform.clone(),
        roles: format!("{sees}; who writes: {}", roles.write),
        paths: base.paths.len(),
        scenes: base.paths.iter().map(|path| &path.scene).collect::<BTreeSet<_>>().len(),
        again: base.again(texts),
        agent: reader::NAME.to_owned(),
        level: LEVEL,
        styles: styles.collect(),
        refused,
    }
}
