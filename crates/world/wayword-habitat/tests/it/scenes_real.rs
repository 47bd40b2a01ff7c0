//! Third-party scenes, from file to path and view. Needs the data; without it the test prints that it is skipped.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests may fail and tell as tests do")]

use wayword_core::{DVec3, PathRequest, Platform, ViewGaze, seeded_rng};
use wayword_habitat::{HabitatOptions, HabitatPlatform, NavMeshGround};

/// A scene, the length of its unit in metres, and the area of its floor by habitat-sim, square metres, where that was measured.
const SCENES: [(&str, f64, Option<f64>); 3] = [
    ("house.glb", 40.0, None),
    ("three_pathfinding_level.glb", 1.0, Some(66.3)),
    ("cube-room/cube-room.gltf", 1.0, Some(81.2)),
];

#[test]
fn scenes_without_navmesh_are_baked_walked_and_seen() {
    let Some(folder) = crate::oracles::folder() else { return };
    for (name, units, floor_m2) in SCENES {
        let file = folder.join("../scenes").join(name).canonicalize().unwrap();
        let configs = tempfile::tempdir().unwrap();
        let config = configs.path().join("scene.stage_config.json");
        let text = format!(
            r#"{{"render_asset": {file:?}, "up": [0, 1, 0], "front": [0, 0, -1], "units_to_meters": {units}}}"#
        );
        std::fs::write(&config, text).unwrap();
        let platform =
            HabitatPlatform::open(&config, HabitatOptions::default(), std::sync::Arc::new(|line| println!("{line}")))
                .unwrap();
        let scene = platform.list_scenes().unwrap().remove(0);
        let mesh = platform.navmesh(&scene).unwrap();
        let ground = NavMeshGround::new(&mesh);
        let graph = platform.graph_for_scene(&scene).unwrap();
        println!(
            "{name}: {} polygons, {:.1} m2, islands {:.1?}, {} viewpoints, {} edges",
            mesh.polygon_count(),
            ground.area_m2(),
            ground.islands_m2().take(5).collect::<Vec<_>>(),
            graph.len(),
            graph.edges().count()
        );
        if let Some(floor_m2) = floor_m2 {
            let largest_m2 = ground.islands_m2().next().unwrap();
            assert!((largest_m2 / floor_m2 - 1.0).abs() < 0.03, "{name}: {largest_m2} m2, in habitat-sim {floor_m2}");
        }
        assert_eq!(graph.count_components(), 1);
        walk_all_over(&ground);
        let path = platform.sample_path(&scene, &PathRequest { hops: 0..=99, length_m: 1.0..=30.0 }, 5).unwrap();
        let view =
            platform.look_from(&scene, &path.frames[0], ViewGaze::quarter_view(path.frames[0].pose.heading)).unwrap();
        let image = view.image.unwrap();
        let lit = image.rgb_bytes().chunks(3).filter(|pixel| pixel.iter().any(|byte| *byte > 0)).count();
        assert!(lit > 640 * 480 / 10, "{name}: {lit} pixels show something");
    }
}

/// Checks that there is a way between any two places of an island, that it is not shorter than the straight line, has
/// the same length backwards, and is almost never longer than the way over a third place.
fn walk_all_over(ground: &NavMeshGround) {
    let mut rng = seeded_rng(3, &["all over"]);
    let mut longer = 0;
    for _ in 0..1000 {
        let [a, b, c] = [0; 3].map(|island| ground.random_place(island, &mut rng).unwrap().place);
        let length_m = |from: DVec3, to: DVec3| ground.geodesic(from, to).unwrap().length_m;
        let straight_m = length_m(a, b);
        assert!(straight_m >= a.distance(b) - 1e-6);
        assert!((straight_m - length_m(b, a)).abs() < 1e-6);
        let over_m = length_m(a, c) + length_m(c, b);
        longer += usize::from(straight_m > over_m * 1.01);
    }
    println!("{longer} ways of 1000 are longer by more than 1 % than over a third place");
    assert!(longer <= 2);
}
