//! Opens another platform on which the texts of a run are written again at the same poses (`--change platform=`).

mod film;
#[cfg(feature = "habitat")]
mod houses;

use super::{
    base::BaseRun,
    scene_names::{self, SceneNames},
    world::ChangedWorld,
};
use std::{collections::BTreeMap, path::Path as FilePath};
use wayword_core::{Path, PathRequest, Platform, SceneId};
use wayword_robustness::OtherPlatform as Spec;
use wayword_run::{
    error::CommandError,
    platforms::{self, PLATFORMS, RememberingPlatform},
};

/// Another platform that has the scenes of a run, or recordings of its paths.
pub(super) struct OtherPlatformScenes {
    platform: Box<dyn Platform>,
    /// The platform's scene for each scene of the run. For recordings, the scene for each path by its recording's name.
    scene_of: BTreeMap<String, SceneId>,
    /// The run's scene for each scene of the platform.
    base_of: BTreeMap<SceneId, SceneId>,
    is_film: bool,
}

/// The reason why a platform cannot be used for any path; `None` if it can.
pub(super) fn platform_refusal(spec: &str) -> Option<String> {
    let Spec { name, .. } = Spec::from_spec(spec);
    match PLATFORMS.iter().find(|listed| listed.name == name) {
        Some(listed) if listed.is_here => None,
        Some(_) => Some(format!("this build has no platform {name}; build it with the feature full")),
        None => Some(format!("there is no platform {name}; `wayword platforms` lists all")),
    }
}

impl OtherPlatformScenes {
    /// Opens a platform. For `habitat` and `recording`, the run's houses or pictures are first saved under `out`, unless they are
    /// there. A scene has the same name as in the run, unless `names` gives it another.
    ///
    /// # Errors
    /// When the data cannot be saved, or the platform cannot be opened or lacks a scene of the run.
    pub(super) fn open(
        spec: &str,
        base: &BaseRun,
        world: &dyn Platform,
        (out, names): (&FilePath, &SceneNames),
    ) -> Result<Self, CommandError> {
        let Spec { name, data, address: at } = Spec::from_spec(spec);
        if name == "recording" {
            return Self::open_filmed(base, world, &out.join("films"));
        }
        let saved_houses = match data {
            None if name == "habitat" => Some(save_houses(base, &out.join("houses"))?),
            _ => None,
        };
        let data = data.map(FilePath::new).or(saved_houses.as_deref());
        let platform = platforms::open_named(name, data, at, None)?;
        let scenes_there = platform.list_scenes()?;
        let (mut scene_of, mut base_of) = (BTreeMap::new(), BTreeMap::new());
        for path in &base.paths {
            let names_there = scene_names::names_elsewhere(names, path.scene.as_str());
            let Some(scene) =
                names_there.iter().find_map(|name| scenes_there.iter().find(|scene| scene.as_str() == *name))
            else {
                let names_there = names_there.join(" or ");
                let problem =
                    format!("--change platform={spec}: it has no scene {names_there} for {} of the run", path.scene);
                let hint = "name data that has all scenes of the run, or give the name of each there, as in --scene-name house2-3=home_2";
                return Err(CommandError::usage(problem, hint));
            };
            scene_of.insert(path.scene.to_string(), scene.clone());
            base_of.insert(scene.clone(), path.scene.clone());
        }
        Ok(Self { platform, scene_of, base_of, is_film: false })
    }

    fn open_filmed(base: &BaseRun, world: &dyn Platform, folder: &FilePath) -> Result<Self, CommandError> {
        film::film_paths(base, world, folder)?;
        let platform = platforms::open_named("recording", Some(folder), None, None)?;
        let recordings = platform.list_scenes()?;
        let (mut scene_of, mut base_of) = (BTreeMap::new(), BTreeMap::new());
        for path in &base.paths {
            let name = film::recording_name(path);
            if let Some(scene) = recordings.iter().find(|scene| scene.as_str() == name) {
                scene_of.insert(name, scene.clone());
                base_of.insert(scene.clone(), path.scene.clone());
            }
        }
        Ok(Self { platform, scene_of, base_of, is_film: true })
    }

    /// The world and the path on this platform for a path of the run; the reason as an error if it is not there.
    pub(super) fn world_for_path(&self, path: &Path, sees_labels: bool) -> Result<ChangedWorld<'_>, String> {
        let key = if self.is_film { film::recording_name(path) } else { path.scene.to_string() };
        let scene = self.scene_of.get(&key).cloned().ok_or("it is not there")?;
        let path_there = if self.is_film { self.as_filmed(path, &scene)? } else { Path { scene, ..path.clone() } };
        let base_frame_of = path_there.frames.iter().map(|frame| nearest_frame(path, frame)).collect();
        let platform: Box<dyn Platform + '_> = match sees_labels {
            true => Box::new(RememberingPlatform::for_labels(self.platform.as_ref())),
            false => Box::new(self.platform.as_ref()),
        };
        Ok(ChangedWorld { platform, path: path_there, base_frame_of })
    }

    /// The scene of the run that a scene of this platform corresponds to.
    pub(super) fn base_scene(&self, scene: &SceneId) -> Option<&SceneId> {
        self.base_of.get(scene)
    }

    /// The path of a recording, under the id and with the target of the run's path.
    fn as_filmed(&self, path: &Path, scene: &SceneId) -> Result<Path, String> {
        let whole_recording = PathRequest { hops: 1..=usize::MAX, length_m: 0.0..=f64::MAX };
        let recorded = self.platform.sample_path(scene, &whole_recording, 0).map_err(|error| error.to_string())?;
        Ok(Path { id: path.id.clone(), target: path.target.clone(), ..recorded })
    }
}

/// The index of the frame of a path that is nearest to the position of another frame.
fn nearest_frame(path: &Path, frame: &wayword_core::Frame) -> usize {
    let off_m = |at: &usize| path.frames[*at].pose.position.distance(frame.pose.position);
    (0..path.frames.len()).min_by(|a, b| off_m(a).total_cmp(&off_m(b))).unwrap_or(0)
}

#[cfg(feature = "habitat")]
use houses::save_houses;

#[cfg(not(feature = "habitat"))]
fn save_houses(_: &BaseRun, _: &FilePath) -> Result<std::path::PathBuf, CommandError> {
    Err(CommandError::not_built("this build has no platform habitat".to_owned()))
}
