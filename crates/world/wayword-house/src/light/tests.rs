use super::super::{build_surfaces, catalogue::FurnitureKind, drawing::draw_house, generate_house};
use super::*;

/// The same light without furniture.
fn empty(house: &House, index: usize) -> RoomLight {
    RoomLight { blocks: Vec::new(), ..RoomLight::for_room(house, index) }
}

#[test]
fn corners_are_darker_than_the_middle_and_light_is_bounded() {
    let house = generate_house(3);
    for index in 0..house.rooms.len() {
        let empty = RoomLight { apertures: Vec::new(), ..empty(&house, index) };
        let (low, high) = (empty.low, empty.high);
        let middle = (low + high) / 2.0;
        let ceiling = |x: f32, y: f32| empty.on_shell(Vec3::new(x, y, high.z), -Vec3::Z)[1];
        assert!(ceiling(low.x + 0.01, low.y + 0.01) < ceiling(middle.x, middle.y));
        let all = empty.on_thing(middle, Vec3::Z, None);
        assert!(all.iter().all(|factor| (0.1..1.3).contains(factor)), "{all:?}");
    }
}

#[test]
fn things_shade_the_floor_under_them() {
    let house = generate_house(3);
    let table = house.furniture.iter().find(|piece| piece.kind == FurnitureKind::DiningTable).unwrap();
    let (x, y) = table.footprint.centre();
    let under = Vec3::new(to_metres(x), to_metres(y), to_metres(house.rooms[table.room].base_cm()));
    let shaded = RoomLight::for_room(&house, table.room).on_shell(under, Vec3::Z)[1];
    assert!(shaded < 0.8 * empty(&house, table.room).on_shell(under, Vec3::Z)[1]);
}

/// The place on the floor that the sun reaches through a place of a window. The latter is given by shares of the window's
/// width and height; a share outside 0..1 lies outside the window.
fn on_floor(window: &HouseWindow, share_along: f32, share_up: f32, sun: Vec3, floor: f32) -> Vec3 {
    let span = window.span;
    let along = to_metres(span.from) + to_metres(span.length()) * share_along;
    let (x, y) = if span.along_x { (along, to_metres(span.at)) } else { (to_metres(span.at), along) };
    let z = to_metres(window.sill_cm) + to_metres(window.head_cm - window.sill_cm) * share_up;
    Vec3::new(x, y, z) - sun * ((z - floor) / sun.z)
}

#[test]
fn a_sun_patch_lies_where_the_window_projects_to_with_its_bars() {
    let mut tried = 0;
    for seed in 0..12 {
        let house = generate_house(seed);
        for window in &house.windows {
            let light = RoomLight { wings: Vec::new(), ..empty(&house, window.room) };
            let sun = light.sun;
            let inside = |at: Vec3| at.cmpge(light.low).all() && at.cmple(light.high).all();
            let place = |along: f32, up: f32| on_floor(window, along, up, sun, light.low.z);
            let facing = house.rooms[window.room].outline.wall_of(&window.span).unwrap().inward();
            let shines = sun.dot(Vec3::new(facing.0 as f32, facing.1 as f32, 0.0)) < 0.0;
            let window_is_alone = house.windows.iter().filter(|other| other.room == window.room).count() == 1;
            if !window_is_alone || ![(0.25, 0.3), (0.5, 0.3), (-0.3, 0.3)].iter().all(|(a, u)| inside(place(*a, *u))) {
                continue;
            }
            let bright = |along: f32| light.sunlight(place(along, 0.3), Vec3::Z, None);
            if shines {
                assert!(bright(0.25) > 0.3, "house {seed}: {}", bright(0.25));
                assert!(bright(0.5) < 0.5 * bright(0.25), "house {seed}: the bar casts no shadow");
                assert!(bright(-0.3) == 0.0, "house {seed}: sun beside the window's patch");
                tried += 1;
            } else {
                assert!(bright(0.25) == 0.0, "house {seed}: sun from the wrong side");
            }
        }
    }
    assert!(tried > 3, "{tried} windows");
}

#[test]
fn behind_a_wardrobe_it_is_darker_than_before_it() {
    let (mut tried, mut darker) = (0, 0);
    for seed in 0..10 {
        let house = generate_house(seed);
        for piece in house.furniture.iter().filter(|piece| piece.kind == FurnitureKind::Wardrobe) {
            let (light, bare) = (RoomLight::for_room(&house, piece.room), empty(&house, piece.room));
            let (area, floor) = (piece.footprint, light.low.z);
            let wall = super::super::rect::WallSide::ALL[usize::from(piece.quarter_turns) % 4];
            let ((dx, dy), (x, y)) = (wall.inward(), area.centre());
            let deep = (if wall.along_x() { area.depth() } else { area.width() }) / 2;
            let at = |step: i32| Vec3::new(to_metres(x + dx * step), to_metres(y + dy * step), floor);
            let left = |step: i32| light.on_shell(at(step), Vec3::Z)[1] / bare.on_shell(at(step), Vec3::Z)[1];
            tried += 1;
            darker += usize::from(left(-deep) < 0.85 * left(deep + 60));
        }
    }
    // Something else may shade the floor in front of one.
    assert!(tried > 5 && 10 * darker >= 8 * tried, "{darker} of {tried}");
}

#[test]
fn a_shadow_lies_on_the_side_away_from_the_light() {
    let block = ShadowBlock { owner: 7, low: Vec3::new(1.0, -0.5, 0.0), high: Vec3::new(1.5, 0.5, 1.0) };
    let lamp = Vec3::new(0.0, 0.0, 2.0);
    let held = |at: Vec3, own| blocked_share(&[block], own, at, lamp - at, SOFT_M);
    assert_eq!(held(Vec3::new(0.8, 0.0, 0.0), None), 0.0);
    assert_eq!(held(Vec3::new(1.9, 0.0, 0.0), None), 1.0);
    assert_eq!(held(Vec3::new(1.9, 0.0, 0.0), Some(7)), 0.0);
    assert_eq!(held(Vec3::new(3.5, 0.0, 0.0), None), 0.0);
}

#[test]
fn surfaces_are_cut_at_shadows_cover_the_floor_and_are_the_same_twice() {
    let house = generate_house(5);
    let (first, again) = (draw_house(&house).meshes, draw_house(&house).meshes);
    assert_eq!(first, again);
    let count = |meshes: &[wayword_render::Mesh]| meshes.iter().map(|mesh| mesh.triangles.len()).sum::<usize>();
    assert!(count(&first) > count(&build_surfaces(&house)));
    // All triangles of a room's floor together cover it once.
    for (index, room) in house.rooms.iter().enumerate() {
        let id = super::super::objects::shell_id(&house, index, 0);
        let covered: f64 = first.iter().filter(|mesh| mesh.id == id).map(area).sum();
        let sills = house.openings.iter().filter(|opening| opening.room == index);
        let sills: f64 =
            sills.map(|opening| opening.span.thickened_by(super::super::model::HALF_WALL_CM).area_m2()).sum();
        assert!((covered - room.inner_area().area_m2() - sills).abs() < 0.01, "room {index}: {covered}");
    }
}

fn area(mesh: &wayword_render::Mesh) -> f64 {
    let corner = |index: &u32| mesh.positions[*index as usize];
    let each = |[a, b, c]: &[u32; 3]| (corner(b) - corner(a)).cross(corner(c) - corner(a)).length() / 2.0;
    mesh.triangles.iter().map(|triangle| f64::from(each(triangle))).sum()
}
