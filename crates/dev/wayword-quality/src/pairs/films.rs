//! Films of walks through generated houses, as a scripted eye sees them, by poses and by pictures.

use crate::stage::{MeasuredWorldArgs, MeasurementStage};
use rand::Rng;
use rayon::prelude::*;
use std::sync::Arc;
use std::{collections::BTreeMap, path::Path as FilePath};
use wayword_checks::Evidence;
use wayword_core::{DVec3, Frame, Heading, Image, Path, Platform, Pose, ViewGaze, seeded_rng};
use wayword_follower::pair::{FilmedHop, FilmedWalk};
use wayword_formats::jsonl;
use wayword_recording::estimate_film_steps;
use wayword_run::{
    error::CommandError,
    output::CommandOutput,
    pairs::{filmed_walk, read_films},
    people::{PeopleWalk, read_people_walks},
    plan::RunPlan,
    platforms::{self, RememberingPlatform},
    run_folder::{file, fresh_id},
    team::RoleTeam,
};
use wayword_synthesis::{
    observe::observe_path,
    walk::{FrameSelection, ObservedWalk},
};
use wayword_testkit::provider::scripts::FlawedEye;

/// A film with the texts that were written for its walk.
pub(super) struct SeenFilm {
    pub(super) scene: String,
    /// With the true turns.
    pub(super) by_poses: FilmedWalk,
    /// With the turns that its pictures show.
    pub(super) by_pictures: FilmedWalk,
    pub(super) texts: Vec<String>,
}

/// How well the eye sees.
#[derive(Debug, Clone, Copy)]
pub(super) struct EyeShares {
    /// Share of the things in a picture that it names.
    pub(super) recall: f64,
    /// Share of the things that it names which are not there.
    pub(super) invented: f64,
}

/// The walks of runs of generated houses, each seen by the eye in pictures ahead alone.
///
/// # Errors
/// When a run cannot be read, or a view cannot be had.
pub(super) fn see_films(
    runs: &[impl AsRef<FilePath>],
    eye: EyeShares,
    draw: bool,
    seed: u64,
    output: &CommandOutput,
) -> Result<Vec<SeenFilm>, CommandError> {
    let mut texts: BTreeMap<String, (Path, Vec<String>)> = BTreeMap::new();
    for run in runs {
        for record in jsonl::read_records(&run.as_ref().join(file::INSTRUCTIONS))? {
            let key = format!("{} {}", record.path.scene, record.path.id);
            texts.entry(key).or_insert_with(|| (record.path.clone(), Vec::new())).1.push(record.instruction.text);
        }
    }
    let world = MeasuredWorldArgs { platform: "house".to_owned(), data: None, scan: None, seed };
    let stage = MeasurementStage::with_eye(&world, |flawed| FlawedEye {
        miss_share: 1.0 - eye.recall,
        hallucinated_share: eye.invented,
        ..flawed
    })?;
    let job = stage.looking_job(1)?;
    let plan = RunPlan::for_looking(&job, &stage.world)?;
    let calls = plan.models.open_calls(&fresh_id("pairs"), output)?;
    let team = RoleTeam::new(&job.settings, calls.as_ref(), &stage.world)?;
    let house = platforms::open_named("house", None, None, None)?;
    let bar = output.progress_bar(texts.len(), "films");
    let see = |(path, texts): (Path, Vec<String>)| {
        let world = RememberingPlatform::new(&stage.world);
        let seen = observe_path(&world, &path, FrameSelection::Central, team.observers())?;
        let walk = ObservedWalk::new(path, seen);
        let evidence = walk.evidence().unwrap_or_else(|| Evidence::for_path_alone(&walk.path));
        let by_poses = filmed_walk(&walk.path, &evidence);
        let by_pictures = match draw {
            true => by_drawn_pictures(&by_poses, house.as_ref(), &walk.path)?,
            false => by_lot(&by_poses, seed, &walk.path.id),
        };
        bar.inc(1);
        Ok(SeenFilm { scene: walk.path.scene.to_string(), by_poses, by_pictures, texts })
    };
    let films = texts.into_values().collect::<Vec<_>>().into_par_iter().map(see).collect();
    bar.finish_and_clear();
    films
}

/// The films of checks, which are taken to be of right pairs; with the turns of the same films by pictures, or by lot.
///
/// # Errors
/// When a folder cannot be read.
pub(super) fn checked_films(
    checks: &[impl AsRef<FilePath>],
    by_pictures: &[impl AsRef<FilePath>],
) -> Result<Vec<SeenFilm>, CommandError> {
    let mut seen = Vec::new();
    for (number, check) in checks.iter().enumerate() {
        let estimated = by_pictures.get(number).map(|check| read_films(check.as_ref())).transpose()?;
        let estimated: BTreeMap<usize, FilmedWalk> =
            estimated.into_iter().flatten().map(|film| (film.at, film.walk)).collect();
        for film in read_films(check.as_ref())? {
            let lot = by_lot(&film.walk, number as u64, &film.scene);
            seen.push(SeenFilm {
                by_pictures: estimated.get(&film.at).cloned().unwrap_or(lot),
                by_poses: film.walk,
                texts: film.pairs.into_iter().map(|pair| pair.text).collect(),
                scene: film.scene,
            });
        }
    }
    Ok(seen)
}

