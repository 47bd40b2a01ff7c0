//! Makes one item: from its path to checked instructions.

use crate::{
    error::Error,
    follow::{Followed, GOES_UNKNOWN, KnownScenes, Told, rejection},
    item::Item,
    pictures::{self, Picture},
    platforms::Remembering,
    run::WorldData,
    settings::{Against, Settings, TargetMode},
    styles::Measured,
    team::Team,
};
use wayword_checks::{Checked, Evidence, Memory, Source};
use wayword_core::{Ambiguity, Frame, Gaze, Motion, Path, Platform, PlatformError, SceneId, View};
use wayword_synthesis::{
    observe::observe,
    offline::distinguish,
    repair::{Follow, Order, Outcome, write_and_repair},
    walk::Walk,
};

/// The result of an item.
#[derive(Debug)]
pub struct Made {
    /// The path and what was seen along it.
    pub walk: Walk,
    /// One per style, in the order of the run's styles.
    pub outcomes: Vec<Outcome>,
    /// The picture ahead of each frame, if the platform has pictures.
    pub pictures: Vec<Picture>,
}

/// The platform of a run, with the state of its files.
#[derive(Clone, Copy)]
pub struct RunPlatform<'a> {
    /// The platform.
    pub platform: &'a dyn Platform,
    /// The state that the files of its scenes must have; `None` if no run is continued.
    pub data: Option<&'a WorldData>,
    /// What is known around its paths.
    pub scenes: &'a KnownScenes,
}

/// Makes an item's instructions.
///
/// # Errors
/// When its path does not fit its scene, the files of the scene have changed since the run began, a view cannot be had, or a model
/// gives no answer.
pub fn make(
    item: &Item,
    settings: &Settings,
    world: RunPlatform<'_>,
    team: &Team,
    styles: &[Measured],
) -> Result<Made, Error> {
    let RunPlatform { platform, data, scenes } = world;
    let world = Remembering::new(platform);
    let path = path(item, settings, &world)?;
    if let Some(data) = data {
        data.check(platform, &path.scene)?;
    }
    let observations = observe(&world, &path, settings.frames, team.observers())?;
    let walk = Walk::new(path, observations);
    let evidence = evidence(&walk, &world, settings.evidence)?;
    // Where labels see, the writer remembers all that they list around each frame; a model's captions else.
    let sees_labels = team.observers().answerer.name() == "labels" && evidence.source == Source::Labels;
    let memory = if sees_labels { Memory::of(&evidence, &walk.path) } else { walk.memory() };
    let scene = match settings.no_route || evidence.source != Source::Labels {
        true => None,
        false => Some(scenes.get(platform, &walk.path.scene)?),
    };
    let followed = match scene.as_deref() {
        None if evidence.motion.is_known() => Err("the texts are not checked against labels"),
        None => Err(GOES_UNKNOWN),
        scene => Followed::new(scene, &walk.path, &evidence),
    };
    let follower = Follower { followed, evidence: &evidence, rejects_ambiguous: settings.reject_ambiguous };
    let outcomes = styles.iter().map(|Measured { style, profile }| {
        let order = Order {
            walk: &walk,
            memory: &memory,
            evidence: &evidence,
            style,
            profile,
            seed: settings.seed,
            repairs: settings.repairs,
            candidates: settings.candidates,
            follower: (!settings.no_route).then_some(&follower),
        };
        write_and_repair(team.writers(), team.observers(), order)
    });
    let outcomes = outcomes.collect::<Result<_, _>>()?;
    let pictures = pictures::encode(&ahead(&world, &walk.path)?)?;
    Ok(Made { walk, outcomes, pictures })
}

/// Follows the texts of one path.
struct Follower<'a> {
    /// The path, or why it cannot be followed.
    followed: Result<Followed<'a>, &'static str>,
    evidence: &'a Evidence,
    rejects_ambiguous: bool,
}

impl Follow for Follower<'_> {
    fn follow(&self, text: &str, checked: &mut Checked) -> Ambiguity {
        let told = match &self.followed {
            Ok(followed) => followed.route(text),
            Err(why) => Told::unknown(why),
        };
        told.add_to(checked);
        let ambiguity = told.ambiguity(text, self.evidence);
        checked.add(rejection(&ambiguity).filter(|_| self.rejects_ambiguous));
        ambiguity
    }

    fn leads_there(&self, text: &str) -> Option<f64> {
        self.followed.as_ref().ok()?.leads_there(text)
    }
}

/// The path of an item. Its target is removed if the settings leave the choice to the writer.
///
/// # Errors
/// When it does not fit its scene.
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

/// The views around each frame: ahead, right, behind, left; only ahead if the motion is unknown. Pictures may be missing.
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

/// The view ahead of each frame.
fn ahead(platform: &dyn Platform, path: &Path) -> Result<Vec<View>, PlatformError> {
    let look = |frame: &Frame| platform.look(&path.scene, frame, Gaze::quarter(frame.pose.heading));
    path.frames.iter().map(look).collect()
}

/// What texts are checked against: labels if they are wanted and available, else captions, else only the path.
fn evidence(walk: &Walk, platform: &dyn Platform, against: Against) -> Result<Evidence, PlatformError> {
    let labels = match against {
        Against::Labels => Evidence::from_labels(&walk.path, &panoramas(platform, &walk.path)?),
        // No labels are collected here, because that takes longer than everything else.
        Against::Captions => None,
    };
    Ok(labels.or_else(|| walk.evidence()).unwrap_or_else(|| Evidence::of_path_alone(&walk.path)))
}
