//! Tests with rooms that are written here, turned, mirrored and in other units.

mod real_scenes;

use super::*;
use glam::DMat3;
use std::path::Path;
use wayword_render::Mesh;

/// A box that is seen from outside, or from inside.
fn add_box(out: &mut Mesh, low: [f32; 3], high: [f32; 3], from_inside: bool) {
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for (level, is_high) in [(low[axis], false), (high[axis], true)] {
            let corner = |a: f32, b: f32| {
                let mut corner = [level; 3];
                (corner[u], corner[v]) = (a, b);
                Vec3::from(corner)
            };
            let first = out.positions.len() as u32;
            out.positions.extend([
                corner(low[u], low[v]),
                corner(high[u], low[v]),
                corner(high[u], high[v]),
                corner(low[u], high[v]),
            ]);
            let [a, b, c, d] = [0, 1, 2, 3].map(|corner| first + corner);
            let is_forward = is_high != from_inside;
            out.triangles.extend(if is_forward { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] });
        }
    }
}

/// A room of 8 x 6 m, 2.7 m high, with a partition, a table, a cupboard and a bench.
fn room() -> Mesh {
    let mut mesh = Mesh::default();
    add_box(&mut mesh, [-4.0, -3.0, 0.0], [4.0, 3.0, 2.7], true);
    add_box(&mut mesh, [-0.1, -3.0, 0.0], [0.1, 0.6, 2.7], false);
    add_box(&mut mesh, [-2.6, 1.1, 0.0], [-1.4, 1.9, 0.8], false);
    add_box(&mut mesh, [3.0, 2.0, 0.0], [3.8, 2.8, 2.0], false);
    add_box(&mut mesh, [1.4, -2.7, 0.0], [3.0, -2.2, 0.5], false);
    mesh
}

/// A hall of 30 x 20 m, 6 m high: its walls are as large as other buildings' floors.
fn hall() -> Mesh {
    let mut mesh = Mesh::default();
    add_box(&mut mesh, [-15.0, -10.0, 0.0], [15.0, 10.0, 6.0], true);
    add_box(&mut mesh, [-7.2, 2.0, 0.0], [-4.8, 3.2, 0.8], false);
    add_box(&mut mesh, [2.7, -7.4, 0.0], [5.3, -6.0, 0.5], false);
    mesh
}

/// Two rooms of 4 x 4 m that a door joins, and a bed: scanned without ceilings.
fn open_flat() -> Mesh {
    let mut mesh = Mesh::default();
    add_box(&mut mesh, [0.0, 0.0, 0.0], [8.0, 4.0, 2.6], true);
    // The ceiling is the second quad along z.
    mesh.triangles.truncate(10);
    add_box(&mut mesh, [3.9, 0.0, 0.0], [4.1, 2.8, 2.6], false);
    add_box(&mut mesh, [1.0, 2.0, 0.0], [3.0, 3.6, 0.5], false);
    mesh
}

/// The 24 rotations of a cube.
fn rotations() -> Vec<DMat3> {
    let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let pairs = axes.into_iter().flat_map(|a| axes.map(|b| (a, b))).filter(|(a, b)| a.dot(*b) == 0.0);
    pairs.map(|(a, b)| DMat3::from_cols(a, b, a.cross(b))).collect()
}

/// A mesh with its places multiplied. A mirror turns its triangles around, so that they are seen from where they were.
fn moved(mesh: &Mesh, by: DMat3) -> SceneModel {
    let mut mesh = mesh.clone();
    mesh.positions.iter_mut().for_each(|place| *place = (by * place.as_dvec3()).as_vec3());
    if by.determinant() < 0.0 {
        mesh.triangles.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
    }
    SceneModel { meshes: vec![mesh], ..SceneModel::default() }
}

/// A stage that is read with z up, as Wayword's own frame.
fn stage() -> HabitatStage {
    HabitatStage::from_file(Path::new("nowhere/x.glb")).unwrap()
}

fn told_stage(fields: &str) -> HabitatStage {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("x.stage_config.json"), fields).unwrap();
    HabitatStage::from_file(&folder.path().join("x.glb")).unwrap()
}

#[test]
fn turned_mirrored_and_rescaled_rooms_are_read_upright_and_in_metres() {
    for (name, mesh) in [("room", room()), ("hall", hall()), ("flat", open_flat())] {
        let [mirrored_x, mirrored_y] = [DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1.0, -1.0, 1.0)];
        let units = [1.0, 100.0, 1000.0].map(|unit| (unit, DVec3::ONE));
        for (unit, mirror) in units.into_iter().chain([(1.0, mirrored_x), (1.0, mirrored_y)]) {
            for turn in rotations() {
                let by = turn * DMat3::from_diagonal(mirror * unit);
                let placement = judge_placement(&moved(&mesh, by), &stage()).unwrap();
                let up = placement.stage.habitat_from_asset * (by * DVec3::Z);
                assert!((up - DVec3::Y).length() < 1e-6, "{name} {turn} {unit}: {up} {:?}", placement.note);
                assert!(placement.stage.habitat_from_asset.determinant() > 0.0);
                let is_as_read = placement.stage.habitat_from_asset == stage().habitat_from_asset;
                assert_eq!(placement.note.is_none(), is_as_read, "{name} {turn} {unit}: {:?}", placement.note);
            }
        }
    }
}

