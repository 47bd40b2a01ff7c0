//! Examines the files of a scene before a run uses them.

use super::{
    HabitatOptions,
    files::StageFiles,
    graph,
    graph_fit::{self, GraphMisfit},
    placed::PlacedStage,
};
use crate::{
    scene::SceneModel,
    semantics::{self, SemanticFindings},
    triangle_columns::TriangleColumns,
};
use wayword_core::{GraphFit, GraphSize, PlatformError, RoomNames, SceneCondition, SceneId, SceneLack};

/// Reads a scene's files without decoding the pictures that it is drawn with, and reports what they offer and which faults they have.
pub(super) fn examine_scene(
    id: &SceneId,
    files: &StageFiles,
    options: &HabitatOptions,
) -> Result<SceneCondition, PlatformError> {
    let mut condition = SceneCondition {
        scene: id.clone(),
        has_pictures: false,
        graph: None,
        storeys: None,
        has_labels: false,
        rooms: RoomNames::Unknown,
        fit: None,
        lacks: Vec::new(),
        unusable: None,
    };
    match fill_condition(&mut condition, files, options) {
        Ok(()) => {}
        Err(error @ PlatformError::Lost { .. }) => return Err(error),
        Err(PlatformError::File { file, reason, hint }) => {
            condition.unusable =
                Some(SceneLack { what: format!("{}: {reason}", file.display()), hint: hint.to_owned() });
        }
        Err(other) => condition.unusable = Some(SceneLack { what: other.to_string(), hint: String::new() }),
    }
    Ok(condition)
}

/// Fills in the findings, up to the first file that cannot be used.
fn fill_condition(
    condition: &mut SceneCondition,
    files: &StageFiles,
    options: &HabitatOptions,
) -> Result<(), PlatformError> {
    let PlacedStage { stage, model, notes } = PlacedStage::read(files, options, SceneModel::read_shape)?;
    condition.lacks.extend(notes.into_iter().map(|note| SceneLack { what: note, hint: String::new() }));
    condition.has_pictures = true;
    match &files.graph {
        Some(file) => {
            let connectivity = graph::read_connectivity(file)?;
            let built = graph::build_graph(file, &connectivity)?;
            let edges = built.edges().count();
            condition.graph = Some(GraphSize { viewpoints: built.len(), edges });
            let storeys = built.viewpoints().filter_map(|viewpoint| built.level_of(viewpoint)).max();
            condition.storeys = storeys;
            let judged = graph_fit::judge_fit(&TriangleColumns::with_walls(model.triangles()), &connectivity);
            condition.fit = Some(measured_fit(&judged));
            condition.unusable = judged.err().map(|GraphMisfit { reason, hint, .. }| SceneLack {
                what: format!("{}: {reason}", file.display()),
                hint: hint.to_owned(),
            });
        }
        None if files.navmesh_file(&stage).is_none() => condition.lacks.push(SceneLack {
            what: "no navmesh beside it, so one is baked from the mesh".to_owned(),
            hint: "put NAME.navmesh beside the scene to walk where Habitat walks".to_owned(),
        }),
        None => {}
    }
    drop(model);
    let found = semantics::check_semantics(&files.semantic_files(&stage), stage.habitat_from_asset)?;
    let Some(SemanticFindings { has_labels, rooms, broken_lines, lack }) = found else {
        condition.lacks.push(SceneLack {
            what: "no labels and no rooms: there are no semantic files beside it".to_owned(),
            hint: "put NAME.semantic.glb with NAME.semantic.txt, or NAME_semantic.ply with NAME.house, beside the \
                   scene where its dataset has them, or let a model see: --see PROVIDER/MODEL"
                .to_owned(),
        });
        return Ok(());
    };
    condition.has_labels = has_labels;
    condition.rooms = rooms;
    let hint = "correct these lines to have them";
    condition.lacks.extend(broken_lines.map(|what| SceneLack { what, hint: hint.to_owned() }));
    condition.lacks.extend(lack);
    Ok(())
}

/// How a graph lies in its scene, whether or not that is good enough.
fn measured_fit(judged: &Result<GraphFit, GraphMisfit>) -> GraphFit {
    match judged {
        Ok(fit) => *fit,
        Err(misfit) => misfit.fit,
    }
}
