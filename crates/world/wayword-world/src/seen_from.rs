//! Which viewpoints each object is seen from.

use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{DVec3, Label, ObjectId, PlatformError, ViewpointGraph, ViewpointId};

/// The viewpoints from which each object is seen. `labels_around` gives what is visible around an eye.
///
/// # Errors
/// When `labels_around` fails.
pub fn seen_from(
    graph: &ViewpointGraph,
    mut labels_around: impl FnMut(DVec3) -> Result<Vec<Label>, PlatformError>,
) -> Result<BTreeMap<ObjectId, BTreeSet<ViewpointId>>, PlatformError> {
    let mut seen_from: BTreeMap<ObjectId, BTreeSet<ViewpointId>> = BTreeMap::new();
    for viewpoint in graph.viewpoints() {
        for label in labels_around(graph.position(viewpoint).unwrap_or_default())? {
            seen_from.entry(label.object).or_default().insert(viewpoint.clone());
        }
    }
    Ok(seen_from)
}
