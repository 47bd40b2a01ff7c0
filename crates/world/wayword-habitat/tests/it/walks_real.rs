//! Where random paths lead in the scenes of the genuine Habitat, over its own navmeshes. Needs the oracle data; without
//! it the tests print that they are skipped.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "helpers of tests may fail and tell as tests do")]

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};
use wayword_core::{DVec3, Frame, GroundRoute, Heading, PathRequest, Platform, Pose};
use wayword_habitat::{
    HabitatOptions, HabitatPlatform,
    axes::EYE_M,
    scene::{HabitatStage, SceneModel},
};

/// A scene, its navmesh, and the area of the island that people walk on, square metres.
struct Oracle {
    name: &'static str,
    stage: PathBuf,
    navmesh: Option<PathBuf>,
    area_m2: f64,
}

/// The scenes for which there is a navmesh by Habitat, and those navmeshes. The scene of `rooms.navmesh` is written
/// here.
fn scenes(folder: &Path, written: &Path) -> Vec<Oracle> {
    let frames = folder.join("habitat_frames");
    let navmesh = |name: &str| Some(frames.join(name).join("scene.navmesh"));
    let rooms = written.join("rooms.stage_config.json");
    crate::oracles::write_rooms(&rooms);
    let flat = || frames.join("flat.stage_config.json");
    vec![
        Oracle { name: "flat", stage: flat(), navmesh: navmesh("traj_flat_a"), area_m2: 43.5 },
        Oracle { name: "flat, baked", stage: flat(), navmesh: None, area_m2: 50.6 },
        Oracle {
            name: "simple_room",
            stage: frames.join("simple_room.stage_config.json"),
            navmesh: navmesh("traj_simple_room"),
            area_m2: 94.7,
        },
        Oracle {
            name: "rooms",
            stage: rooms,
            navmesh: Some(folder.join("habitat_navmesh/rooms.navmesh")),
            area_m2: 68.9,
        },
    ]
}

fn open(oracle: &Oracle, island: Option<usize>) -> HabitatPlatform {
    let options = HabitatOptions { navmesh: oracle.navmesh.clone(), island, ..HabitatOptions::default() };
    HabitatPlatform::open(&oracle.stage, options, Arc::new(|line: &str| println!("{line}"))).unwrap()
}

/// Random paths in each scene.
const WALKS: u64 = 200;

#[test]
fn every_frame_of_a_walk_stands_on_a_storey_with_headroom() {
    let Some(folder) = crate::oracles::folder() else { return };
    let written = tempfile::tempdir().unwrap();
    for oracle in scenes(&folder, written.path()) {
        let name = oracle.name;
        let platform = open(&oracle, None);
        let scene = platform.list_scenes().unwrap().remove(0);
        let islands = platform.ground().ground_islands(&scene).unwrap();
        for island in &islands {
            println!("{name}: {island}{}", if island.is_walked { ", walked" } else { "" });
        }
        let geometry = Geometry::of(&oracle.stage);
        println!("{name}: storeys at {:.2?}", geometry.storeys_m);
        let request = PathRequest { hops: 0..=99, length_m: 2.0..=20.0 };
        let (mut frames, mut off, mut low) = (0, 0, 0);
        for seed in 0..WALKS {
            let path = platform.sample_path(&scene, &request, seed).unwrap();
            for frame in &path.frames {
                frames += 1;
                low += usize::from(!geometry.has_headroom(frame));
                off += usize::from(!geometry.is_on_storey(frame));
            }
        }
        println!("{name}: {WALKS} paths, {frames} frames, {low} without headroom, {off} off every storey");
        assert_eq!((low, off), (0, 0), "{name}");
        let walked = islands.iter().find(|island| island.is_walked).unwrap();
        assert!((walked.area_m2 - oracle.area_m2).abs() < 0.1, "{name}: {walked}");
    }
}

#[test]
fn an_island_that_is_asked_for_is_walked_on_even_if_it_is_a_roof() {
    let Some(folder) = crate::oracles::folder() else { return };
    let written = tempfile::tempdir().unwrap();
    let flat = scenes(&folder, written.path()).remove(0);
    let geometry = Geometry::of(&flat.stage);
    let platform = open(&flat, Some(0));
    let scene = platform.list_scenes().unwrap().remove(0);
    for seed in 0..20 {
        let path = platform.sample_path(&scene, &PathRequest::default(), seed).unwrap();
        assert!(!path.frames.iter().any(|frame| geometry.is_on_storey(frame)));
    }
    let error = open(&flat, Some(9)).graph_for_scene(&scene).unwrap_err().to_string();
    assert!(
        error.contains("no island 9: island 0: 67.0 m2 at height 2.9 m, on top of a roof; island 1: 43.5 m2"),
        "{error}"
    );
}

/// The way from one place on the ground to another.
type Measure = dyn Fn(DVec3, DVec3) -> GroundRoute;

