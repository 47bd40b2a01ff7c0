//! One room in 24 rotations, two mirrors, three units and other colours: the walks are the same.

use super::{
    tests::{painted_at, quad},
    *,
};
use glam::{DMat3, DMat4, DVec3};
use serde_json::json;
use wayword_core::{Heading, Pose};

/// A box, with the faces towards the inside or the outside.
fn box_faces(low: [f32; 3], high: [f32; 3], from_inside: bool) -> Vec<[f32; 3]> {
    let mut out = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for (level, is_high) in [(low[axis], false), (high[axis], true)] {
            let corner = |a: f32, b: f32| {
                let mut corner = [level; 3];
                (corner[u], corner[v]) = (a, b);
                corner
            };
            let corners =
                [corner(low[u], low[v]), corner(high[u], low[v]), corner(high[u], high[v]), corner(low[u], high[v])];
            let [a, b, c, d] = corners;
            quad(&mut out, if is_high != from_inside { [a, b, c, d] } else { [a, d, c, b] });
        }
    }
    out
}

/// A room of 8 x 6 m with a partition and a table; metres, z up.
fn room() -> Vec<Vec<[f32; 3]>> {
    vec![
        box_faces([-4.0, -3.0, 0.0], [4.0, 3.0, 2.7], true),
        box_faces([-0.1, -3.0, 0.0], [0.1, 0.6, 2.7], false),
        box_faces([-2.8, 1.0, 0.0], [-1.4, 2.0, 0.8], false),
    ]
}

/// What a walk from one corner of the room to the other finds.
struct RoomWalk {
    ground_m2: f64,
    /// The corners of the way, in the room's own frame.
    corners: Vec<DVec3>,
    length_m: f64,
}

/// Walks through the room after a node has placed it in the file.
fn walk_placed(asset_from_room: DMat3, colours: &[[u8; 4]; 3]) -> RoomWalk {
    let folder = tempfile::tempdir().unwrap();
    let matrix = DMat4::from_mat3(asset_from_room).to_cols_array();
    let bytes = painted_at(&room(), colours, &json!({ "mesh": 0, "matrix": matrix }));
    std::fs::write(folder.path().join("room.glb"), bytes).unwrap();
    let options = HabitatOptions::default();
    let platform = HabitatPlatform::open(folder.path(), options.clone(), Arc::new(|_: &str| {})).unwrap();
    let scene = platform.list_scenes().unwrap().remove(0);
    let (_, files) = platform.find_files(&scene).unwrap();
    let stage = PlacedStage::read(files, &options, SceneModel::read_shape).unwrap().stage;
    let room_from_habitat = (stage.habitat_from_asset * asset_from_room).inverse();
    let eye = |place: DVec3| {
        let floor = crate::axes::wayword_from_habitat(stage.habitat_from_asset * (asset_from_room * place));
        Frame { pose: Pose::looking_level(floor + DVec3::Z * 1.5, Heading::NORTH), viewpoint: None, level: None }
    };
    let (from, to) = (eye(DVec3::new(-3.0, -2.0, 0.1)), eye(DVec3::new(3.0, -2.0, 0.1)));
    let way = platform.ground().ground_route(&scene, &from, &to).unwrap().unwrap();
    let islands = platform.ground().ground_islands(&scene).unwrap();
    RoomWalk {
        ground_m2: islands.iter().find(|island| island.is_walked).unwrap().area_m2,
        corners: way
            .corners
            .iter()
            .map(|corner| room_from_habitat * crate::axes::habitat_from_wayword(*corner))
            .collect(),
        length_m: way.length_m,
    }
}

const COLOURS: [[u8; 4]; 3] = [[200, 190, 170, 255], [150, 150, 160, 255], [200, 30, 30, 255]];

#[test]
fn a_room_is_walked_alike_however_it_lies_in_its_file() {
    let plain = walk_placed(DMat3::IDENTITY, &COLOURS);
    assert!(plain.corners.len() >= 3 && plain.length_m > 7.0, "the way leads around the partition");
    let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
    let pairs = axes.into_iter().flat_map(|a| axes.map(|b| (a, b))).filter(|(a, b)| a.dot(*b) == 0.0);
    let turns: Vec<DMat3> = pairs.map(|(a, b)| DMat3::from_cols(a, b, a.cross(b))).collect();
    assert_eq!(turns.len(), 24);
    let mirrors = [DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1.0, -1.0, 1.0)].map(DMat3::from_diagonal);
    let units = [1.0, 100.0, 1000.0];
    let placed = turns.iter().flat_map(|turn| units.map(|unit| *turn * unit)).chain(mirrors);
    for asset_from_room in placed {
        let walk = walk_placed(asset_from_room, &COLOURS);
        let context = format!("{asset_from_room}: {} m2, {} m", walk.ground_m2, walk.length_m);
        assert!((walk.ground_m2 / plain.ground_m2 - 1.0).abs() < 0.02, "{context}, not {} m2", plain.ground_m2);
        assert!((walk.length_m - plain.length_m).abs() < 0.1, "{context}, not {} m", plain.length_m);
        // It bends where the plain way bends: on the same side of the room, at the partition's end.
        let bend = |walk: &RoomWalk| walk.corners.iter().copied().reduce(|a, b| if b.y > a.y { b } else { a }).unwrap();
        assert!(bend(&walk).distance(bend(&plain)) < 0.3, "{context}: {} and {}", bend(&walk), bend(&plain));
    }
}

