//! Finds the objects and the room that a camera sees. The scene's semantic mesh is drawn, and the pixels show the objects.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

mod broken_lines;
mod hm3d;
mod house;
mod labels;
mod load;
mod paint;
mod ply;
#[allow(
    clippy::indexing_slicing,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    reason = "it computes with places, and reads no file"
)]
mod rooms;
#[cfg(test)]
mod tests;

pub(crate) use load::{SemanticFiles, SemanticFindings, check_semantics, load_semantics};

use rooms::{NumberedRooms, ShellPart};
use std::collections::BTreeMap;
use wayword_core::{DVec3, Heading, ObjectId, SceneLack};
use wayword_render::{PinholeCamera, RenderError, RenderScene, RenderedPicture, render_ids, render_scene};
use wayword_world::{object_names, region_letters};

/// An object of a scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SemanticThing {
    pub(crate) id: ObjectId,
    /// In plain words; `None` for parts of the building and for objects that the annotators could not name.
    pub(crate) name: Option<String>,
    /// The box around its triangles, metres; `None` if it has no triangles.
    bounds: Option<(DVec3, DVec3)>,
    /// The number of its room, where rooms are numbered and not named.
    room: Option<u32>,
    /// The part of the room's shell that it is, if it is one: only those show where the room is.
    part: Option<ShellPart>,
}

impl SemanticThing {
    fn new(id: ObjectId, raw: &str) -> Self {
        let plain = object_names::plain_name(raw);
        let part = plain.as_deref().and_then(rooms::shell_part);
        let name = plain.filter(|name| object_names::is_furnishing(name));
        Self { id, name, bounds: None, room: None, part }
    }

    /// Extends the box to contain a place.
    fn include_place(&mut self, place: DVec3) {
        let (low, high) = self.bounds.unwrap_or((place, place));
        self.bounds = Some((low.min(place), high.max(place)));
    }
}

/// A room of Matterport3D: a box, and the letter of its kind in Matterport3D's files.
#[derive(Clone, Debug, PartialEq)]
struct HouseRegion {
    low: DVec3,
    high: DVec3,
    letter: char,
}

/// A scene in which each surface belongs to an object.
#[derive(Debug)]
pub(crate) struct SceneSemantics {
    scene: RenderScene,
    /// Index of the thing of each colour, if surfaces are painted.
    by_colour: BTreeMap<[u8; 3], usize>,
    things: Vec<SemanticThing>,
    regions: Vec<HouseRegion>,
    /// The rooms, where they are numbered.
    rooms: NumberedRooms,
    /// Whether any surface is known to belong to an object.
    pub(crate) has_labels: bool,
    /// Whether so many are known that an object which is not seen is not there.
    pub(crate) lists_objects: bool,
    /// The warning about lines of its list that cannot be read.
    pub(crate) broken_lines: Option<String>,
    /// The fault in its colours.
    pub(crate) lack: Option<SceneLack>,
}

impl SceneSemantics {
    /// Draws the scene with the indices of things plus 1 as ids; 0 means no thing.
    fn draw_ids(&self, camera: &PinholeCamera) -> Result<RenderedPicture, RenderError> {
        if self.by_colour.is_empty() {
            return render_ids(&self.scene, camera);
        }
        let mut picture = render_scene(&self.scene, camera)?;
        let painted = picture.rgb.as_chunks::<3>().0;
        for (id, colour) in picture.ids.iter_mut().zip(painted).filter(|(id, _)| **id == load::PAINTED_ID) {
            *id = load::picture_id(self.by_colour.get(colour).copied());
        }
        Ok(picture)
    }

    /// The thing with an id of the drawn picture.
    fn thing_with_id(&self, id: u32) -> Option<&SemanticThing> {
        self.things.get((id as usize).checked_sub(1)?)
    }

    /// The object with this id.
    pub(crate) fn find_thing(&self, object: &ObjectId) -> Option<&SemanticThing> {
        self.things.iter().find(|thing| thing.id == *object)
    }

    /// The word for the room that an eye sees. Of several boxes around the eye the smallest counts. Where rooms are only
    /// numbered, the word follows from the things in the room, and in an opening from those in the room ahead.
    pub(crate) fn room_at(&self, eye: DVec3, heading: Heading) -> Option<&'static str> {
        let holds = |region: &&HouseRegion| region.low.cmple(eye).all() && region.high.cmpge(eye).all();
        let size = |region: &HouseRegion| (region.high - region.low).element_product();
        match self.regions.iter().filter(holds).min_by(|a, b| size(a).total_cmp(&size(b))) {
            Some(inside) => region_letters::room_for_letter(inside.letter),
            None => self.rooms.room_in_view(eye, heading),
        }
    }
}
