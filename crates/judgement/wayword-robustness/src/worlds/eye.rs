//! A scripted eye in place of a vision model: it reports the true labels of the same pose, but with a given recall and a given share of
//! mistakes. So experiments can show how an observer of known quality affects the texts.

mod draws;
mod sides;

use draws::EyeDraws;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
    sync::Arc,
};
use wayword_core::{
    Frame, GroundTruth, Image, ObjectId, ObjectLabel, Path, PathRequest, PlacedObject, Platform, PlatformError,
    SceneCatalogue, SceneFiles, SceneId, View, ViewGaze, ViewpointGraph, ViewpointId,
};

/// How good a scripted eye is, as a function of the strength of a change ([`Change::dose_strength`](crate::Change::dose_strength)): 0
/// without a change, 1 at the end of the dose's range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EyeQuality {
    /// Share of the labels that it reports at strength 0.
    pub recall: f64,
    /// Share of the reported labels that get a wrong name at strength 0.
    pub mistakes: f64,
    /// Share of its recall that is lost at strength 1.
    pub falls: f64,
    /// Share of mistakes that is added at strength 1.
    pub rises: f64,
    /// Whether it guesses at random on which side a thing lies.
    pub guesses_sides: bool,
}

/// A platform with the labels that a scripted eye reports.
///
/// Pictures, graph, paths and poses come from `pictures`, which can be any platform. The true labels and rooms come from `oracle`,
/// which has to know them at the same poses. For each label the eye draws whether it reports it, whether it gives a wrong name, and, if
/// it guesses sides, whether the thing lies left or right. `lists_everything` is the oracle's: the eye does not know what it missed.
///
/// The draws depend on the seed, the scene, the object and the horizontal distance to it, which differs from frame to frame. None of
/// these change when the world is mirrored or turned, the eye raised or its view widened, so the eye's errors stay the same. A label
/// is reported if its number is below the recall, so an eye with lower recall reports a subset.
///
/// A change of the world has to wrap both `pictures` and `oracle`. If it wrapped the eye, a mirror would also mirror the eye's
/// guesses, and so hide that they are guesses.
#[derive(Debug, Clone)]
pub struct ScriptedEye<P, O> {
    pictures: P,
    oracle: O,
    eye: EyeQuality,
    strength: f64,
    seed: u64,
    oracle_scene_of: BTreeMap<SceneId, SceneId>,
}

impl EyeQuality {
    /// An eye that reports all labels and makes no mistakes, at any strength.
    pub const PERFECT: Self = Self { recall: 1.0, mistakes: 0.0, falls: 0.0, rises: 0.0, guesses_sides: false };

    /// Its recall at a strength: `recall * (1 - falls * strength)`, limited to 0 to 1.
    #[must_use]
    pub fn recall_at(&self, strength: f64) -> f64 {
        (self.recall * (1.0 - self.falls * strength)).clamp(0.0, 1.0)
    }

    /// Its share of mistakes at a strength: `mistakes + rises * strength`, limited to 0 to 1.
    #[must_use]
    pub fn mistakes_at(&self, strength: f64) -> f64 {
        (self.mistakes + self.rises * strength).clamp(0.0, 1.0)
    }
}

impl<P: Platform, O: Platform> ScriptedEye<P, O> {
    /// An eye at strength 0. The oracle has the scenes of `pictures` under the same names.
    pub fn new(pictures: P, oracle: O, eye: EyeQuality, seed: u64) -> Self {
        Self { pictures, oracle, eye, strength: 0.0, seed, oracle_scene_of: BTreeMap::new() }
    }

    /// The eye for a change of this strength.
    #[must_use]
    pub fn at_strength(self, strength: f64) -> Self {
        Self { strength, ..self }
    }

    /// The eye, if a scene of `pictures` has another name at the oracle, as a recording of a house has.
    #[must_use]
    pub fn with_scene(mut self, of_pictures: SceneId, of_oracle: SceneId) -> Self {
        self.oracle_scene_of.insert(of_pictures, of_oracle);
        self
    }

