//! What is visible, told from the pixels of the semantic picture.

use super::{Semantics, Thing};
use wayword_core::{DVec3, Gaze, Heading, Label};
use wayword_render::{Camera, RenderError, Visible, visible_objects};

/// An object counts from this share of the picture's pixels on: at 640 x 480, a patch of 21 x 21.
const LEAST_SHARE: f64 = 0.0015;
/// And if the box of its pixels covers at least this share of its own, as far as that lies within the picture.
const LEAST_SHOWN: f64 = 0.22;

impl Semantics {
    /// Labels of what is visible, the largest first: what has a name and its box's middle within the gaze. What is hidden does not
    /// count, nor what only a sliver is seen of.
    pub(crate) fn labels(&self, camera: &Camera, gaze: Gaze) -> Result<Vec<Label>, RenderError> {
        let picture = self.picture(camera)?;
        let least = f64::from(picture.width) * f64::from(picture.height) * LEAST_SHARE;
        let mut seen: Vec<Visible> =
            visible_objects(&picture).into_iter().filter(|each| f64::from(each.pixels) >= least).collect();
        seen.sort_by_key(|each| (std::cmp::Reverse(each.pixels), each.id));
        let told = seen.iter().filter_map(|each| label(camera, each, self.thing(each.id)?));
        Ok(told.filter(|label| gaze.holds(label.heading)).collect())
    }
}

fn label(camera: &Camera, seen: &Visible, thing: &Thing) -> Option<Label> {
    let (name, (low, high)) = (thing.name.as_ref()?, thing.bounds?);
    if shown(camera, low, high, seen).is_some_and(|share| share < LEAST_SHOWN) {
        return None;
    }
    let centre = (low + high) / 2.0;
    let offset = centre - camera.position;
    let level_m = libm::sqrt(offset.x * offset.x + offset.y * offset.y);
    Some(Label {
        object: thing.id.clone(),
        name: name.clone(),
        heading: Heading::new(libm::atan2(offset.x, offset.y)).ok()?,
        elevation_rad: libm::atan2(offset.z, level_m),
        box_px: Some(seen.bbox.map(f64::from)),
        distance_m: Some(offset.length()),
        position: Some(centre),
        colour: None,
    })
}

/// Share of a box, as far as it lies in the picture, that the box of the visible pixels covers. None where it reaches behind
/// the eye.
fn shown(camera: &Camera, low: DVec3, high: DVec3, seen: &Visible) -> Option<f64> {
    let corner =
        |n: usize| DVec3::new([low.x, high.x][n & 1], [low.y, high.y][n >> 1 & 1], [low.z, high.z][n >> 2 & 1]);
    let corners = (0..8).map(|n| camera.project(corner(n))).collect::<Option<Vec<_>>>()?;
    let side = |values: &mut dyn Iterator<Item = f64>, end: u32| {
        let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
        (high.min(f64::from(end)) - low.max(0.0)).max(1.0)
    };
    let width = side(&mut corners.iter().map(|(x, _, _)| *x), camera.width);
    let height = side(&mut corners.iter().map(|(_, y, _)| *y), camera.height);
    Some(f64::from(seen.bbox[2]) * f64::from(seen.bbox[3]) / (width * height))
}
