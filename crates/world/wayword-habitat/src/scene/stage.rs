//! Reads stage configurations: which file a scene is drawn from, and which direction is up in it.

use crate::file_error::{self, FileError};
use glam::{DMat3, DVec3};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// How a stage's file lies in Habitat's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct HabitatStage {
    /// The GLB or glTF file.
    pub asset: PathBuf,
    /// From the file's frame to Habitat's (metres, y up, front is -z).
    pub habitat_from_asset: DMat3,
    /// The navmesh that the configuration names.
    pub navmesh: Option<PathBuf>,
    /// The semantic mesh that it names.
    pub semantics: Option<PathBuf>,
    /// The list of the mesh's objects that it names.
    pub(crate) object_list: Option<PathBuf>,
    /// The configuration, whether or not it exists.
    pub(crate) config: PathBuf,
    /// Whether it tells which direction is up.
    pub(crate) is_up_told: bool,
    /// Whether it tells the length of a unit.
    pub(crate) is_unit_told: bool,
}

/// The fields of a `*.stage_config.json` that are used (Habitat's `StageAttributes`).
#[derive(Deserialize)]
struct StageConfig {
    render_asset: Option<String>,
    up: Option<[f64; 3]>,
    front: Option<[f64; 3]>,
    units_to_meters: Option<f64>,
    nav_asset: Option<String>,
    semantic_asset: Option<String>,
    semantic_descriptor_filename: Option<String>,
    /// Habitat's factors for the picture of a stage, along its three axes. Habitat scales neither labels nor the navmesh by them.
    scale: Option<[f64; 3]>,
}

const STAGE_CONFIG_HINT: &str = "see Habitat's documentation of stage_config.json";
/// Largest configuration that is read, bytes; a larger one is an error.
const MAX_BYTES: u64 = 1 << 20;
const SCALE_HINT: &str = "remove scale and export the scene in its own size; where scale is one number, units_to_meters can have \
    that number instead, but habitat-sim does not apply it";
const STAGE_CONFIG_ENDING: &str = ".stage_config.json";

impl HabitatStage {
    /// The stage of a file: a configuration, or a GLB or glTF file, which may have a configuration in its folder. If it tells
    /// no axes, those of Habitat's rule are read.
    ///
    /// # Errors
    /// If there is a configuration and it cannot be read, or if the given configuration does not exist.
    pub fn from_file(file: &Path) -> Result<Self, FileError> {
        let name = file.file_name().and_then(|name| name.to_str()).unwrap_or_default();
        let config = if name.ends_with(STAGE_CONFIG_ENDING) {
            file.to_owned()
        } else {
            file.with_file_name(format!("{}{STAGE_CONFIG_ENDING}", scene_stem(name)))
        };
        match file_error::text_if_there(&config, MAX_BYTES, STAGE_CONFIG_HINT)? {
            Some(text) => Self::parse(&config, file, &text),
            None if name.ends_with(STAGE_CONFIG_ENDING) => {
                Err(FileError::new(file, "there is no such file", STAGE_CONFIG_HINT))
            }
            None => {
                let (up, front) = default_axes(file);
                Ok(Self {
                    asset: file.to_owned(),
                    habitat_from_asset: Self::habitat_from_axes(up, front),
                    navmesh: None,
                    semantics: None,
                    object_list: None,
                    config,
                    is_up_told: false,
                    is_unit_told: false,
                })
            }
        }
    }

