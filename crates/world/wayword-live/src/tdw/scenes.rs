//! The scenes that a build can load: TDW's floor plans, and procedural rooms.

use super::{
    commands::{BuildCommand, GridPoint, TdwVector3},
    error::TdwError,
};
use serde::Deserialize;
use std::{
    collections::BTreeMap,
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};
use wayword_core::SceneId;

/// Floor plans that TDW has, by their structure and look (`tdw/add_ons/floorplan.py`).
const FLOOR_PLANS: [&str; 12] = ["1a", "1b", "1c", "2a", "2b", "2c", "4a", "4b", "4c", "5a", "5b", "5c"];
/// Furniture layouts of each floor plan.
const FURNITURE_LAYOUTS: [&str; 3] = ["0", "1", "2"];
/// The one procedural scene in the list of scenes; other sizes are available by name.
const LISTED_ROOM: &str = "room_8x10";
/// Lengths that the sides of a procedural room may have, metres.
const SIDES_M: std::ops::RangeInclusive<u32> = 3..=40;
/// Largest file of the Python package that is read, bytes.
const MAX_FILE_BYTES: u64 = 32 << 20;

/// A scene, parsed from its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum TdwScenePlan {
    /// `floorplan_1a`, or with furniture `floorplan_1a_0`.
    Floor { scene: String, layout: Option<String> },
    /// `room_8x10`: two rooms side by side, without furniture.
    Room { width_m: u32, length_m: u32 },
}

/// The names of the floor plans without furniture.
#[cfg(feature = "stand-in")]
pub(super) fn floor_plan_names() -> Vec<String> {
    FLOOR_PLANS.map(|plan| format!("floorplan_{plan}")).to_vec()
}

/// The names of all listed scenes. Floor plans are furnished where the lists of furniture are available.
pub(super) fn scene_names(package: Option<&Path>) -> Vec<String> {
    let furnished = |plan: &str| FURNITURE_LAYOUTS.map(|layout| format!("floorplan_{plan}_{layout}")).to_vec();
    let mut names: Vec<String> = match package {
        Some(_) => FLOOR_PLANS.iter().flat_map(|plan| furnished(plan)).collect(),
        None => FLOOR_PLANS.iter().map(|plan| format!("floorplan_{plan}")).collect(),
    };
    names.push(LISTED_ROOM.to_owned());
    names
}

impl TdwScenePlan {
    /// The plan for a scene's name; `None` if no scene is called so.
    pub(super) fn for_scene(scene: &SceneId) -> Option<Self> {
        if let Some(rest) = scene.as_str().strip_prefix("floorplan_") {
            let (plan, layout) = rest.split_once('_').map_or((rest, None), |(plan, layout)| (plan, Some(layout)));
            let is_known =
                FLOOR_PLANS.contains(&plan) && layout.is_none_or(|layout| FURNITURE_LAYOUTS.contains(&layout));
            let scene = format!("floorplan_{plan}");
            return is_known.then(|| Self::Floor { scene, layout: layout.map(str::to_owned) });
        }
        let (width, length) = scene.as_str().strip_prefix("room_")?.split_once('x')?;
        let side =
            |text: &str| text.parse().ok().filter(|side: &u32| SIDES_M.contains(side) && side.to_string() == text);
        Some(Self::Room { width_m: side(width)?, length_m: side(length)? })
    }

    /// The commands that load it.
    ///
    /// # Errors
    /// When the lists of its furniture cannot be read.
    pub(super) fn load_commands(&self, package: Option<&Path>) -> Result<Vec<BuildCommand>, TdwError> {
        match self {
            Self::Room { width_m, length_m } => Ok(room_commands(*width_m, *length_m)),
            Self::Floor { scene, layout } => {
                let url = format!("https://tdw-public.s3.amazonaws.com/scenes/{}/2020.3/{scene}", system_names().0);
                let mut commands = vec![BuildCommand::AddScene { name: scene.clone(), url }];
                if let Some(layout) = layout {
                    let package = package.ok_or_else(|| {
                        TdwError::Package(format!("the furniture of {scene}_{layout} is not available"))
                    })?;
                    commands.extend(FurniturePackage::from_package(package)?.placement_commands(scene, layout)?);
                }
                Ok(commands)
            }
        }
    }
}

/// The operating system's name in the scenes' addresses, and in the records of 3D models. The build is assumed to run on
/// this machine.
fn system_names() -> (&'static str, &'static str) {
    match std::env::consts::OS {
        "macos" => ("osx", "Darwin"),
        "windows" => ("windows", "Windows"),
        _ => ("linux", "Linux"),
    }
}

