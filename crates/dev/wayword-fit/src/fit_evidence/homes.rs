//! Finds the home rooms of each class of objects: the rooms that list it clearly more often than other rooms, as kitchens do with stoves.

use std::collections::{BTreeMap, BTreeSet};
use wayword_checks::open::class_name;
use wayword_core::Survey;
use wayword_language::lexicon::{Class, room_name, thing};

/// A room is a home of a class if its viewpoints list it this many times as often as all viewpoints do.
const LIFT: f64 = 1.5;
/// Viewpoints that a room must have before its shares count.
const ENOUGH: f64 = 20.0;

/// For each class of objects, by its name, the rooms that are its homes.
pub(crate) fn homes<'a>(surveys: impl Iterator<Item = &'a Survey>) -> BTreeMap<String, BTreeSet<String>> {
    let mut viewpoints: BTreeMap<&str, f64> = BTreeMap::new();
    let mut listing: BTreeMap<(Class, &str), f64> = BTreeMap::new();
    for viewpoint in surveys.flat_map(Survey::viewpoints) {
        let Some(room) = viewpoint.known.room.as_deref().and_then(room_name) else { continue };
        *viewpoints.entry(room).or_default() += 1.0;
        let labels = viewpoint.known.things.iter().flatten();
        let classes: BTreeSet<Class> = labels.filter_map(|label| Some(thing(&label.name)?.class)).collect();
        for class in classes {
            *listing.entry((class, room)).or_default() += 1.0;
        }
    }
    let all: f64 = viewpoints.values().sum();
    let mut of_class: BTreeMap<Class, f64> = BTreeMap::new();
    for ((class, _), count) in &listing {
        *of_class.entry(*class).or_default() += count;
    }
    let mut homes: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for ((class, room), count) in &listing {
        let lift = (count / viewpoints[room]) / (of_class[class] / all);
        if viewpoints[room] >= ENOUGH && lift >= LIFT {
            homes.entry(class_name(*class)).or_default().insert((*room).to_owned());
        }
    }
    homes
}