/// The walks of people's texts as their labels show them.
///
/// # Errors
/// When the data or the texts cannot be read.
pub(super) fn label_films(
    data: &FilePath,
    episodes: &FilePath,
    output: &CommandOutput,
) -> Result<Vec<SeenFilm>, CommandError> {
    let platform = platforms::open_named("matterport", Some(data), None, None)?;
    let (walks, _) = read_people_walks(platform.as_ref(), episodes)?;
    output.say(format_args!("{} walks", walks.len()));
    let film = |walk: PeopleWalk| {
        let by_poses = filmed_walk(&walk.path, &walk.evidence);
        let by_pictures = by_lot(&by_poses, 0, &walk.path.id);
        let texts = walk.texts.into_iter().map(|text| text.words).collect();
        SeenFilm { scene: walk.path.scene.to_string(), by_poses, by_pictures, texts }
    };
    Ok(walks.into_iter().map(film).collect())
}

/// Share of the turns that pictures do not tell, where the camera turns and where it does not.
const UNTOLD_SHARES: [f64; 2] = [0.15, 0.05];
/// By how much an estimated turn may be off, as a share of it.
const TURN_ERROR: f64 = 0.1;

/// A film with the turns as an estimate would tell them, drawn by lot; without lengths and heights.
fn by_lot(walk: &FilmedWalk, seed: u64, id: &str) -> FilmedWalk {
    let mut rng = seeded_rng(seed, &["estimated turns", id]);
    let hop = |hop: &FilmedHop| {
        let turn_rad = hop.turn_rad.filter(|turn| {
            let turns = turn.abs() >= UNTOLD_TURN_RAD;
            !rng.random_bool(UNTOLD_SHARES[usize::from(!turns)])
        });
        let turn_rad = turn_rad.map(|turn| turn * (1.0 + rng.random_range(-TURN_ERROR..TURN_ERROR)));
        FilmedHop { turn_rad, ..FilmedHop::default() }
    };
    FilmedWalk { places: walk.places.clone(), hops: walk.hops.iter().map(hop).collect() }
}

/// A turn that is harder to tell from pictures, radians.
const UNTOLD_TURN_RAD: f64 = 0.5;
/// Step and turn of a drawn film: those of VLN-CE.
const STEP_M: f64 = 0.25;
const STEP_RAD: f64 = std::f64::consts::PI / 12.0;

/// A film with the turns that its drawn pictures show: one after each turn of 15 degrees and each step of 0.25 m.
fn by_drawn_pictures(walk: &FilmedWalk, world: &dyn Platform, path: &Path) -> Result<FilmedWalk, CommandError> {
    let mut pictures = Vec::new();
    let mut ends = vec![0];
    let look = |position: DVec3, heading: Heading| -> Result<Option<Arc<Image>>, CommandError> {
        let frame = Frame { pose: Pose::looking_level(position, heading), viewpoint: None, level: None };
        Ok(world.look_from(&path.scene, &frame, ViewGaze::quarter_view(heading))?.image)
    };
    let Some(first) = path.frames.first() else { return Ok(walk.clone()) };
    pictures.extend(look(first.pose.position, first.pose.heading)?);
    for (step, pair) in path.moves().iter().zip(path.frames.windows(2)) {
        let turns = (step.turn_rad.abs() / STEP_RAD).ceil() as usize;
        for at in 1..=turns {
            let share = at as f64 / turns as f64;
            pictures.extend(look(pair[0].pose.position, pair[0].pose.heading.turned_by(step.turn_rad * share))?);
        }
        let steps = (step.distance_m / STEP_M).ceil().max(1.0) as usize;
        for at in 1..=steps {
            let place = pair[0].pose.position.lerp(pair[1].pose.position, at as f64 / steps as f64);
            pictures.extend(look(place, pair[1].pose.heading)?);
        }
        ends.push(pictures.len().saturating_sub(1));
    }
    let pictures = pictures.iter().map(AsRef::as_ref);
    let steps = estimate_film_steps(pictures, ViewGaze::quarter_view(Heading::NORTH).horizontal_fov_rad);
    let hop = |range: &[usize]| FilmedHop {
        turn_rad: steps.get(range[0]..range[1]).unwrap_or_default().iter().map(|step| step.turn_rad).sum(),
        ..FilmedHop::default()
    };
    Ok(FilmedWalk { places: walk.places.clone(), hops: ends.windows(2).map(hop).collect() })
}
