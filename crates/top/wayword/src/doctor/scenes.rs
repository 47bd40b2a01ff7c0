//! Examines every scene of the data for `wayword doctor --scenes`: pictures, graph, labels, rooms, and the files that are
//! missing.

use super::{DoctorFinding, DoctorGrade, problem_finding};
use std::collections::BTreeMap;
use wayword_core::{GraphSize, SceneCondition, SceneLack};
use wayword_run::{
    count::count_phrase, error::CommandError, output::CommandOutput, platforms, scene_selection::examine_scenes,
    settings::RunSettings,
};

/// Examines the scenes of a platform's data, and marks those that cannot be used as left out in the settings.
pub(super) fn examine_run_scenes(
    settings: &mut RunSettings,
    output: &CommandOutput,
) -> Result<Vec<SceneCondition>, CommandError> {
    let platform = platforms::open_platform(settings)?;
    let conditions = examine_scenes(&platform.files().candidate_scenes()?, platform.as_ref(), output)?;
    if conditions.is_empty() {
        let problem = format!("the scenes of platform {} cannot be examined before they are used", settings.platform);
        return Err(CommandError::usage(
            problem,
            "leave --scenes out: without it, one view of the platform is checked",
        ));
    }
    let bad = conditions.iter().filter_map(|found| Some((found.scene.to_string(), found.unusable.clone()?)));
    settings.left_out = bad.collect::<BTreeMap<String, SceneLack>>();
    Ok(conditions)
}

/// A finding for each scene, and one for all of them.
pub(super) fn scene_findings(examined: &Result<Vec<SceneCondition>, CommandError>) -> Vec<DoctorFinding> {
    let conditions = match examined {
        Ok(conditions) => conditions,
        Err(error) => return vec![problem_finding("scenes", error)],
    };
    let good = conditions.iter().filter(|found| found.unusable.is_none()).count();
    let mut findings: Vec<DoctorFinding> = conditions.iter().flat_map(findings_for_scene).collect();
    findings.push(DoctorFinding {
        state: if good == 0 { DoctorGrade::Problem } else { DoctorGrade::Ok },
        about: "scenes".to_owned(),
        told: format!("{good} of {} can be used", count_phrase(conditions.len(), "scene")),
        hint: None,
    });
    findings
}

/// A finding for a scene, and one for each thing that it lacks.
fn findings_for_scene(found: &SceneCondition) -> Vec<DoctorFinding> {
    let about = format!("scene {}", found.scene);
    let lack_finding = |state, lack: &SceneLack| DoctorFinding {
        state,
        about: about.clone(),
        told: lack.what.clone(),
        hint: (!lack.hint.is_empty()).then(|| lack.hint.clone()),
    };
    if let Some(why) = &found.unusable {
        return vec![lack_finding(DoctorGrade::Problem, why)];
    }
    let has =
        DoctorFinding { state: DoctorGrade::Ok, about: about.clone(), told: describe_condition(found), hint: None };
    let lacks = found.lacks.iter().map(|lack| lack_finding(DoctorGrade::Warning, lack));
    std::iter::once(has).chain(lacks).collect()
}

/// Lists the contents of a scene in words.
fn describe_condition(found: &SceneCondition) -> String {
    let mut parts = vec![if found.has_pictures { "pictures" } else { "no pictures" }.to_owned()];
    if let Some(GraphSize { viewpoints, edges }) = found.graph {
        parts.push(format!("a graph of {} and {}", count_phrase(viewpoints, "viewpoint"), count_phrase(edges, "edge")));
    }
    parts.extend(found.storeys.map(|storeys| count_phrase(storeys as usize, "storey")));
    parts.push(if found.has_labels { "labels" } else { "no labels" }.to_owned());
    parts.push(found.rooms.to_string());
    parts.extend(found.fit.map(|fit| fit.to_string()));
    parts.join(", ")
}
