//! Reads test cases with the figures that another program computed for them.

use serde_json::Value;
use std::collections::BTreeSet;
use wayword_core::{ObjectId, ViewpointId};
use wayword_metrics::{AgentTrajectory, EpisodeDemand, TrajectoryScore};

/// How far figures may differ, because the other program adds numbers in another order.
const TOLERANCE: f64 = 1e-9;

pub(crate) fn viewpoints<'a, C: FromIterator<ViewpointId>>(ids: impl IntoIterator<Item = &'a Value>) -> C {
    ids.into_iter().map(|id| ViewpointId::new(id.as_str().unwrap()).unwrap()).collect()
}

pub(crate) fn object(id: &Value) -> Option<ObjectId> {
    id.as_str().map(|id| ObjectId::new(id).unwrap())
}

pub(crate) fn demand(case: &Value, visible_from: Option<BTreeSet<ViewpointId>>) -> EpisodeDemand {
    let reference = viewpoints(case["reference"].as_array().unwrap());
    EpisodeDemand { reference, object: object(&case["object"]), visible_from }
}

pub(crate) fn trajectory(case: &Value) -> AgentTrajectory {
    AgentTrajectory { viewpoints: viewpoints(case["trajectory"].as_array().unwrap()), object: object(&case["named"]) }
}

/// Asserts that the figures are the expected ones, no more and no less.
pub(crate) fn assert_agrees(score: &TrajectoryScore, expected: &Value, case: &str) {
    let found = serde_json::to_value(score).unwrap();
    assert_same(&found, expected, case);
}

fn assert_same(found: &Value, expected: &Value, place: &str) {
    match (found, expected) {
        (Value::Object(found), Value::Object(expected)) => {
            assert_eq!(found.keys().collect::<BTreeSet<_>>(), expected.keys().collect(), "{place}");
            for (name, found) in found {
                assert_same(found, &expected[name], &format!("{place}: {name}"));
            }
        }
        (Value::Number(found), Value::Number(expected)) => {
            let [found, expected] = [found, expected].map(|number| number.as_f64().unwrap());
            assert!((found - expected).abs() < TOLERANCE, "{place}: {found} and not {expected}");
        }
        _ => assert_eq!(found, expected, "{place}"),
    }
}