#[test]
fn colours_do_not_change_walks() {
    let (one, other) = (walk_placed(DMat3::IDENTITY, &COLOURS), walk_placed(DMat3::IDENTITY, &[[255; 4]; 3]));
    assert_eq!((one.corners, one.length_m, one.ground_m2), (other.corners, other.length_m, other.ground_m2));
}

#[test]
fn a_run_tells_once_what_it_decided_and_a_view_without_colours() {
    let folder = tempfile::tempdir().unwrap();
    let y_up = DMat4::from_mat3(DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y)).to_cols_array();
    let bytes = painted_at(&room(), &[[255; 4]; 3], &json!({ "mesh": 0, "matrix": y_up }));
    std::fs::write(folder.path().join("room.glb"), bytes).unwrap();
    let heard = Arc::new(Mutex::new(Vec::new()));
    let hearing = Arc::clone(&heard);
    let hear: OutputListener = Arc::new(move |line: &str| hearing.lock().unwrap().push(line.to_owned()));
    let platform = HabitatPlatform::open(folder.path(), HabitatOptions::default(), hear).unwrap();
    let scene = platform.list_scenes().unwrap().remove(0);
    let condition = platform.files().examine_scene(&scene).unwrap().unwrap();
    assert_eq!(condition.unusable, None);
    assert!(
        condition.lacks.iter().any(|lack| lack.what.starts_with("it is read with up = [0, 1, 0]")),
        "{condition:?}"
    );
    for seed in 0..3 {
        let path = platform.sample_path(&scene, &PathRequest::default(), seed).unwrap();
        let frame = &path.frames[0];
        platform.look_from(&scene, frame, ViewGaze::quarter_view(frame.pose.heading)).unwrap();
    }
    let heard = heard.lock().unwrap();
    let [axes, colours] = &heard[..] else { panic!("{heard:?}") };
    assert!(axes.contains("scene room: it is read with up = [0, 1, 0]"), "{axes}");
    assert!(colours.contains("scene room: its first view is of one single colour"), "{colours}");
}

#[test]
fn a_navmesh_beside_a_scene_in_other_axes_is_refused_with_the_axes_of_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let place = |turn: DMat3| {
        let matrix = DMat4::from_mat3(turn).to_cols_array();
        let bytes = painted_at(&room(), &COLOURS, &json!({ "mesh": 0, "matrix": matrix }));
        std::fs::write(folder.path().join("room.glb"), bytes).unwrap();
        let hear: OutputListener = Arc::new(|_: &str| {});
        let platform = HabitatPlatform::open(folder.path(), HabitatOptions::default(), hear).unwrap();
        let scene = platform.list_scenes().unwrap().remove(0);
        (platform, scene)
    };
    let (platform, scene) = place(DMat3::IDENTITY);
    let navmesh = platform.navmesh(&scene).unwrap().to_bytes();
    std::fs::write(folder.path().join("room.navmesh"), navmesh).unwrap();
    let (platform, scene) = place(DMat3::IDENTITY);
    assert!(platform.graph_for_scene(&scene).is_ok());
    let (platform, scene) = place(DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y));
    let error = platform.graph_for_scene(&scene).unwrap_err().to_string();
    assert!(error.contains("of its navmesh lie on a surface") && error.contains("\"up\": [0, 1, 0]"), "{error}");
}

#[test]
fn a_scene_that_is_too_small_is_unusable_in_a_run_and_before_it() {
    let folder = tempfile::tempdir().unwrap();
    let small = DMat4::from_scale(DVec3::splat(0.01)).to_cols_array();
    let bytes = painted_at(&room(), &COLOURS, &json!({ "mesh": 0, "matrix": small }));
    std::fs::write(folder.path().join("room.glb"), bytes).unwrap();
    let platform = HabitatPlatform::open(folder.path(), HabitatOptions::default(), Arc::new(|_: &str| {})).unwrap();
    let scene = platform.list_scenes().unwrap().remove(0);
    let unusable = platform.files().examine_scene(&scene).unwrap().unwrap().unusable.unwrap();
    let error = platform.graph_for_scene(&scene).unwrap_err().to_string();
    for told in [&unusable.what, &error] {
        assert!(told.contains("0.08 x 0.06 x 0.03 m large, too small") && told.contains("units_to_meters"), "{told}");
    }
}
