//! Finds the viewpoints from which each object of a scene is visible.

use std::{
    collections::{BTreeMap, BTreeSet},
    f64::consts::FRAC_PI_4,
};
use wayword_core::{DVec3, Heading, ObjectId, ObjectLabel, PlatformError, ViewpointGraph, ViewpointId};

/// The viewpoints from which each object is visible. `labels_around` gives the labels of the four views around an eye, the
/// first of them along a heading. It is called for two headings that are half a view apart: an object on the border of two
/// views may show too little of itself in either to be labelled.
///
/// # Errors
/// When `labels_around` fails.
pub fn seen_from(
    graph: &ViewpointGraph,
    mut labels_around: impl FnMut(DVec3, Heading) -> Result<Vec<ObjectLabel>, PlatformError>,
) -> Result<BTreeMap<ObjectId, BTreeSet<ViewpointId>>, PlatformError> {
    let mut seen_from: BTreeMap<ObjectId, BTreeSet<ViewpointId>> = BTreeMap::new();
    for viewpoint in graph.viewpoints() {
        let eye = graph.position_of(viewpoint).unwrap_or_default();
        for heading in [Heading::NORTH, Heading::NORTH.turned_by(FRAC_PI_4)] {
            for label in labels_around(eye, heading)? {
                seen_from.entry(label.object).or_default().insert(viewpoint.clone());
            }
        }
    }
    Ok(seen_from)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two of the first four views share an object, and neither shows enough of it for a label.
    #[test]
    fn an_object_on_the_border_of_two_views_is_visible() {
        let viewpoint = ViewpointId::new("hall").unwrap();
        let mut graph = ViewpointGraph::default();
        graph.add_viewpoint(viewpoint.clone(), DVec3::ZERO, None).unwrap();
        let sofa = ObjectId::new("1").unwrap();
        let label = ObjectLabel {
            object: sofa.clone(),
            name: "sofa".to_owned(),
            heading: Heading::NORTH,
            elevation_rad: 0.0,
            box_px: None,
            distance_m: Some(2.0),
            position: None,
            colour: None,
            room: None,
        };
        let whole = |_, heading: Heading| Ok(if heading == Heading::NORTH { Vec::new() } else { vec![label.clone()] });
        assert_eq!(seen_from(&graph, whole).unwrap()[&sofa], BTreeSet::from([viewpoint]));
    }
}
