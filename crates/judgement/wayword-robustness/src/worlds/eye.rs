//! A scripted eye: it answers from what is known at the same pose, and is as good as it is told to be.

mod draws;
mod sides;

use draws::Draws;
use std::{
    collections::{BTreeMap, BTreeSet},
    path::PathBuf,
    sync::Arc,
};
use wayword_core::{
    Depth, Frame, FromAbove, Gaze, GroundTruth, Image, Island, Label, ObjectId, Path, PathRequest, Placed, Platform,
    PlatformError, SceneId, View, ViewpointGraph, ViewpointId, Way,
};

/// How good a scripted eye is. A strength is that of a change ([`Change::strength`](crate::Change::strength)): 0 where
/// nothing is changed, 1 at the end of the dose's range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EyeOf {
    /// Share of the labels that it sees at strength 0.
    pub recall: f64,
    /// Share of the labels that it sees and calls by another name, at strength 0.
    pub mistakes: f64,
    /// Share of its recall that is lost at strength 1.
    pub falls: f64,
    /// What is added to its mistakes at strength 1.
    pub rises: f64,
    /// Whether it draws the side on which a thing lies instead of seeing it.
    pub guesses_sides: bool,
}

/// A platform whose labels are what a scripted eye answers.
///
/// Pictures, graph, paths and poses are those of `pictures`, any platform. The eye gets the labels and the room of
/// `oracle`, which knows what is at the same pose. Of each label it draws whether it is seen, whether it is called by
/// another name, and where the eye guesses sides, whether it lies left or right. `lists_objects` stays the oracle's:
/// the eye does not know what it missed.
///
/// The draws are by the seed, the scene, the object and the distance over the ground, which differs from frame to
/// frame. None of that changes where the world is mirrored or turned, the eye raised or its view widened. A label is
/// seen when its number is below the recall, so an eye of lower recall sees a subset.
///
/// A change of the world goes inside, around both `pictures` and `oracle`. Around the eye, a mirror would mirror its
/// guesses too, and so hide that they are guesses.
#[derive(Debug, Clone)]
pub struct ScriptedEye<P, O> {
    pictures: P,
    oracle: O,
    eye: EyeOf,
    strength: f64,
    seed: u64,
    oracle_scene_of: BTreeMap<SceneId, SceneId>,
}

impl EyeOf {
    /// An eye that misses nothing and makes no mistakes, at any strength.
    pub const PERFECT: Self = Self { recall: 1.0, mistakes: 0.0, falls: 0.0, rises: 0.0, guesses_sides: false };

    /// Its recall: `recall * (1 - falls * strength)`, kept within 0 and 1.
    #[must_use]
    pub fn recall_at(&self, strength: f64) -> f64 {
        (self.recall * (1.0 - self.falls * strength)).clamp(0.0, 1.0)
    }

    /// Its share of mistakes: `mistakes + rises * strength`, kept within 0 and 1.
    #[must_use]
    pub fn mistakes_at(&self, strength: f64) -> f64 {
        (self.mistakes + self.rises * strength).clamp(0.0, 1.0)
    }
}

impl<P: Platform, O: Platform> ScriptedEye<P, O> {
    /// An eye at strength 0. The oracle has the scenes of `pictures` under the same names.
    pub fn new(pictures: P, oracle: O, eye: EyeOf, seed: u64) -> Self {
        Self { pictures, oracle, eye, strength: 0.0, seed, oracle_scene_of: BTreeMap::new() }
    }

    /// The eye for a change of this strength.
    #[must_use]
    pub fn at(self, strength: f64) -> Self {
        Self { strength, ..self }
    }

    /// The eye where a scene of `pictures` has another name at the oracle, as a recording of a house has.
    #[must_use]
    pub fn with_scene(mut self, of_pictures: SceneId, of_oracle: SceneId) -> Self {
        self.oracle_scene_of.insert(of_pictures, of_oracle);
        self
    }

