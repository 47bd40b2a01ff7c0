//! Writes the labels of a view as the JSON of a structured answer, so that labels can stand in for a model.

use crate::seeing::FAR_M;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use wayword_core::{GroundTruth, ObjectLabel, View, ViewThird};
use wayword_language::lexicon::{ThingClass, find_thing, to_plural};

/// Most entries for things in the answer, the nearest first; farther ones are left out.
const MAX_LISTED_THINGS: usize = 14;

/// The labels of a view as JSON in the form of [`crate::seeing::VIEW_SCHEMA`].
pub(super) fn labels_as_json(view: &View, truth: &GroundTruth) -> String {
    let mut labels: Vec<(&ObjectLabel, ViewThird)> =
        truth.labels.iter().map(|label| (label, third_of_view(view, label))).collect();
    let distance = |label: &ObjectLabel| label.distance_m.unwrap_or(f64::INFINITY);
    labels.sort_by(|(a, _), (b, _)| distance(a).total_cmp(&distance(b)));
    let mut counts: BTreeMap<(&str, ViewThird), usize> = BTreeMap::new();
    for (label, place) in &labels {
        *counts.entry((&label.name, *place)).or_default() += 1;
    }
    let is_door = |label: &ObjectLabel| {
        matches!(find_thing(&label.name).map(|thing| thing.class), Some(ThingClass::Door | ThingClass::Stairs))
    };
    let ways: Vec<Value> = labels
        .iter()
        .filter(|(label, _)| is_door(label))
        .map(|(label, place)| json!({ "kind": label.name, "side": place, "leads_to": "unknown" }))
        .collect();
    let mut things: Vec<Value> = Vec::new();
    for (label, place) in labels {
        let Some(count) = counts.remove(&(label.name.as_str(), place)) else { continue };
        let far = if label.distance_m.is_some_and(|metres| metres > FAR_M) { "far" } else { "near" };
        things.push(json!({
            "name": if count > 1 { to_plural(&label.name) } else { label.name.clone() },
            "colours": label.colour.iter().collect::<Vec<_>>(),
            "material": "",
            "detail": "",
            "side": place,
            "distance": far,
            "sure": "sure",
        }));
    }
    things.truncate(MAX_LISTED_THINGS);
    let room = truth.room.as_deref().unwrap_or("unknown");
    json!({ "room": room, "room_sure": "sure", "ways_out": ways, "things": things, "stands_out": [] }).to_string()
}

/// The third of a view in which the thing of a label lies.
pub(super) fn third_of_view(view: &View, label: &ObjectLabel) -> ViewThird {
    ViewThird::from_offset(view.pose.heading.turn_to(label.heading), view.horizontal_fov_rad)
}
