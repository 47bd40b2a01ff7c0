//! Examines the files of a scene before a run uses them.

use super::{
    files::SceneFiles,
    fit::{self, Misfit},
    graph,
};
use crate::{
    columns::Columns,
    scene::{Model, Stage},
    semantics::{self, SemanticFiles},
};
use wayword_core::{Condition, Fit, GraphSize, Lack, PlatformError, RoomNames, SceneId};

/// Reads a scene's files without decoding its pictures, and reports what they offer and which faults they have.
pub(super) fn examine(id: &SceneId, files: &SceneFiles) -> Result<Condition, PlatformError> {
    let mut condition = Condition {
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
    match fill(&mut condition, files) {
        Ok(()) => {}
        Err(error @ PlatformError::Lost { .. }) => return Err(error),
        Err(PlatformError::File { file, reason, hint }) => {
            condition.unusable = Some(Lack { what: format!("{}: {reason}", file.display()), hint: hint.to_owned() });
        }
        Err(other) => condition.unusable = Some(Lack { what: other.to_string(), hint: String::new() }),
    }
    Ok(condition)
}

/// Fills in the findings, up to the first file that cannot be used.
fn fill(condition: &mut Condition, files: &SceneFiles) -> Result<(), PlatformError> {
    let stage = Stage::of(&files.stage)?;
    let model = Model::shape(&stage.asset, stage.habitat_from_asset)?;
    condition.has_pictures = true;
    match &files.graph {
        Some(file) => {
            let connectivity = graph::connectivity(file)?;
            let built = graph::build(file, &connectivity)?;
            let edges = built.edges().count();
            condition.graph = Some(GraphSize { viewpoints: built.len(), edges });
            let storeys = built.viewpoints().filter_map(|viewpoint| built.level(viewpoint)).max();
            condition.storeys = storeys;
            let judged = fit::judge(&Columns::with_walls(model.triangles()), &connectivity);
            condition.fit = Some(fit_of(&judged));
            condition.unusable = judged.err().map(|Misfit { reason, hint, .. }| Lack {
                what: format!("{}: {reason}", file.display()),
                hint: hint.to_owned(),
            });
        }
        None if files.navmesh(&stage).is_none() => condition.lacks.push(Lack {
            what: "no navmesh beside it, so one is baked from the mesh".to_owned(),
            hint: "put NAME.navmesh beside the scene to walk where Habitat walks".to_owned(),
        }),
        None => {}
    }
    drop(model);
    let semantics = files.semantics(&stage);
    condition.rooms = semantics::check(&semantics, stage.habitat_from_asset)?;
    condition.has_labels = semantics != SemanticFiles::default();
    if !condition.has_labels {
        condition.lacks.push(Lack {
            what: "no labels and no rooms: there are no semantic files beside it".to_owned(),
            hint: "put NAME.semantic.glb with NAME.semantic.txt, or NAME_semantic.ply with NAME.house, beside the \
                   scene where its dataset has them, or let a model see: --see PROVIDER/MODEL"
                .to_owned(),
        });
    }
    Ok(())
}

fn fit_of(judged: &Result<Fit, Misfit>) -> Fit {
    match judged {
        Ok(fit) => *fit,
        Err(misfit) => misfit.fit,
    }
}