    /// Makes the eye's view from `picture_view`, which is the view of `pictures`; `look` asks the oracle. A blank view stays as it is:
    /// no camera looked there.
    fn eye_view(
        &self,
        scene: &SceneId,
        from: &Frame,
        picture_view: View,
        look: impl Fn(&SceneId, ViewGaze) -> Result<View, PlatformError>,
    ) -> Result<View, PlatformError> {
        if picture_view.is_blank() {
            return Ok(picture_view);
        }
        let scene = self.oracle_scene_of.get(scene).unwrap_or(scene);
        let gaze = ViewGaze { heading: picture_view.pose.heading, horizontal_fov_rad: picture_view.horizontal_fov_rad };
        let oracle_view = look(scene, gaze)?;
        let Some(truth) = oracle_view.ground_truth().cloned() else {
            return Ok(View::new(picture_view.pose, picture_view.horizontal_fov_rad, picture_view.image, None));
        };
        let draws = EyeDraws { seed: self.seed, scene, viewpoint: from.viewpoint.as_ref() };
        let labels = if self.eye.guesses_sides {
            sides::guess_sides(&draws, from, gaze, &oracle_view, |gaze| look(scene, gaze))?
        } else {
            truth.labels
        };
        let labels = labels.into_iter().filter_map(|label| self.answer_label(&draws, label));
        let labels =
            drop_unfitting_boxes(labels.collect(), oracle_view.image.as_deref(), picture_view.image.as_deref());
        let truth = GroundTruth { labels, ..truth };
        Ok(View::new(picture_view.pose, picture_view.horizontal_fov_rad, picture_view.image, Some(truth)))
    }

    /// The label that the eye reports; `None` if it misses it.
    fn answer_label(&self, draws: &EyeDraws<'_>, label: ObjectLabel) -> Option<ObjectLabel> {
        if draws.draw_for_label("seen", &label) >= self.eye.recall_at(self.strength) {
            return None;
        }
        let is_mistaken = draws.draw_for_label("mistaken", &label) < self.eye.mistakes_at(self.strength);
        let name = if is_mistaken { draws.wrong_name(&label).to_owned() } else { label.name };
        Some(ObjectLabel { name, ..label })
    }
}

/// Removes the boxes of the labels if the picture has another size than the oracle's, because then they do not fit.
fn drop_unfitting_boxes(
    mut labels: Vec<ObjectLabel>,
    known: Option<&Image>,
    shown: Option<&Image>,
) -> Vec<ObjectLabel> {
    let size = |image: &Image| [image.width_px(), image.height_px()];
    if let (Some(known), Some(shown)) = (known, shown)
        && size(known) != size(shown)
    {
        labels.iter_mut().for_each(|label| label.box_px = None);
    }
    labels
}

impl<P: Platform, O: Platform> Platform for ScriptedEye<P, O> {
    fn name(&self) -> &'static str {
        self.pictures.name()
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        self.pictures.list_scenes()
    }

    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        self.pictures.graph_for_scene(scene)
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        self.pictures.sample_path(scene, request, seed)
    }

    fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        let shown = self.pictures.look_from(scene, from, gaze)?;
        self.eye_view(scene, from, shown, |scene, gaze| self.oracle.look_from(scene, from, gaze))
    }

    /// The picture is still needed, because only a blank picture shows that no camera looked there.
    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        let shown = self.pictures.look_from(scene, from, gaze)?;
        let mut view =
            self.eye_view(scene, from, shown, |scene, gaze| self.oracle.look_without_picture(scene, from, gaze))?;
        view.image = None;
        Ok(view)
    }

    fn inner(&self) -> Option<&dyn Platform> {
        Some(&self.pictures)
    }

    fn catalogue(&self) -> &dyn SceneCatalogue {
        self
    }

    fn files(&self) -> &dyn SceneFiles {
        self
    }
}

impl<P: Platform, O: Platform> SceneCatalogue for ScriptedEye<P, O> {
    fn object_name(&self, scene: &SceneId, near: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError> {
        self.pictures.catalogue().object_name(scene, near, object)
    }

    fn visible_from(&self, scene: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        self.pictures.catalogue().visible_from(scene, object)
    }

    fn listed_objects(&self, scene: &SceneId) -> Result<Vec<PlacedObject>, PlatformError> {
        self.pictures.catalogue().listed_objects(scene)
    }

    fn lists_everything(&self) -> bool {
        self.oracle.catalogue().lists_everything()
    }
}

/// `candidate_scenes` and `examine_scene` keep their defaults, because the files of the pictures do not show which labels and rooms the
/// oracle knows.
impl<P: Platform, O: Platform> SceneFiles for ScriptedEye<P, O> {
    fn check_scenes(&self, scenes: &BTreeSet<&SceneId>) -> Result<(), PlatformError> {
        self.pictures.files().check_scenes(scenes)
    }

    fn canonical_scene(&self, scene: &SceneId) -> SceneId {
        self.pictures.files().canonical_scene(scene)
    }

    fn scene_file(&self, scene: &SceneId) -> Result<Option<PathBuf>, PlatformError> {
        self.pictures.files().scene_file(scene)
    }

    fn source_files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        self.pictures.files().source_files(scene)
    }
}

#[cfg(test)]
mod tests;
