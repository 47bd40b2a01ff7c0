//! Examines every scene of the data for `wayword doctor --scenes`: pictures, graph, labels, rooms, and the files that are
//! missing.

use super::{Finding, Grade, problem};
use std::collections::BTreeMap;
use wayword_core::{Condition, GraphSize, Lack};
use wayword_run::{count::count, error::Error, output::Output, platforms, settings::Settings, usable::examined};

/// Examines the scenes of a platform's data, and marks those that cannot be used as left out in the settings.
pub(super) fn examine(settings: &mut Settings, output: &Output) -> Result<Vec<Condition>, Error> {
    let platform = platforms::open(settings)?;
    let conditions = examined(&platform.candidates()?, platform.as_ref(), output)?;
    if conditions.is_empty() {
        let problem = format!("the scenes of platform {} cannot be examined before they are used", settings.platform);
        return Err(Error::usage(problem, "leave --scenes out: without it, one view of the platform is checked"));
    }
    let bad = conditions.iter().filter_map(|found| Some((found.scene.to_string(), found.unusable.clone()?)));
    settings.left_out = bad.collect::<BTreeMap<String, Lack>>();
    Ok(conditions)
}

/// A finding for each scene, and one for all of them.
pub(super) fn findings(examined: &Result<Vec<Condition>, Error>) -> Vec<Finding> {
    let conditions = match examined {
        Ok(conditions) => conditions,
        Err(error) => return vec![problem("scenes", error)],
    };
    let good = conditions.iter().filter(|found| found.unusable.is_none()).count();
    let mut findings: Vec<Finding> = conditions.iter().flat_map(of_scene).collect();
    findings.push(Finding {
        state: if good == 0 { Grade::Problem } else { Grade::Ok },
        about: "scenes".to_owned(),
        told: format!("{good} of {} can be used", count(conditions.len(), "scene")),
        hint: None,
    });
    findings
}

fn of_scene(found: &Condition) -> Vec<Finding> {
    let about = format!("scene {}", found.scene);
    let of = |state, lack: &Lack| Finding {
        state,
        about: about.clone(),
        told: lack.what.clone(),
        hint: (!lack.hint.is_empty()).then(|| lack.hint.clone()),
    };
    if let Some(why) = &found.unusable {
        return vec![of(Grade::Problem, why)];
    }
    let has = Finding { state: Grade::Ok, about: about.clone(), told: told(found), hint: None };
    let lacks = found.lacks.iter().map(|lack| of(Grade::Warning, lack));
    std::iter::once(has).chain(lacks).collect()
}

/// Lists the contents of a scene in words.
fn told(found: &Condition) -> String {
    let mut parts = vec![if found.has_pictures { "pictures" } else { "no pictures" }.to_owned()];
    if let Some(GraphSize { viewpoints, edges }) = found.graph {
        parts.push(format!("a graph of {} and {}", count(viewpoints, "viewpoint"), count(edges, "edge")));
    }
    parts.extend(found.storeys.map(|storeys| count(storeys as usize, "storey")));
    parts.push(if found.has_labels { "labels" } else { "no labels" }.to_owned());
    parts.push(found.rooms.to_string());
    parts.extend(found.fit.map(|fit| fit.to_string()));
    parts.join(", ")
}
