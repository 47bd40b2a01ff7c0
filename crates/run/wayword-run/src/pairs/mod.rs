//! `wayword check --by pictures`: how likely each text of a dataset is wrong about its film.
//!
//! - `texts`: which films a file is about. `judge`: sees the films, and how the texts fit. `film`: a path as a film shows it.
//! - `records`: the lines that are kept. `decisions`: what curators decided.

pub mod args;
pub mod decisions;
mod film;
mod judge;
mod records;
mod texts;

pub use film::filmed_walk;
#[cfg(all(feature = "lerobot", feature = "parquet"))]
pub(crate) use film::{filmed_places, hop_between, walk_by_motion};
pub use records::{FilmRecord, PairFindingRecord, PairPartRecord, PairPartState, PairRecord};

use crate::{
    calls::ModelCalls,
    check::args::CheckArgs,
    error::CommandError,
    in_order::{core_count, in_order},
    interrupt,
    lookout::DetectorLookout,
    output::CommandOutput,
    plan::JobModels,
    platforms,
    run_folder::{Journal, file, fresh_id, lines::each_line, lock_folder},
    settings::{AskedPlatform, AskedRoles, AskedSettings, RunJob, Service},
    team::RoleTeam,
    written_files::{expect_own_folder, write_file},
};
use args::AskedMotion;
use judge::PairJudge;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::{
    fmt, fs,
    path::{Path as FilePath, PathBuf},
};
use texts::{FilmTexts, place_of_films, read_film_texts};
use wayword_follower::pair::chances_with_mean;
use wayword_recording::MAX_OPEN_RECORDINGS;

/// The lines of all films, as they are judged.
pub const FILMS: &str = "films.jsonl";
/// The lines of all pairs, the worst first.
pub const PAIRS: &str = "pairs.jsonl";
/// The pictures of the films.
pub const PICTURES: &str = "pictures";
/// What was asked.
const ASKED: &str = "check.json";

/// What was asked of a check by pictures: films that were judged in another way are not mixed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AskedPairCheck {
    /// The file or folder that was checked.
    pub dataset: String,
    /// Who saw: a model, labels, a detector.
    pub eyes: Vec<String>,
    /// What the motion is taken from.
    pub motion: AskedMotion,
    /// The share of wrong pairs that was expected.
    pub base_rate: f64,
    /// Whether the user gave it, so that the chances of many pairs have it as their mean.
    pub base_rate_is_given: bool,
    /// SHA-256 of all names and texts.
    pub texts: String,
}

/// The result of a check by pictures, which `--json` prints.
#[derive(Debug, Serialize)]
pub struct PairReport {
    /// What was asked.
    pub asked: AskedPairCheck,
    /// Films that were judged.
    pub films: usize,
    /// Films that could not be read.
    pub failed_films: usize,
    /// Pairs with a chance to be wrong.
    pub judged: usize,
    /// Pairs that could not be judged, and why the first could not.
    pub unjudged: usize,
    /// How many pairs are expected to be wrong: the sum of the chances.
    pub expected_wrong: f64,
    /// All pairs, the worst first.
    pub pairs: Vec<PairRecord>,
}

/// Judges all pairs of a file; what `--out` names keeps the films that are done.
///
/// # Errors
/// When the flags do not fit together, the file or the platform cannot be read, a model does not answer, or the folder cannot be written.
pub fn judge_pairs(args: &CheckArgs, output: &CommandOutput) -> Result<PairReport, CommandError> {
    let job = job_of(args)?;
    let models = JobModels::for_job(&job)?;
    let platform = platforms::open_platform(&job.settings)?;
    let films = read_film_texts(&args.file, platform.as_ref())?;
    let asked = AskedPairCheck {
        dataset: args.file.display().to_string(),
        eyes: args.pairs.see.iter().chain(&args.detecting.detector).cloned().collect(),
        motion: args.pairs.motion,
        base_rate: args.pairs.base_rate.unwrap_or(USUAL_BASE_RATE),
        base_rate_is_given: args.pairs.base_rate.is_some(),
        texts: hash_of_texts(&films),
    };
    let folder = args.pairs.out.as_deref();
    let mut kept = folder.map(|folder| PairFolder::open(folder, &asked)).transpose()?;
    if !models.is_empty() {
        ModelCalls::check_ready(&job, output)?;
    }
    let calls = models.open_calls(&fresh_id("pairs"), output)?;
    let lookout = DetectorLookout::from_settings(&job.settings, calls.as_ref(), &[])?;
    let team = RoleTeam::new(&job.settings, calls.as_ref(), platform.as_ref())?;
    let judge = PairJudge {
        platform: platform.as_ref(),
        team: args.pairs.see.is_some().then_some(&team),
        lookout: lookout.as_ref(),
        motion: args.pairs.motion,
        base_rate: asked.base_rate,
        pictures: folder.map(|folder| folder.join(PICTURES)),
        threads: calls.as_ref().map_or(1, |calls| calls.views_at_once(films.len())),
    };
    let workers = calls.as_ref().map_or_else(core_count, ModelCalls::worker_count).min(MAX_OPEN_RECORDINGS);
    let records = judge_films(&judge, &films, workers, kept.as_mut(), output)?;
    if let Some(calls) = &calls {
        calls.finish(output)?;
    }
    let report = PairReport::new(asked, &records);
    if let Some(folder) = folder {
        let lines = report.pairs.iter().map(|pair| serde_json::to_string(pair).unwrap_or_default() + "\n");
        write_file(&folder.join(PAIRS), lines.collect::<String>())?;
    }
    Ok(report)
}