#[test]
fn ways_are_as_long_as_habitats_and_straight_between_their_corners() {
    let Some(folder) = crate::oracles::folder() else { return };
    let written = tempfile::tempdir().unwrap();
    let at = |scene: &str, number: usize| {
        let oracle = scenes(&folder, written.path()).remove(number);
        assert_eq!(oracle.name, scene);
        let platform = open(&oracle, None);
        let scene = platform.list_scenes().unwrap().remove(0);
        move |from: DVec3, to: DVec3| {
            platform.ground().ground_route(&scene, &standing(from), &standing(to)).unwrap().unwrap()
        }
    };
    let mut expected: Vec<(Box<Measure>, DVec3, DVec3, f64)> = Vec::new();
    for (name, number) in [("flat", 0), ("simple_room", 2)] {
        let file = format!("habitat_frames/traj_{}/trajectory.json", if number == 0 { "flat_a" } else { name });
        let told = crate::oracles::json(&folder.join(file));
        let points = told["path_points"].as_array().unwrap();
        let (from, to) = (crate::oracles::place(&points[0]), crate::oracles::place(points.last().unwrap()));
        expected.push((Box::new(at(name, number)), from, to, told["geodesic_distance"].as_f64().unwrap()));
    }
    for path in crate::oracles::json(&folder.join("habitat_navmesh/rooms.json"))["paths"].as_array().unwrap() {
        let (from, to) = (crate::oracles::place(&path["start"]), crate::oracles::place(&path["end"]));
        expected.push((Box::new(at("rooms", 3)), from, to, path["geodesic"].as_f64().unwrap()));
    }
    for (way, from, to, length_m) in expected {
        let found = way(from, to);
        println!("{} m of {length_m} m", found.length_m);
        assert!((found.length_m - length_m).abs() <= 0.05_f64.min(0.02 * length_m), "{found:?}");
        for hop in found.corners.windows(2) {
            let straight_m = hop[0].distance(hop[1]);
            assert!(way(hop[0], hop[1]).length_m <= straight_m + 1e-3, "{hop:?}");
        }
    }
}

fn standing(feet: DVec3) -> Frame {
    Frame { pose: Pose::looking_level(feet + DVec3::Z * EYE_M, Heading::NORTH), viewpoint: None, level: None }
}

/// The triangles of a scene, searched one by one without any code of the platform.
struct Geometry {
    triangles: Vec<[DVec3; 3]>,
    storeys_m: Vec<f64>,
}

impl Geometry {
    fn of(stage: &Path) -> Self {
        let model = SceneModel::from_stage(&HabitatStage::from_file(stage).unwrap()).unwrap();
        let of_mesh = |mesh: &wayword_render::Mesh| {
            let corner = |vertex: &u32| mesh.positions[*vertex as usize].as_dvec3();
            mesh.triangles.iter().map(|triangle| std::array::from_fn(|at| corner(&triangle[at]))).collect::<Vec<_>>()
        };
        let mut geometry = Self { triangles: model.meshes.iter().flat_map(of_mesh).collect(), storeys_m: Vec::new() };
        geometry.storeys_m = geometry.storeys();
        geometry
    }

    /// Heights at which a large part of the scene is level and faces up, except roofs.
    fn storeys(&self) -> Vec<f64> {
        let mut levels: Vec<(f64, f64)> = Vec::new();
        for [a, b, c] in &self.triangles {
            let normal = (*b - *a).cross(*c - *a);
            let (height_m, area_m2) = ((a.z + b.z + c.z) / 3.0, normal.length() / 2.0);
            if normal.z < 0.99 * normal.length() {
                continue;
            }
            match levels.iter_mut().find(|(level_m, _)| (*level_m - height_m).abs() < 0.05) {
                Some(level) => level.1 += area_m2,
                None => levels.push((height_m, area_m2)),
            }
        }
        levels.sort_by(|a, b| a.0.total_cmp(&b.0));
        println!("level surfaces (height, area): {levels:.2?}");
        let largest = levels.iter().map(|level| level.1).fold(0.0, f64::max);
        let large = levels.iter().filter(|level| level.1 >= 0.15 * largest).map(|level| level.0);
        large.filter(|height_m| !self.is_roof(*height_m)).collect()
    }

    /// Whether no part of the scene lies more than 0.5 m above a height, and a part more than 1.8 m below it.
    fn is_roof(&self, height_m: f64) -> bool {
        let heights = || self.triangles.iter().flatten().map(|corner| corner.z);
        !heights().any(|z| z > height_m + 0.5) && heights().any(|z| z < height_m - 1.8)
    }

    fn heights(&self, place: DVec3) -> impl Iterator<Item = f64> {
        self.triangles.iter().filter_map(move |[a, b, c]| {
            let side = |a: &DVec3, b: &DVec3| (b.x - a.x) * (place.y - a.y) - (b.y - a.y) * (place.x - a.x);
            let shares = [side(b, c), side(c, a), side(a, b)];
            let whole: f64 = shares.iter().sum();
            let within = shares.iter().all(|share| *share >= 0.0) || shares.iter().all(|share| *share <= 0.0);
            (within && whole.abs() > 1e-12).then(|| (a.z * shares[0] + b.z * shares[1] + c.z * shares[2]) / whole)
        })
    }

    fn has_headroom(&self, frame: &Frame) -> bool {
        let feet = feet(frame);
        // The ground of a navmesh lies up to one voxel off the floor.
        !self.heights(feet).any(|z| z > feet.z + 0.3 && z < feet.z + 1.8)
    }

    fn is_on_storey(&self, frame: &Frame) -> bool {
        self.storeys_m.iter().any(|storey_m| (storey_m - feet(frame).z).abs() <= 0.3)
    }
}

fn feet(frame: &Frame) -> DVec3 {
    frame.pose.position - DVec3::Z * EYE_M
}