    fn parse(config: &Path, file: &Path, text: &str) -> Result<Self, FileError> {
        let wrong = |reason: String| FileError::new(config, reason, STAGE_CONFIG_HINT);
        let fields: StageConfig = serde_json::from_str(text).map_err(|error| wrong(error.to_string()))?;
        let axis = |field: &str, given: Option<[f64; 3]>, default: DVec3| {
            let axis = given.map_or(default, DVec3::from);
            let length = axis.length();
            let usable = length.is_finite() && length > 1e-6;
            usable.then(|| axis / length).ok_or_else(|| wrong(format!("{field} is not a direction: {axis}")))
        };
        let beside = |name: &str| config.parent().unwrap_or(Path::new("")).join(name);
        let asset = match &fields.render_asset {
            Some(name) => beside(name),
            None if file != config => file.to_owned(),
            None => return Err(wrong("has no render_asset".to_owned())),
        };
        let named = |name: Option<String>| name.filter(|name| !name.is_empty()).map(|name| beside(&name));
        let (up, front) = default_axes(&asset);
        let (up, front) = (axis("up", fields.up, up)?, axis("front", fields.front, front)?);
        if front.cross(up).length() < 1e-6 {
            return Err(wrong(format!("front {front} is parallel to up {up}")));
        }
        if let Some(scale) = fields.scale.filter(|scale| *scale != [1.0; 3]) {
            let reason = format!("scale is {scale:?}; only a scale of 1 can be read");
            return Err(FileError::new(config, reason, SCALE_HINT));
        }
        let scale = fields.units_to_meters.unwrap_or(1.0);
        if !(scale.is_finite() && (1e-6..=1e6).contains(&scale)) {
            return Err(wrong(format!("units_to_meters is {scale}, expected a positive number")));
        }
        Ok(Self {
            asset,
            habitat_from_asset: Self::habitat_from_axes(up, front) * scale,
            navmesh: named(fields.nav_asset),
            semantics: named(fields.semantic_asset),
            object_list: named(fields.semantic_descriptor_filename),
            config: config.to_owned(),
            is_up_told: fields.up.is_some() || fields.front.is_some(),
            is_unit_told: fields.units_to_meters.is_some(),
        })
    }

    /// What the user should know of the files that the configuration names and that cannot be used. `reads_navmesh` tells whether a
    /// navmesh would be read at all.
    pub(crate) fn describe_unusable_files(&self, reads_navmesh: bool) -> Vec<String> {
        let named = [
            ("nav_asset", self.navmesh.as_ref().filter(|_| reads_navmesh), &["navmesh"][..]),
            ("semantic_asset", self.semantics.as_ref(), &["glb", "gltf", "ply"]),
            ("semantic_descriptor_filename", self.object_list.as_ref(), &["txt", "house"]),
        ];
        let describe = |(field, file, endings): (&str, Option<&PathBuf>, &[&str])| {
            let file = file?;
            let fault = match endings.iter().any(|ending| has_ending(file, ending)) {
                true if file.is_file() => return None,
                true => "which is not there".to_owned(),
                false => format!("which is no .{} file", endings.join(" or .")),
            };
            Some(format!(
                "{}: {field} names {}, {fault}; correct or remove {field}: without it, the file beside the scene with \
                 the scene's name is read where there is one",
                self.config.display(),
                file.display()
            ))
        };
        named.into_iter().filter_map(describe).collect()
    }

    /// The rotation that takes `up` to +y and `front` to -z.
    pub(crate) fn habitat_from_axes(up: DVec3, front: DVec3) -> DMat3 {
        let right = front.cross(up).normalize();
        let front = up.cross(right);
        DMat3::from_cols(right, up, -front).transpose()
    }

    /// The direction in the file that is up, of length 1.
    pub(crate) fn up(&self) -> DVec3 {
        self.habitat_from_asset.row(1).normalize()
    }

    /// The direction in the file that is in front, of length 1.
    pub(crate) fn front(&self) -> DVec3 {
        -self.habitat_from_asset.row(2).normalize()
    }

    /// The length of the file's unit, metres.
    pub(crate) fn units_to_meters(&self) -> f64 {
        self.habitat_from_asset.row(1).length()
    }
}

/// Up and front of a file without a configuration, as Habitat has them: z and y for a `.glb`, y and -z for a `.gltf`
/// (`StageAttributesManager.cpp`, `setDefaultAssetNameBasedAttributes`).
fn default_axes(asset: &Path) -> (DVec3, DVec3) {
    if has_ending(asset, "gltf") { (DVec3::Y, DVec3::NEG_Z) } else { (DVec3::Z, DVec3::Y) }
}

/// Whether a file's name has an ending, such as `glb`.
pub(crate) fn has_ending(file: &Path, ending: &str) -> bool {
    file.extension().is_some_and(|own| own == ending)
}

