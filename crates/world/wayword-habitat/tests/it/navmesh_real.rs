//! Tests with navmeshes that Habitat wrote. They need the oracle data; without it they print that they are skipped.

#![allow(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

use wayword_core::{DVec3, Path, seeded_rng};
use wayword_habitat::{
    NavMesh, NavMeshGround, NavMeshSettings,
    axes::{EYE_M, forward_from_habitat_rotation, wayword_from_habitat},
    bake::bake_navmesh,
    ground::{stops_along, viewpoint_graph},
    scene::SceneModel,
};
use wayword_render::Mesh;

#[test]
fn every_navmesh_of_habitat_is_written_back_byte_for_byte() {
    for file in crate::oracles::navmeshes() {
        let bytes = std::fs::read(&file).unwrap();
        let mesh = NavMesh::from_bytes(&bytes).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        assert_eq!(mesh.version(), 2);
        assert!(mesh.polygon_count() > 0);
        assert!(mesh.to_bytes() == bytes, "{} is written back differently", file.display());
    }
}

/// The corners of Habitat's way, in Wayword's frame.
fn corners(points: &serde_json::Value) -> Vec<DVec3> {
    points.as_array().unwrap().iter().map(crate::oracles::place).collect()
}

#[test]
fn geodesics_along_habitats_own_trajectories_agree_to_a_millimetre() {
    let Some(folder) = crate::oracles::folder() else { return };
    for name in ["traj_flat_a", "traj_simple_room"] {
        let folder = folder.join("habitat_frames").join(name);
        let ground =
            NavMeshGround::new(&NavMesh::from_bytes(&std::fs::read(folder.join("scene.navmesh")).unwrap()).unwrap());
        let trajectory = crate::oracles::json(&folder.join("trajectory.json"));
        let expected = corners(&trajectory["path_points"]);
        let way = ground.geodesic(expected[0], *expected.last().unwrap()).unwrap();
        let length_m = trajectory["geodesic_distance"].as_f64().unwrap();
        println!("{name}: {} of {length_m} m", way.length_m);
        assert!((way.length_m - length_m).abs() < 1e-3, "{way:?}");
        assert_eq!(way.corners.len(), expected.len());
        for (ours, theirs) in way.corners.iter().zip(&expected) {
            assert!(ours.distance(*theirs) < 1e-3, "{ours} {theirs}");
        }
    }
}

#[test]
fn frames_stand_where_those_of_the_trajectories_do() {
    let Some(folder) = crate::oracles::folder() else { return };
    for name in ["traj_flat_a", "traj_simple_room"] {
        let folder = folder.join("habitat_frames").join(name);
        let ground =
            NavMeshGround::new(&NavMesh::from_bytes(&std::fs::read(folder.join("scene.navmesh")).unwrap()).unwrap());
        let trajectory = crate::oracles::json(&folder.join("trajectory.json"));
        let expected = corners(&trajectory["path_points"]);
        let way = ground.geodesic(expected[0], *expected.last().unwrap()).unwrap();
        let frames = trajectory["frames"].as_array().unwrap();
        // Habitat's frames are about a metre apart: ours are to be as many.
        let stops = stops_along(&ground, &way, way.length_m / (frames.len() - 1) as f64);
        // Before the first bend, Habitat's agent looks in the same direction as ours.
        let ours = Path::frames_along(stops.clone(), None)[0].pose.heading.unit_vector();
        let rotation = std::array::from_fn(|at| frames[0]["rotation_wxyz"][at].as_f64().unwrap());
        assert!((ours - forward_from_habitat_rotation(rotation)).length() < 1e-3);
        for (stop, frame) in stops.iter().zip(frames) {
            let eye = crate::oracles::place(&frame["agent_position"]) + DVec3::Z * EYE_M;
            assert!(stop.position.distance(eye) < 2e-3, "{} {eye}", stop.position);
        }
    }
}

#[test]
fn geodesics_and_area_agree_with_habitats_path_finder() {
    let Some(folder) = crate::oracles::folder() else { return };
    let folder = folder.join("habitat_navmesh");
    let ground =
        NavMeshGround::new(&NavMesh::from_bytes(&std::fs::read(folder.join("rooms.navmesh")).unwrap()).unwrap());
    let rooms = crate::oracles::json(&folder.join("rooms.json"));
    let area_m2 = rooms["area"].as_f64().unwrap();
    println!("area {} of {area_m2} m2", ground.area_m2());
    assert!((ground.area_m2() / area_m2 - 1.0).abs() < 1e-4);
    for path in rooms["paths"].as_array().unwrap() {
        let way = ground.geodesic(crate::oracles::place(&path["start"]), crate::oracles::place(&path["end"])).unwrap();
        let length_m = path["geodesic"].as_f64().unwrap();
        println!("{} of {length_m} m", way.length_m);
        assert!((way.length_m / length_m - 1.0).abs() < 0.01, "{way:?}");
    }
}

/// A box with faces that point outwards, in Wayword's frame.
fn solid(ends: [[f32; 3]; 2]) -> Mesh {
    let (corners, triangles) = crate::oracles::solid(ends);
    let place = |corner: [f32; 3]| wayword_from_habitat(glam::Vec3::from(corner).as_dvec3()).as_vec3();
    Mesh { positions: corners.into_iter().map(place).collect(), triangles, ..Mesh::default() }
}

#[test]
fn a_navmesh_baked_with_the_default_settings_is_habitats() {
    let Some(folder) = crate::oracles::folder() else { return };
    let folder = folder.join("habitat_navmesh");
    let model = SceneModel { meshes: crate::oracles::ROOMS.map(solid).to_vec(), ..SceneModel::default() };
    let ground = NavMeshGround::new(&bake_navmesh(&model, &NavMeshSettings::default()).unwrap());
    let rooms = crate::oracles::json(&folder.join("rooms.json"));
    let area_m2 = rooms["area"].as_f64().unwrap();
    println!("baked area {} of {area_m2} m2", ground.area_m2());
    assert!((ground.area_m2() / area_m2 - 1.0).abs() < 0.03);
    for path in rooms["paths"].as_array().unwrap() {
        let way = ground.geodesic(crate::oracles::place(&path["start"]), crate::oracles::place(&path["end"])).unwrap();
        let length_m = path["geodesic"].as_f64().unwrap();
        println!("baked {} of {length_m} m", way.length_m);
        assert!((way.length_m / length_m - 1.0).abs() < 0.01, "{way:?}");
    }
}

#[test]
fn places_and_viewpoints_lie_on_the_largest_island() {
    for file in crate::oracles::navmeshes() {
        let ground = NavMeshGround::new(&NavMesh::from_bytes(&std::fs::read(&file).unwrap()).unwrap());
        let mut rng = seeded_rng(7, &["places"]);
        for _ in 0..200 {
            let place = ground.random_place(0, &mut rng).unwrap().place;
            assert!(ground.nearest_on(0, place).unwrap().place.distance(place) < 1e-6);
        }
        let graph = viewpoint_graph(&ground, 0).unwrap();
        let islands: Vec<f64> = ground.islands_m2().collect();
        println!(
            "{}: islands {islands:?}, {} viewpoints, {} edges",
            file.display(),
            graph.len(),
            graph.edges().count()
        );
        assert_eq!(graph.count_components(), 1);
    }
}
