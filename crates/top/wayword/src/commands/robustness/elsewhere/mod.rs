//! The poses of a run on another platform.

mod film;
#[cfg(feature = "habitat")]
mod houses;

use super::{
    base::Base,
    names::{self, Names},
    world::World,
};
use crate::{
    error::Error,
    platforms::{self, PLATFORMS, Remembering},
};
use std::{collections::BTreeMap, path::Path as FilePath};
use wayword_core::{Path, PathRequest, Platform, SceneId};
use wayword_robustness::Elsewhere as Spec;

/// Another platform that has the scenes of a run, or its paths.
pub(super) struct Elsewhere {
    platform: Box<dyn Platform>,
    /// Its scene for each scene of the run, or, of films, for each path.
    scene_of: BTreeMap<String, SceneId>,
    /// The run's scene for each of its scenes.
    base_of: BTreeMap<SceneId, SceneId>,
    is_film: bool,
}

/// Why a platform cannot be gone to, whatever the path; `None` where it can.
pub(super) fn refusal(spec: &str) -> Option<String> {
    let Spec { name, .. } = Spec::of(spec);
    match PLATFORMS.iter().find(|listed| listed.name == name) {
        Some(listed) if listed.is_here => None,
        Some(_) => Some(format!("this build has no platform {name}; build it with the feature full")),
        None => Some(format!("there is no platform {name}; `wayword platforms` lists all")),
    }
}

impl Elsewhere {
    /// Opens a platform. What it needs of the run is saved in a folder first, unless it is there. Its scenes have the names
    /// of the run's scenes, but where they are given other ones.
    ///
    /// # Errors
    /// When that cannot be saved or opened, or it lacks a scene of the run.
    pub(super) fn open(
        spec: &str,
        base: &Base,
        world: &dyn Platform,
        (out, names): (&FilePath, &Names),
    ) -> Result<Self, Error> {
        let Spec { name, data, at } = Spec::of(spec);
        if name == "recording" {
            return Self::filmed(base, world, &out.join("films"));
        }
        let made = match data {
            None if name == "habitat" => Some(saved(base, &out.join("houses"))?),
            _ => None,
        };
        let data = data.map(FilePath::new).or(made.as_deref());
        let platform = platforms::open_named(name, data, at, None)?;
        let there = platform.scenes()?;
        let (mut scene_of, mut base_of) = (BTreeMap::new(), BTreeMap::new());
        for path in &base.paths {
            let called = names::called(names, path.scene.as_str());
            let Some(scene) = called.iter().find_map(|name| there.iter().find(|scene| scene.as_str() == *name)) else {
                let called = called.join(" or ");
                let problem =
                    format!("--change platform={spec}: it has no scene {called} for {} of the run", path.scene);
                let hint = "name data that has all scenes of the run, or give the name of each there, as in --scene-name house2-3=home_2";
                return Err(Error::usage(problem, hint));
            };
            scene_of.insert(path.scene.to_string(), scene.clone());
            base_of.insert(scene.clone(), path.scene.clone());
        }
        Ok(Self { platform, scene_of, base_of, is_film: false })
    }

    fn filmed(base: &Base, world: &dyn Platform, folder: &FilePath) -> Result<Self, Error> {
        film::make(base, world, folder)?;
        let platform = platforms::open_named("recording", Some(folder), None, None)?;
        let there = platform.scenes()?;
        let (mut scene_of, mut base_of) = (BTreeMap::new(), BTreeMap::new());
        for path in &base.paths {
            let name = film::name(path);
            if let Some(scene) = there.iter().find(|scene| scene.as_str() == name) {
                scene_of.insert(name, scene.clone());
                base_of.insert(scene.clone(), path.scene.clone());
            }
        }
        Ok(Self { platform, scene_of, base_of, is_film: true })
    }

    /// The world of a path there; an error, with the reason, where it has none.
    pub(super) fn world(&self, path: &Path, sees_labels: bool) -> Result<World<'_>, String> {
        let key = if self.is_film { film::name(path) } else { path.scene.to_string() };
        let scene = self.scene_of.get(&key).cloned().ok_or("it is not there")?;
        let found = if self.is_film { self.as_filmed(path, &scene)? } else { Path { scene, ..path.clone() } };
        let base_frame_of = found.frames.iter().map(|frame| nearest(path, frame)).collect();
        let platform: Box<dyn Platform + '_> = match sees_labels {
            true => Box::new(Remembering::labels_of(self.platform.as_ref())),
            false => Box::new(self.platform.as_ref()),
        };
        Ok(World { platform, path: found, base_frame_of })
    }

    /// The scene of the run that a scene there is.
    pub(super) fn base_scene(&self, scene: &SceneId) -> Option<&SceneId> {
        self.base_of.get(scene)
    }

    /// A path as its recording has it.
    fn as_filmed(&self, path: &Path, scene: &SceneId) -> Result<Path, String> {
        let whole = PathRequest { hops: 1..=usize::MAX, length_m: 0.0..=f64::MAX };
        let found = self.platform.sample_path(scene, &whole, 0).map_err(|error| error.to_string())?;
        Ok(Path { id: path.id.clone(), target: path.target.clone(), ..found })
    }
}

/// The frame of a path that is nearest to a frame's place.
fn nearest(path: &Path, frame: &wayword_core::Frame) -> usize {
    let off_m = |at: &usize| path.frames[*at].pose.position.distance(frame.pose.position);
    (0..path.frames.len()).min_by(|a, b| off_m(a).total_cmp(&off_m(b))).unwrap_or(0)
}

#[cfg(feature = "habitat")]
use houses::saved;

#[cfg(not(feature = "habitat"))]
fn saved(_: &Base, _: &FilePath) -> Result<std::path::PathBuf, Error> {
    Err(Error::not_built("this build has no platform habitat".to_owned()))
}