/// A box of walls. Where it is large enough, a wall across it with a gap of two metres makes two rooms.
fn room_commands(width: u32, length: u32) -> Vec<BuildCommand> {
    let bottom = (0..=width).map(|x| GridPoint { x, y: 0 });
    let top = (0..=width).map(|x| GridPoint { x, y: length });
    let left = (1..length).map(|y| GridPoint { x: 0, y });
    let right = (1..length).map(|y| GridPoint { x: width, y });
    let mut commands = vec![
        BuildCommand::LoadScene { scene_name: "ProcGenScene".to_owned() },
        BuildCommand::CreateExteriorWalls { walls: bottom.chain(top).chain(left).chain(right).collect() },
    ];
    if length >= 6 && width >= 4 {
        let gap = width / 2 - 1..=width / 2;
        let walls = (1..width).filter(|x| !gap.contains(x)).map(|x| GridPoint { x, y: length / 2 });
        commands.push(BuildCommand::CreateInteriorWalls { walls: walls.collect() });
    }
    commands.push(BuildCommand::CreateProcGenCeiling);
    commands.push(BuildCommand::BakeNavMesh { voxel_size: 0.166_666_7, carve_type: "all", ignore: Vec::new() });
    commands
}

/// The lists of furniture in the Python package `tdw`.
struct FurniturePackage {
    /// Pieces by structure ("1"), then by layout.
    layouts: BTreeMap<String, BTreeMap<String, Vec<PlacedFurniture>>>,
    package: PathBuf,
}

/// A piece of a layout, as the package lists it.
#[derive(Debug, Clone, Deserialize)]
struct PlacedFurniture {
    name: String,
    library: String,
    position: LayoutVector,
    rotation: LayoutVector,
    scale_factor: LayoutVector,
}

/// A vector as the package writes it.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
struct LayoutVector {
    x: f64,
    y: f64,
    z: f64,
}

/// A list of 3D models, as the package has it.
#[derive(Deserialize)]
struct TdwModelLibrary {
    records: BTreeMap<String, TdwModelRecord>,
}

/// A 3D model: its address by operating system, its scale and its category.
#[derive(Deserialize)]
struct TdwModelRecord {
    urls: BTreeMap<String, String>,
    scale_factor: f64,
    wcategory: String,
}

impl From<LayoutVector> for TdwVector3 {
    fn from(LayoutVector { x, y, z }: LayoutVector) -> Self {
        Self { x, y, z }
    }
}

/// Reads a JSON file of the package.
fn read_json<T: for<'de> Deserialize<'de>>(file: &Path) -> Result<T, TdwError> {
    let refused = |reason: String| TdwError::Package(format!("{}: {reason}", file.display()));
    let mut text = String::new();
    let opened = File::open(file).and_then(|file| file.take(MAX_FILE_BYTES).read_to_string(&mut text));
    opened.map_err(|error| refused(error.to_string()))?;
    // Python writes NaN, which JSON does not have; the package's lists contain a few.
    let text = text.replace(": NaN", ": null");
    serde_json::from_str(&text).map_err(|error| refused(error.to_string()))
}

impl FurniturePackage {
    fn from_package(package: &Path) -> Result<Self, TdwError> {
        let layouts = read_json(&package.join("add_ons").join("floorplan_layouts.json"))?;
        Ok(Self { layouts, package: package.to_owned() })
    }

    /// Commands that place each piece where the layout has it, and fix it there so that pictures of it are always the
    /// same. Pieces are numbered from 1.
    fn placement_commands(&self, scene: &str, layout: &str) -> Result<Vec<BuildCommand>, TdwError> {
        let structure = scene.trim_start_matches("floorplan_").get(..1).unwrap_or_default();
        let pieces = self.layouts.get(structure).and_then(|layouts| layouts.get(layout));
        let pieces =
            pieces.ok_or_else(|| TdwError::Scene(format!("the package tdw has no layout {layout} of {scene}")))?;
        let mut libraries: BTreeMap<&str, TdwModelLibrary> = BTreeMap::new();
        let mut commands = Vec::new();
        for (piece, id) in pieces.iter().zip(1..) {
            if !libraries.contains_key(piece.library.as_str()) {
                libraries.insert(&piece.library, self.read_library(&piece.library)?);
            }
            let record = libraries.get(piece.library.as_str()).and_then(|library| library.records.get(&piece.name));
            let url = record.and_then(|record| record.urls.get(system_names().1));
            let (Some(record), Some(url)) = (record, url) else {
                let at = format!("{} of {}", piece.name, piece.library);
                return Err(TdwError::Scene(format!("the package tdw has no 3D model {at} for this system")));
            };
            commands.push(BuildCommand::AddObject {
                name: piece.name.clone(),
                url: url.clone(),
                scale_factor: record.scale_factor,
                position: piece.position.into(),
                rotation: piece.rotation.into(),
                category: record.wcategory.clone(),
                id,
                affordance_points: Vec::new(),
            });
            if piece.scale_factor != (LayoutVector { x: 1.0, y: 1.0, z: 1.0 }) {
                commands.push(BuildCommand::ScaleObject { scale_factor: piece.scale_factor.into(), id });
            }
            commands.push(BuildCommand::SetKinematicState { id, is_kinematic: true, use_gravity: false });
        }
        Ok(commands)
    }

