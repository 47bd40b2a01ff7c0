//! One item from path to checked instructions.

use crate::{
    error::Error,
    item::Item,
    pictures::{self, Picture},
    run::WorldData,
    settings::{Against, Settings, TargetMode},
    styles::Measured,
    team::Team,
    world::Remembering,
};
use wayword_checks::Evidence;
use wayword_core::{Frame, Gaze, Motion, Path, Platform, PlatformError, SceneId, View};
use wayword_synthesis::{
    minds::distinguish,
    observe::observe,
    repair::{Order, Outcome, write_and_repair},
    walk::Walk,
};

/// What became of an item.
#[derive(Debug)]
pub struct Made {
    /// The path and what was seen along it.
    pub walk: Walk,
    /// One per style, in the order of the run's styles.
    pub outcomes: Vec<Outcome>,
    /// What is seen ahead from each frame, where the platform has pictures.
    pub pictures: Vec<Picture>,
}

/// The world that a run is made in.
#[derive(Clone, Copy)]
pub struct RunWorld<'a> {
    /// The world.
    pub platform: &'a dyn Platform,
    /// What its scenes have to be read from; `None` where nothing is continued.
    pub data: Option<&'a WorldData>,
}

/// Makes an item's instructions.
///
/// # Errors
/// When its path does not fit the world, the world is not the one that the run was begun in, nothing can be seen along it, or a model gives nothing.
pub fn make(
    item: &Item,
    settings: &Settings,
    world: RunWorld<'_>,
    team: &Team,
    styles: &[Measured],
) -> Result<Made, Error> {
    let RunWorld { platform, data } = world;
    let world = Remembering::new(platform);
    let path = path(item, settings, &world)?;
    if let Some(data) = data {
        data.check(platform, &path.scene)?;
    }
    let observations = observe(&world, &path, settings.frames, team.minds())?;
    let walk = Walk::new(path, observations);
    let evidence = evidence(&walk, &world, settings.evidence)?;
    let outcomes = styles.iter().map(|Measured { style, profile }| {
        let order =
            Order { walk: &walk, evidence: &evidence, style, profile, seed: settings.seed, repairs: settings.repairs };
        write_and_repair(team.writers(), team.minds(), order)
    });
    let outcomes = outcomes.collect::<Result<_, _>>()?;
    let pictures = pictures::encode(&ahead(&world, &walk.path)?)?;
    Ok(Made { walk, outcomes, pictures })
}

/// The path of an item, with its target as the settings want it.
///
/// # Errors
/// When it does not fit the world.
pub fn path(item: &Item, settings: &Settings, world: &Remembering<'_>) -> Result<Path, Error> {
    let mut path = item.path(settings, world)?;
    if settings.target == TargetMode::Free {
        path.target = None;
    }
    if let (Some(target), Some(last)) = (&mut path.target, path.frames.last()) {
        let around = look_around(world, &path.scene, last)?;
        distinguish(target, last, &around);
    }
    Ok(path)
}

/// What labels tell of all that is around each frame: ahead, right, behind, left; ahead alone where no frame has a pose.
/// Pictures may be left out.
///
/// # Errors
/// When a view cannot be had.
pub fn panoramas(platform: &dyn Platform, path: &Path) -> Result<Vec<Vec<View>>, PlatformError> {
    let ahead = |frame: &Frame| platform.look_without_picture(&path.scene, frame, Gaze::quarter(frame.pose.heading));
    let views = |frame: &Frame| match path.motion {
        Motion::Known => look_around(platform, &path.scene, frame),
        Motion::Unknown => ahead(frame).map(|view| vec![view]),
    };
    path.frames.iter().map(views).collect()
}

fn look_around(platform: &dyn Platform, scene: &SceneId, frame: &Frame) -> Result<Vec<View>, PlatformError> {
    Gaze::around(frame.pose.heading).map(|gaze| platform.look_without_picture(scene, frame, gaze)).into_iter().collect()
}

/// What is ahead of each frame.
fn ahead(platform: &dyn Platform, path: &Path) -> Result<Vec<View>, PlatformError> {
    let look = |frame: &Frame| platform.look(&path.scene, frame, Gaze::quarter(frame.pose.heading));
    path.frames.iter().map(look).collect()
}

/// What texts are held against: labels where they are wanted and there are any, else captions, else the path alone.
fn evidence(walk: &Walk, platform: &dyn Platform, against: Against) -> Result<Evidence, PlatformError> {
    let labels = match against {
        Against::Labels => Evidence::from_labels(&walk.path, &panoramas(platform, &walk.path)?),
        // Looking around takes longer than all the rest.
        Against::Captions => None,
    };
    Ok(labels.or_else(|| walk.evidence()).unwrap_or_else(|| Evidence::of_path_alone(&walk.path)))
}