/// The settings that the flags ask for.
fn job_of(args: &CheckArgs) -> Result<RunJob, CommandError> {
    let asked = &args.pairs;
    if asked.see.is_none() && args.detecting.detector.is_none() {
        let hint = "give --see MODEL, --see labels or --detector MODEL";
        return Err(CommandError::usage("--by pictures: nobody is named who looks at the pictures", hint));
    }
    if let Some(rate) = asked.base_rate.filter(|rate| !(0.0..=1.0).contains(rate)) {
        return Err(CommandError::usage(
            format!("--base-rate {rate} is out of range"),
            "give a share from 0 to 1, as in --base-rate 0.2",
        ));
    }
    let is_elsewhere = args.platform.platform.is_some() || args.platform.data.is_some();
    let platform = match is_elsewhere {
        true => args.platform.clone(),
        false => AskedPlatform {
            platform: Some("recording".into()),
            data: Some(place_of_films(&args.file)),
            ..args.platform.clone()
        },
    };
    let detecting = match args.detecting.detector {
        Some(_) => args.detecting.to_asked(),
        None => AskedSettings {
            service: Service { ledger: args.detecting.ledger.clone(), ..Service::default() },
            ..AskedSettings::default()
        },
    };
    AskedSettings {
        platform,
        roles: AskedRoles { see: asked.see.clone(), base_url: asked.base_url.clone(), ..detecting.roles },
        service: Service {
            key_env: asked.key_env.clone(),
            max_usd: asked.max_usd,
            concurrency: asked.concurrency,
            ..detecting.service
        },
        writing: detecting.writing,
        ..AskedSettings::default()
    }
    .into_job()
}

fn hash_of_texts(films: &[FilmTexts]) -> String {
    let mut hash = Sha256::new();
    for text in films.iter().flat_map(|film| &film.texts) {
        for part in [&text.name, &text.words] {
            hash.update(part.len().to_le_bytes());
            hash.update(part.as_bytes());
        }
    }
    wayword_core::hex_text(hash.finalize())
}

/// Judges the films that are not kept yet, and returns all in their order.
fn judge_films(
    judge: &PairJudge<'_>,
    films: &[FilmTexts],
    workers: usize,
    mut kept: Option<&mut PairFolder>,
    output: &CommandOutput,
) -> Result<Vec<FilmRecord>, CommandError> {
    let mut records = match &kept {
        Some(kept) => kept.read_films()?,
        None => Vec::new(),
    };
    let done: std::collections::BTreeSet<usize> = records.iter().map(|record| record.at).collect();
    let left: Vec<(usize, &FilmTexts)> = films.iter().enumerate().filter(|(at, _)| !done.contains(at)).collect();
    if !done.is_empty() {
        output.say(format_args!("continuing: {} of {} films done and kept", done.len(), films.len()));
    }
    let bar = output.progress_bar(left.len(), "films");
    let make = |(at, film): &(usize, &FilmTexts)| {
        interrupt::check_interrupt()?;
        judge.judge_film(*at, film)
    };
    in_order(&left, workers, make, |_, record| {
        let record = record?;
        if let Some(kept) = &mut kept {
            kept.films.append(&record)?;
        }
        records.push(record);
        bar.inc(1);
        Ok::<_, CommandError>(true)
    })?;
    bar.finish_and_clear();
    records.sort_by_key(|record| record.at);
    Ok(records)
}

/// The folder of a check: one command at a time works in it.
struct PairFolder {
    place: PathBuf,
    films: Journal,
    _held: crate::run_folder::FolderLock,
}