    /// A library's records. The name comes from a file, so a name that leads out of the folder is refused.
    fn read_library(&self, name: &str) -> Result<TdwModelLibrary, TdwError> {
        if name.contains(['/', '\\']) || name.starts_with('.') {
            return Err(TdwError::Package(format!("the package tdw names a library {name:?}: expected a file name")));
        }
        read_json(&self.package.join("metadata_libraries").join(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(name: &str) -> Option<TdwScenePlan> {
        TdwScenePlan::for_scene(&SceneId::new(name).unwrap())
    }

    #[test]
    fn plan_exists_for_every_listed_scene_and_no_other_name() {
        for name in scene_names(None).into_iter().chain(scene_names(Some(Path::new("tdw")))) {
            assert!(plan(&name).is_some(), "{name}");
        }
        for name in
            ["floorplan_3a", "floorplan_1a_3", "floorplan_", "room_2x8", "room_08x8", "room_8x999", "room_8", "x"]
        {
            assert_eq!(plan(name), None, "{name}");
        }
    }

    #[test]
    fn a_room_is_closed_and_its_inner_wall_is_not() {
        let commands = plan("room_8x10").unwrap().load_commands(None).unwrap();
        let BuildCommand::CreateExteriorWalls { walls } = &commands[1] else { panic!("{commands:?}") };
        assert_eq!(walls.len(), 2 * (8 + 10), "the perimeter, each point once");
        let BuildCommand::CreateInteriorWalls { walls } = &commands[2] else { panic!("{commands:?}") };
        assert!(walls.iter().all(|point| point.y == 5) && walls.len() == 5);
    }

    #[test]
    fn commands_place_furniture_at_the_packages_positions() {
        let package = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            std::fs::create_dir_all(package.path().join(name).parent().unwrap()).unwrap();
            std::fs::write(package.path().join(name), text).unwrap();
        };
        let place = r#"{"x":1,"y":0.5,"z":-2}"#;
        let one = r#"{"x":1,"y":1,"z":1}"#;
        let piece = format!(
            r#"{{"name":"sofa_a","library":"models_core.json","position":{place},"rotation":{place},"scale_factor":{one}}}"#
        );
        write("add_ons/floorplan_layouts.json", &format!(r#"{{"1":{{"0":[{piece}]}}}}"#));
        let urls = r#"{"Linux":"u","Darwin":"u","Windows":"u"}"#;
        write(
            "metadata_libraries/models_core.json",
            &format!(
                r#"{{"records":{{"sofa_a":{{"urls":{urls},"physics_quality": NaN,"scale_factor":1.0,"wcategory":"sofa"}}}}}}"#
            ),
        );
        let commands = plan("floorplan_1a_0").unwrap().load_commands(Some(package.path())).unwrap();
        let BuildCommand::AddObject { category, position, id, .. } = &commands[1] else { panic!("{commands:?}") };
        assert_eq!((category.as_str(), position.z, *id), ("sofa", -2.0, 1));
        let unfurnished = plan("floorplan_1a_0").unwrap().load_commands(None).unwrap_err();
        assert!(matches!(&unfurnished, TdwError::Package(_)), "{unfurnished}");
        let elsewhere = plan("floorplan_1a_0").unwrap().load_commands(Some(Path::new("nowhere"))).unwrap_err();
        assert!(matches!(&elsewhere, TdwError::Package(_)), "{elsewhere}");
        let missing = plan("floorplan_1a_1").unwrap().load_commands(Some(package.path())).unwrap_err().to_string();
        assert!(missing.contains("no layout 1"), "{missing}");
    }
}