/// A file's name without the ending for its format; `x.basis.glb` and `x.glb` both give `x`.
pub(crate) fn scene_stem(name: &str) -> &str {
    let name = [".glb", ".gltf", ".navmesh", STAGE_CONFIG_ENDING]
        .iter()
        .find_map(|ending| name.strip_suffix(ending))
        .unwrap_or(name);
    name.strip_suffix(".basis").unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stage(text: &str) -> Result<HabitatStage, String> {
        HabitatStage::parse(Path::new("a/x.stage_config.json"), Path::new("a/x.glb"), text)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn stage_axes_turn_up_and_front_to_habitats() {
        let z_up = stage("{}").unwrap();
        assert_eq!(z_up.asset, Path::new("a/x.glb"));
        assert_eq!(z_up.habitat_from_asset * DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 3.0, -2.0));
        let y_up = stage(r#"{"render_asset": "y.glb", "up": [0, 1, 0], "front": [0, 0, -1], "units_to_meters": 0.5}"#)
            .unwrap();
        assert_eq!(y_up.asset, Path::new("a/y.glb"));
        assert_eq!(y_up.habitat_from_asset * DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.5, 1.0, 1.5));
    }

    #[test]
    fn without_axes_a_glb_has_z_up_and_a_gltf_y_up() {
        let up = |name: &str| HabitatStage::from_file(Path::new(name)).unwrap().up();
        assert_eq!([up("nowhere/x.glb"), up("nowhere/x.gltf")], [DVec3::Z, DVec3::Y]);
        let of = |asset: &str| stage(&format!(r#"{{"render_asset": "{asset}", "units_to_meters": 2}}"#)).unwrap();
        let (glb, gltf) = (of("y.glb"), of("y.gltf"));
        assert_eq!(
            [(glb.up(), glb.front()), (gltf.up(), gltf.front())],
            [(DVec3::Z, DVec3::Y), (DVec3::Y, DVec3::NEG_Z)]
        );
        assert_eq!((glb.units_to_meters(), glb.is_up_told, glb.is_unit_told), (2.0, false, true));
    }

    #[test]
    fn stage_config_refuses_unusable_axes() {
        assert!(stage(r#"{"up": [0, 0, 0]}"#).unwrap_err().contains("up is not a direction"));
        assert!(stage(r#"{"up": [0, 1, 0]}"#).unwrap_err().contains("is parallel to up"));
        assert!(stage(r#"{"units_to_meters": 0}"#).unwrap_err().contains("units_to_meters is 0"));
        assert!(stage("{").unwrap_err().starts_with("a/x.stage_config.json: "));
    }

    #[test]
    fn a_scale_is_refused_and_an_origin_changes_nothing_as_in_habitat() {
        for scale in ["[2, 2, 2]", "[1, 1, 0.5]", "[-1, 1, 1]"] {
            let error = stage(&format!(r#"{{"scale": {scale}}}"#)).unwrap_err();
            assert!(error.contains("x.stage_config.json: scale is [") && error.contains("units_to_meters"), "{error}");
        }
        assert_eq!(stage(r#"{"scale": [1, 1, 1], "origin": [1, 2, 3]}"#), stage("{}"));
    }

    #[test]
    fn named_files_that_cannot_be_used_are_told() {
        let folder = tempfile::tempdir().unwrap();
        let config = folder.path().join("x.stage_config.json");
        std::fs::write(folder.path().join("there.navmesh"), "").unwrap();
        let told = |fields: &str| {
            let stage = HabitatStage::parse(&config, &folder.path().join("x.glb"), fields).unwrap();
            stage.describe_unusable_files(true)
        };
        assert_eq!(told(r#"{"nav_asset": "there.navmesh", "semantic_asset": ""}"#), [""; 0]);
        for (field, name, fault) in [
            ("nav_asset", "nosuch.navmesh", "which is not there"),
            ("nav_asset", "there", "which is no .navmesh file"),
            ("semantic_asset", "nosuch.glb", "which is not there"),
            ("semantic_asset", "nosuch", "which is no .glb or .gltf or .ply file"),
            ("semantic_descriptor_filename", "nosuch.txt", "which is not there"),
            ("semantic_descriptor_filename", "info.json", "which is no .txt or .house file"),
        ] {
            let all = told(&format!(r#"{{"{field}": "{name}"}}"#));
            let [only] = &all[..] else { panic!("{all:?}") };
            assert!(only.contains(&format!("{field} names ")) && only.contains(&format!("{name}, {fault}")), "{only}");
        }
        let graph = HabitatStage::parse(&config, &config, r#"{"render_asset": "x.glb", "nav_asset": "a.navmesh"}"#);
        assert_eq!(graph.unwrap().describe_unusable_files(false), [""; 0], "the graph shows the ways");
    }

    #[test]
    fn stems_leave_out_the_format() {
        assert_eq!(["a.basis.glb", "a.glb", "a.b.gltf", "a"].map(scene_stem), ["a", "a", "a.b", "a"]);
    }
}