impl PairFolder {
    fn open(folder: &FilePath, asked: &AskedPairCheck) -> Result<Self, CommandError> {
        let is_own = |name: &str| {
            [FILMS, PAIRS, PICTURES, ASKED, file::LOCK].contains(&name)
                || name.ends_with(".html")
                || name == decisions::DECISIONS
        };
        expect_own_folder(folder, is_own)?;
        let pictures = folder.join(PICTURES);
        fs::create_dir_all(&pictures).map_err(CommandError::io(&pictures, "make the folder"))?;
        let held = lock_folder(folder)?;
        let place = folder.join(ASKED);
        if place.is_file() {
            let text = fs::read_to_string(&place).map_err(CommandError::io(&place, "read"))?;
            let before: AskedPairCheck = serde_json::from_str(&text)
                .map_err(|error| CommandError::usage(format!("{}: {error}", place.display()), "give another --out"))?;
            if before != *asked {
                let problem = format!("{}: it holds another check: {text}", folder.display());
                return Err(CommandError::usage(problem, "give the same flags and texts to go on, or another --out"));
            }
        } else {
            write_file(&place, serde_json::to_string_pretty(asked).unwrap_or_default() + "\n")?;
        }
        let key = |line: &Value| line.get("at").and_then(Value::as_u64).map(|at| at.to_string());
        Ok(Self { place: folder.to_owned(), films: Journal::open(&folder.join(FILMS), key)?, _held: held })
    }

    fn read_films(&self) -> Result<Vec<FilmRecord>, CommandError> {
        read_films(&self.place)
    }
}

/// The films of a check's folder.
///
/// # Errors
/// When they cannot be read.
pub fn read_films(folder: &FilePath) -> Result<Vec<FilmRecord>, CommandError> {
    let mut films = Vec::new();
    each_line(&folder.join(FILMS), |line| {
        films.push(line.parse()?);
        Ok(())
    })?;
    Ok(films)
}

impl PairReport {
    fn new(asked: AskedPairCheck, films: &[FilmRecord]) -> Self {
        let mut pairs: Vec<PairRecord> = films.iter().flat_map(|film| film.pairs.iter().cloned()).collect();
        if asked.base_rate_is_given {
            move_chances(&mut pairs, asked.base_rate);
        }
        pairs.sort_by(|a, b| b.suspicion().total_cmp(&a.suspicion()));
        let chances: Vec<f64> = pairs.iter().filter_map(|pair| pair.chance_wrong).collect();
        Self {
            asked,
            films: films.len(),
            failed_films: films.iter().filter(|film| film.failed.is_some()).count(),
            judged: chances.len(),
            unjudged: pairs.len() - chances.len(),
            expected_wrong: chances.iter().sum(),
            pairs,
        }
    }
}

/// The share of wrong pairs, if the user gives none.
const USUAL_BASE_RATE: f64 = 0.2;
/// With fewer pairs than this their mean says little of the whole.
const MIN_MOVED_PAIRS: usize = 50;

/// Moves the chances of many pairs together until their mean is a share.
fn move_chances(pairs: &mut [PairRecord], share: f64) {
    let known: Vec<(f64, f64)> = pairs.iter().filter_map(|pair| Some((pair.chance_wrong?, 1.0))).collect();
    if known.len() < MIN_MOVED_PAIRS {
        return;
    }
    let moved = chances_with_mean(&known, share.clamp(0.001, 0.999));
    let judged = pairs.iter_mut().filter(|pair| pair.chance_wrong.is_some());
    judged.zip(moved).for_each(|(pair, chance)| pair.chance_wrong = Some(chance));
}

/// Most pairs that the screen lists.
const MOST_LISTED: usize = 10;

impl fmt::Display for PairReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for pair in self.pairs.iter().take(MOST_LISTED) {
            match (pair.chance_wrong, &pair.problem) {
                (Some(chance), _) => writeln!(f, "{:>3.0} %  {}: {:?}", 100.0 * chance, pair.pair, pair.text)?,
                (None, why) => {
                    writeln!(f, "    ?  {}: {}: {:?}", pair.pair, why.as_deref().unwrap_or_default(), pair.text)?;
                }
            }
            let findings = pair.parts.iter().flat_map(|part| &part.findings);
            for finding in findings.filter(|finding| finding.state == PairPartState::Wrong) {
                writeln!(f, "       {}", finding.reason)?;
            }
        }
        write!(
            f,
            "{} pairs of {} films: about {:.0} are wrong, if {:.0} % of such pairs are",
            self.judged,
            self.films,
            self.expected_wrong,
            100.0 * self.asked.base_rate
        )?;
        if self.unjudged > 0 {
            write!(f, "; {} could not be judged", self.unjudged)?;
        }
        Ok(())
    }
}
