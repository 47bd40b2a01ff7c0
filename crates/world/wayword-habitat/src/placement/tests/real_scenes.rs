//! Scenes that others made, in 24 rotations, and in eight of them in two other units. Needs the data; without it the test prints that it is skipped.

use super::*;
use std::path::PathBuf;

/// The scenes, and whether they have ceilings. Without them nothing shows the unit.
const SCENES: [(&str, bool); 5] = [
    ("scenes/cube-room/cube-room.gltf", true),
    ("oracles/habitat_frames/flat.glb", true),
    ("oracles/habitat_export/scene/house2-0.glb", true),
    ("oracles/habitat_frames/simple_room.glb", false),
    ("scenes/three_pathfinding_level.glb", false),
];

#[test]
fn real_scenes_are_read_upright_or_asked_about_and_never_where_they_are_as_habitat_has_them() {
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../../shared/data");
    let data = std::env::var_os("WAYWORD_DATA").map_or_else(beside, PathBuf::from);
    for (name, has_ceilings) in SCENES {
        let file = data.join(name);
        if !file.is_file() {
            println!("skipped: there is no {}; set WAYWORD_DATA to the folder that has it", file.display());
            continue;
        }
        let own = HabitatStage::from_file(&file).unwrap();
        // One of them is y-up, without a configuration.
        let y_up = HabitatStage::habitat_from_axes(DVec3::Y, DVec3::NEG_Z);
        let upright = if name.contains("three") { y_up } else { own.habitat_from_asset };
        let mut model = SceneModel::read_shape(&file, upright).unwrap();
        let mut mesh = model.meshes.pop().unwrap();
        for other in model.meshes {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(other.positions);
            mesh.triangles.extend(other.triangles.iter().map(|corners| corners.map(|corner| first + corner)));
        }
        let (mut asked, mut all) = (0, 0);
        for unit in [1.0, 100.0, 1000.0] {
            let step = if unit == 1.0 { 1 } else { 3 };
            for turn in rotations().into_iter().step_by(step) {
                let by = turn * unit;
                all += 1;
                match judge_placement(&moved(&mesh, by), &stage()) {
                    Ok(placement) => {
                        let up = placement.stage.habitat_from_asset * (by * DVec3::Z);
                        assert!((up - DVec3::Y).length() < 1e-6, "{name} {turn} {unit}: {up} {:?}", placement.note);
                        assert!(
                            turn * DVec3::Z != DVec3::Z || unit != 1.0 || placement.note.is_none(),
                            "{:?}",
                            placement.note
                        );
                    }
                    Err(error) => {
                        assert!(!has_ceilings && unit != 1.0, "{name} {turn} {unit}: {error}");
                        asked += 1;
                    }
                }
            }
        }
        println!("{name}: asked about in {asked} of {all} readings");
    }
}
