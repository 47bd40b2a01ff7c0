//! Reads the mesh of a scene as it lies. Where nothing else says where its floor is, that is judged.

use super::{HabitatOptions, files::StageFiles};
use crate::{
    bake::check_model_size,
    file_error::FileError,
    navmesh::NavMeshSettings,
    placement::judge_placement,
    scene::{HabitatStage, SceneModel},
};
use glam::DMat3;
use std::path::Path;

/// A stage and its mesh, in the axes and the unit in which they are read.
pub(super) struct PlacedStage {
    pub(super) stage: HabitatStage,
    pub(super) model: SceneModel,
    /// What the user should know: files that its configuration names in vain, and what was decided against Habitat's rule.
    pub(super) notes: Vec<String>,
}

impl PlacedStage {
    /// Reads a stage with a reader of its file, such as [`SceneModel::read_file`]. A scene with a graph or a navmesh is read as its
    /// configuration or Habitat's rule says.
    pub(super) fn read(
        files: &StageFiles,
        options: &HabitatOptions,
        read: impl Fn(&Path, DMat3) -> Result<SceneModel, FileError>,
    ) -> Result<Self, FileError> {
        let stage = HabitatStage::from_file(&files.stage)?;
        let model = read(&stage.asset, stage.habitat_from_asset)?;
        let is_walked_otherwise = files.graph.is_some() || options.navmesh.is_some();
        let mut notes = stage.describe_unusable_files(!is_walked_otherwise);
        let has_ways = is_walked_otherwise || files.navmesh_file(&stage).is_some();
        if has_ways {
            return Ok(Self { stage, model, notes });
        }
        let placement = judge_placement(&model, &stage)?;
        let model = if placement.stage == stage {
            model
        } else {
            drop(model);
            read(&placement.stage.asset, placement.stage.habitat_from_asset)?
        };
        check_model_size(&model, &NavMeshSettings::default())
            .map_err(|error| FileError::new(&stage.asset, error.to_string(), error.hint()))?;
        notes.extend(placement.note);
        Ok(Self { stage: placement.stage, model, notes })
    }
}
