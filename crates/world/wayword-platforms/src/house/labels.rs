//! What is visible in a picture, told from its pixels.

use super::{
    objects::{Object, Role},
    scene::HouseScene,
};
use wayword_core::{DVec3, Gaze, Heading, Label, ObjectId};
use wayword_render::{Camera, Picture, Visible, visible_objects};

/// An object counts from this share of the picture's pixels on: at 640 x 480, a patch of 21 x 21.
const LEAST_SHARE: f64 = 0.0015;
/// And if at least this share of its box shows, as far as that lies within the picture.
const LEAST_SHOWN: f64 = 0.22;

/// Labels of what is visible, largest first: furniture, doors, windows and stairs whose box's middle lies within the gaze.
///
/// What is hidden behind something else does not count, nor what only a sliver is seen of.
pub(super) fn labels(scene: &HouseScene, camera: &Camera, gaze: Gaze, picture: &Picture) -> Vec<Label> {
    let least = f64::from(picture.width) * f64::from(picture.height) * LEAST_SHARE;
    let mut seen: Vec<Visible> =
        visible_objects(picture).into_iter().filter(|each| f64::from(each.pixels) >= least).collect();
    seen.sort_by_key(|each| (std::cmp::Reverse(each.pixels), each.id));
    let told = seen.iter().filter_map(|each| {
        let object = scene.objects.get(&each.id).filter(|object| object.role != Role::Shell)?;
        let shows = shown(camera, object, each).is_none_or(|share| share >= LEAST_SHOWN);
        shows.then(|| label(camera, each, object)).flatten()
    });
    told.filter(|label| gaze.holds(label.heading)).collect()
}

fn label(camera: &Camera, seen: &Visible, object: &Object) -> Option<Label> {
    let centre = object.centre_m();
    let offset = centre - camera.position;
    let level_m = libm::sqrt(offset.x * offset.x + offset.y * offset.y);
    Some(Label {
        object: ObjectId::new(seen.id.to_string()).ok()?,
        name: object.name.clone(),
        heading: Heading::new(libm::atan2(offset.x, offset.y)).ok()?,
        elevation_rad: libm::atan2(offset.z, level_m),
        box_px: Some(seen.bbox.map(f64::from)),
        distance_m: Some(offset.length()),
        position: Some(centre),
        colour: object.colour.map(str::to_owned),
    })
}

/// Share of an object's box, as far as it lies in the picture, that the box of its visible pixels covers. None where the
/// object reaches behind the eye.
fn shown(camera: &Camera, object: &Object, seen: &Visible) -> Option<f64> {
    let (low, high) = object.bounds_m;
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

#[cfg(test)]
mod tests {
    use super::super::{catalogue::Kind, generate, model::House};
    use super::*;

    fn names(house: House, eye: DVec3, heading_rad: f64) -> Vec<String> {
        let scene = HouseScene::new(house).unwrap();
        let fov = 2.0 * libm::atan(0.75);
        let camera =
            Camera { position: eye, heading_rad, elevation_rad: 0.0, vertical_fov_rad: fov, width: 160, height: 120 };
        let picture = scene.picture(&camera).unwrap();
        let gaze = Gaze::quarter(Heading::new(heading_rad).unwrap());
        labels(&scene, &camera, gaze, &picture).into_iter().map(|label| label.name).collect()
    }

    /// A house whose only piece is a refrigerator in the middle of its living room, seen from the south.
    fn refrigerator_alone() -> (House, DVec3) {
        let mut house = generate(1);
        let room = house.furniture.iter().find(|piece| piece.kind == Kind::Sofa).unwrap().room;
        let mut piece = house.furniture.iter().find(|piece| piece.kind == Kind::Refrigerator).unwrap().clone();
        let (x, y) = house.rooms[room].outline.centre();
        piece.room = room;
        piece.quarter_turns = 0;
        piece.footprint = super::super::rect::RectCm::new(x - 38, y, x + 38, y + 70);
        house.furniture = vec![piece];
        (house, DVec3::new(f64::from(x) / 100.0, f64::from(y) / 100.0 - 1.8, 1.5))
    }

    #[test]
    fn what_stands_in_view_is_labelled_and_what_is_behind_the_eye_is_not() {
        let (house, eye) = refrigerator_alone();
        assert!(names(house.clone(), eye, 0.0).contains(&"refrigerator".to_owned()));
        assert!(!names(house, eye, std::f64::consts::PI).contains(&"refrigerator".to_owned()));
    }

    #[test]
    fn what_is_hidden_has_no_label() {
        let (mut house, eye) = refrigerator_alone();
        let mut vase = house.furniture[0].clone();
        (vase.kind, vase.name, vase.id) = (Kind::Vase, "vase".into(), vase.id + 1);
        let (x, y) = vase.footprint.centre();
        vase.footprint = super::super::rect::RectCm::new(x - 11, y + 60, x + 11, y + 82);
        (vase.base_cm, vase.height_cm) = (60, 44);
        house.furniture.push(vase);
        let seen = names(house, eye, 0.0);
        assert!(seen.contains(&"refrigerator".to_owned()) && !seen.contains(&"vase".to_owned()), "{seen:?}");
    }
}
