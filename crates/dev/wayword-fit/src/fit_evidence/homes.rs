//! Finds the home rooms of each class of objects: the rooms that list it clearly more often than other rooms, as kitchens do with stoves.

use std::collections::{BTreeMap, BTreeSet};
use wayword_checks::open::class_name;
use wayword_core::ViewpointSurvey;
use wayword_language::lexicon::{ThingClass, find_thing, room_name};

/// A room is a home of a class if its viewpoints list it this many times as often as all viewpoints do.
const MIN_LIFT: f64 = 1.5;
/// Viewpoints that a room must have, over all buildings, to be a home. The shares of fewer viewpoints are mostly chance.
const MIN_ROOM_VIEWPOINTS: f64 = 20.0;

/// For each class of objects, by its name, the rooms that are its homes.
pub(crate) fn find_homes<'a>(surveys: impl Iterator<Item = &'a ViewpointSurvey>) -> BTreeMap<String, BTreeSet<String>> {
    // How many viewpoints each room has, and how many of them list each class.
    let mut viewpoints: BTreeMap<&str, f64> = BTreeMap::new();
    let mut listing: BTreeMap<(ThingClass, &str), f64> = BTreeMap::new();
    for viewpoint in surveys.flat_map(ViewpointSurvey::viewpoints) {
        let Some(room) = viewpoint.known.room.as_deref().and_then(room_name) else { continue };
        *viewpoints.entry(room).or_default() += 1.0;
        let labels = viewpoint.known.things.iter().flatten();
        let classes: BTreeSet<ThingClass> = labels.filter_map(|label| Some(find_thing(&label.name)?.class)).collect();
        for class in classes {
            *listing.entry((class, room)).or_default() += 1.0;
        }
    }
    let viewpoint_count: f64 = viewpoints.values().sum();
    let mut class_listing: BTreeMap<ThingClass, f64> = BTreeMap::new();
    for ((class, _), count) in &listing {
        *class_listing.entry(*class).or_default() += count;
    }
    let mut homes: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for ((class, room), count) in &listing {
        let lift = (count / viewpoints[room]) / (class_listing[class] / viewpoint_count);
        if viewpoints[room] >= MIN_ROOM_VIEWPOINTS && lift >= MIN_LIFT {
            homes.entry(class_name(*class)).or_default().insert((*room).to_owned());
        }
    }
    homes
}