    /// What the eye makes of what `pictures` shows; `look` asks the oracle. Where no camera looked it sees nothing.
    fn seen(
        &self,
        scene: &SceneId,
        from: &Frame,
        shown: View,
        look: impl Fn(&SceneId, Gaze) -> Result<View, PlatformError>,
    ) -> Result<View, PlatformError> {
        if shown.is_blank() {
            return Ok(shown);
        }
        let scene = self.oracle_scene_of.get(scene).unwrap_or(scene);
        let gaze = Gaze { heading: shown.pose.heading, horizontal_fov_rad: shown.horizontal_fov_rad };
        let known = look(scene, gaze)?;
        let Some(truth) = known.ground_truth().cloned() else {
            return Ok(View::new(shown.pose, shown.horizontal_fov_rad, shown.image, None));
        };
        let draws = Draws { seed: self.seed, scene, viewpoint: from.viewpoint.as_ref() };
        let labels = if self.eye.guesses_sides {
            sides::guessed(&draws, from, gaze, &known, |gaze| look(scene, gaze))?
        } else {
            truth.labels
        };
        let labels = labels.into_iter().filter_map(|label| self.answered(&draws, label));
        let labels = fitting(labels.collect(), known.image.as_deref(), shown.image.as_deref());
        let truth = GroundTruth { labels, ..truth };
        Ok(View::new(shown.pose, shown.horizontal_fov_rad, shown.image, Some(truth)))
    }

    /// A label as the eye gives it; `None` where it misses it.
    fn answered(&self, draws: &Draws<'_>, label: Label) -> Option<Label> {
        if draws.uniform("seen", &label) >= self.eye.recall_at(self.strength) {
            return None;
        }
        let is_mistaken = draws.uniform("mistaken", &label) < self.eye.mistakes_at(self.strength);
        let name = if is_mistaken { draws.wrong_name(&label).to_owned() } else { label.name };
        Some(Label { name, ..label })
    }
}

/// Labels whose boxes fit the picture: in a picture of another size than the oracle's they have no place.
fn fitting(mut labels: Vec<Label>, known: Option<&Image>, shown: Option<&Image>) -> Vec<Label> {
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

    fn scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        self.pictures.scenes()
    }

    fn check(&self, scenes: &BTreeSet<&SceneId>) -> Result<(), PlatformError> {
        self.pictures.check(scenes)
    }

    fn graph(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        self.pictures.graph(scene)
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        self.pictures.sample_path(scene, request, seed)
    }

    fn look(&self, scene: &SceneId, from: &Frame, gaze: Gaze) -> Result<View, PlatformError> {
        let shown = self.pictures.look(scene, from, gaze)?;
        self.seen(scene, from, shown, |scene, gaze| self.oracle.look(scene, from, gaze))
    }

    /// The picture is asked for all the same, because it alone tells whether a camera looked.
    fn look_without_picture(&self, scene: &SceneId, from: &Frame, gaze: Gaze) -> Result<View, PlatformError> {
        let shown = self.pictures.look(scene, from, gaze)?;
        let mut view =
            self.seen(scene, from, shown, |scene, gaze| self.oracle.look_without_picture(scene, from, gaze))?;
        view.image = None;
        Ok(view)
    }

    fn depth(&self, scene: &SceneId, from: &Frame, gaze: Gaze) -> Result<Option<Depth>, PlatformError> {
        self.pictures.depth(scene, from, gaze)
    }

    fn look_down(&self, scene: &SceneId, level: u32) -> Result<Option<FromAbove>, PlatformError> {
        self.pictures.look_down(scene, level)
    }

    fn object_name(&self, scene: &SceneId, near: &Frame, object: &ObjectId) -> Result<Option<String>, PlatformError> {
        self.pictures.object_name(scene, near, object)
    }

    fn visible_from(&self, scene: &SceneId, object: &ObjectId) -> Result<Option<BTreeSet<ViewpointId>>, PlatformError> {
        self.pictures.visible_from(scene, object)
    }

    fn way(&self, scene: &SceneId, from: &Frame, to: &Frame) -> Result<Option<Way>, PlatformError> {
        self.pictures.way(scene, from, to)
    }

    fn islands(&self, scene: &SceneId) -> Result<Vec<Island>, PlatformError> {
        self.pictures.islands(scene)
    }

    fn listed_objects(&self, scene: &SceneId) -> Result<Vec<Placed>, PlatformError> {
        self.pictures.listed_objects(scene)
    }

    fn lists_everything(&self) -> bool {
        self.oracle.lists_everything()
    }

    fn scene_file(&self, scene: &SceneId) -> Result<Option<PathBuf>, PlatformError> {
        self.pictures.scene_file(scene)
    }

    fn files(&self, scene: &SceneId) -> Result<Vec<PathBuf>, PlatformError> {
        self.pictures.files(scene)
    }
}

#[cfg(test)]
mod tests;