#[test]
fn a_note_has_the_reason_and_the_configuration_that_settles_it() {
    let y_up = DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y);
    let placement = judge_placement(&moved(&hall(), y_up * 100.0), &stage()).unwrap();
    let note = placement.note.unwrap();
    assert!(
        note.starts_with("it is read with up = [0, 1, 0], front = [0, 0, -1] and units_to_meters = 0.01"),
        "{note}"
    );
    assert!(note.contains("3000 x 2000 x 600") || note.contains("3000 x 600 x 2000"), "{note}");
    let config = &note[note.find('{').unwrap()..];
    let told = told_stage(config);
    assert!((told.habitat_from_asset - placement.stage.habitat_from_asset).abs_diff_eq(DMat3::ZERO, 1e-9), "{config}");
    assert!(told.is_up_told && told.is_unit_told);
    // What was advised is read without another word.
    assert_eq!(
        judge_placement(&read_as(&hall(), y_up * 100.0, &told), &told).unwrap(),
        ScenePlacement { stage: told, note: None }
    );
}

/// A mesh in a file's frame as the stage reads it.
fn read_as(mesh: &Mesh, asset_from_mesh: DMat3, stage: &HabitatStage) -> SceneModel {
    let wayword_from_habitat = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y);
    moved(mesh, wayword_from_habitat * stage.habitat_from_asset * asset_from_mesh)
}

#[test]
fn what_is_told_holds_unless_it_cannot_be() {
    let room = room();
    let upside_down = told_stage(r#"{"up": [0, 0, -1], "front": [0, 1, 0]}"#);
    let placement = judge_placement(&read_as(&room, DMat3::IDENTITY, &upside_down), &upside_down).unwrap();
    assert_eq!(placement, ScenePlacement { stage: upside_down, note: None }, "there is a floor on the ceiling too");
    // Two rooms with walls in the way have no floor on their side.
    let on_its_side = told_stage(r#"{"up": [1, 0, 0], "front": [0, 1, 0]}"#);
    let mut low = Mesh::default();
    add_box(&mut low, [0.0, 0.0, 0.0], [9.0, 9.0, 0.2], false);
    let error = judge_placement(&read_as(&low, DMat3::IDENTITY, &on_its_side), &on_its_side).unwrap_err().to_string();
    assert!(error.contains("its up cannot be right") && error.contains("up = [0, 0, 1]"), "{error}");
    let millimetres = told_stage(r#"{"units_to_meters": 1}"#);
    let error = judge_placement(&moved(&room, DMat3::IDENTITY * 1000.0), &millimetres).unwrap_err().to_string();
    assert!(error.contains("8000 x 6000 x 2700 m large") && error.contains("0.001"), "{error}");
}

#[test]
fn what_cannot_be_told_is_asked_unless_it_may_be_as_read() {
    // An empty cube: any of its six sides may be the floor.
    let mut cube = Mesh::default();
    add_box(&mut cube, [0.0; 3], [2.7; 3], true);
    assert_eq!(
        judge_placement(&moved(&cube, DMat3::IDENTITY), &stage()).unwrap(),
        ScenePlacement { stage: stage(), note: None }
    );
    // An empty hall on its side: its floor or its ceiling may be below.
    let mut empty = Mesh::default();
    add_box(&mut empty, [0.0; 3], [30.0, 20.0, 6.0], true);
    assert_eq!(judge_placement(&moved(&empty, DMat3::IDENTITY), &stage()).unwrap().note, None);
    let on_its_side = DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y);
    let error = judge_placement(&moved(&empty, on_its_side), &stage()).unwrap_err().to_string();
    assert!(error.contains("which direction is up cannot be told"), "{error}");
    assert!(
        error.contains("600.0 m2 and 0.0 m2 of things that stand on it with up = [0, 1, 0]")
            && error.contains(r#""up": [0, 1, 0], "front": [0, 0, -1]"#),
        "{error}"
    );
    // Inches, or centimetres of a low room.
    let error = judge_placement(&moved(&cube, DMat3::IDENTITY * 39.37), &stage()).unwrap_err().to_string();
    assert!(error.contains("106 x 106 x 106 units") && error.contains("units_to_meters"), "{error}");
    let error = judge_placement(&moved(&cube, DMat3::IDENTITY * 0.01), &stage()).unwrap_err().to_string();
    assert!(error.contains("0.03 x 0.03 x 0.03 m large, too small") && error.contains("units_to_meters"), "{error}");
}

#[test]
fn beams_lintels_and_a_missing_ceiling_turn_no_scene_around() {
    let mut loft = Mesh::default();
    add_box(&mut loft, [0.0; 3], [10.0, 6.0, 2.7], true);
    for beam in 0..5 {
        let x = 1.0 + 2.0 * beam as f32;
        add_box(&mut loft, [x, 0.0, 2.4], [x + 0.2, 6.0, 2.7], false);
    }
    // Two empty rooms, a door between them with a lintel.
    let mut rooms = Mesh::default();
    add_box(&mut rooms, [0.0; 3], [8.0, 4.0, 2.7], true);
    add_box(&mut rooms, [3.9, 0.0, 0.0], [4.1, 1.5, 2.7], false);
    add_box(&mut rooms, [3.9, 2.4, 0.0], [4.1, 4.0, 2.7], false);
    add_box(&mut rooms, [3.9, 1.5, 2.0], [4.1, 2.4, 2.7], false);
    for mesh in [loft, rooms, open_flat()] {
        assert_eq!(judge_placement(&moved(&mesh, DMat3::IDENTITY), &stage()).unwrap().note, None);
    }
}
