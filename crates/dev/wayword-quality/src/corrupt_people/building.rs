//! The rooms and objects of a building with their positions, as a platform's labels list them.

use super::{
    lists::{OBJECT_WORDS, ROOM_WORDS, words_under},
    text::split_words,
};
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{DVec3, ViewpointId, ViewpointSurvey};

/// A building as its labels describe it.
pub(super) struct LabelledBuilding {
    /// The position of each viewpoint, and the name of its room in lower case.
    viewpoints: BTreeMap<ViewpointId, (DVec3, Option<String>)>,
    /// The positions of objects by their name, which is split into words in the singular.
    things: BTreeMap<Vec<String>, Vec<DVec3>>,
}

impl LabelledBuilding {
    pub(super) fn new(survey: &ViewpointSurvey) -> Self {
        let mut things: BTreeMap<Vec<String>, Vec<DVec3>> = BTreeMap::new();
        let mut known = BTreeSet::new();
        for viewpoint in survey.viewpoints() {
            for label in viewpoint.known.things.iter().flatten() {
                // A label without a position counts as one object at each viewpoint that sees it.
                let place = label.position.unwrap_or(viewpoint.position);
                if known.insert((label.object.clone(), place.to_array().map(f64::to_bits))) {
                    things.entry(singular_words(&label.name)).or_default().push(place);
                }
            }
        }
        let room = |room: &Option<String>| room.as_ref().map(|room| room.to_lowercase());
        let viewpoints = survey.viewpoints().iter();
        let viewpoints = viewpoints.map(|at| (at.id.clone(), (at.position, room(&at.known.room)))).collect();
        Self { viewpoints, things }
    }

    /// The positions of a path's viewpoints. Viewpoints that the building does not have are left out.
    pub(super) fn viewpoint_positions(&self, path: &[ViewpointId]) -> Vec<DVec3> {
        path.iter().filter_map(|id| Some(self.viewpoints.get(id)?.0)).collect()
    }

    /// The positions of all viewpoints in rooms of a kind. The kind is a name in the list of rooms.
    pub(super) fn room_positions(&self, kind: &str) -> Vec<DVec3> {
        let alike = words_under(&ROOM_WORDS, kind);
        let is_alike = |room: &Option<String>| room.as_ref().is_some_and(|room| alike.contains(&room.as_str()));
        self.viewpoints.values().filter(|(_, room)| is_alike(room)).map(|(place, _)| *place).collect()
    }

    /// The positions of all objects that people could mean by a name. The list of objects gives names that mean the same; for a name that
    /// is not in the list, any label with its last word counts, so that "dining table" may mean every table.
    pub(super) fn object_positions(&self, name: &str) -> Vec<DVec3> {
        let named = singular_words(name);
        let last = named.last().cloned().into_iter().collect();
        let alike = OBJECT_WORDS
            .get(name)
            .map_or_else(|| vec![last], |alike| alike.iter().map(|name| singular_words(name)).collect());
        let has = |label: &Vec<String>, part: &Vec<String>| {
            !part.is_empty() && label.windows(part.len()).any(|run| run == part.as_slice())
        };
        let named = self.things.iter().filter(|(label, _)| alike.iter().any(|part| has(label, part)));
        named.flat_map(|(_, places)| places.iter().copied()).collect()
    }

    /// Whether these words are the whole name of a label.
    pub(super) fn has_label(&self, name: &[String]) -> bool {
        self.things.contains_key(name)
    }
}

/// The words of a name in the singular.
pub(super) fn singular_words(name: &str) -> Vec<String> {
    split_words(name).into_iter().map(|word| to_singular(&word.low)).collect()
}

/// A noun in the singular, by its ending alone.
pub(super) fn to_singular(word: &str) -> String {
    if let Some(stem) = word.strip_suffix("ies").filter(|stem| stem.len() > 2) {
        return format!("{stem}y");
    }
    if word == "shelves" {
        return "shelf".to_owned();
    }
    let drops_es = ["ches", "shes", "xes", "sses"].iter().any(|end| word.ends_with(end));
    let drops_s = word.ends_with('s') && !["ss", "us", "is"].iter().any(|end| word.ends_with(end)) && word.len() > 3;
    match (drops_es, drops_s) {
        (true, _) => word[..word.len() - 2].to_owned(),
        (_, true) => word[..word.len() - 1].to_owned(),
        _ => word.to_owned(),
    }
}

/// The plural of a noun.
pub(super) fn to_plural(noun: &str) -> String {
    let takes_es = ["s", "x", "ch", "sh"].iter().any(|end| noun.ends_with(end));
    match noun.strip_suffix("lf") {
        Some(stem) => format!("{stem}lves"),
        None => format!("{noun}{}", if takes_es { "es" } else { "s" }),
    }
}

/// The least distance between positions of two sets, metres; `None` where a set is empty.
pub(super) fn nearest_m(some: &[DVec3], others: &[DVec3]) -> Option<f64> {
    let distances = some.iter().flat_map(|a| others.iter().map(move |b| a.distance(*b)));
    distances.min_by(f64::total_cmp)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::test_data;
    use wayword_core::SceneId;
    use wayword_run::platforms;
    use wayword_testkit::{SCAN, viewpoint_id};
    use wayword_world::survey_scene;

    /// The test kit's building: entryway 0, hallway 1, living room 2 and 3, kitchen 4 and 5, stairs 6 and 7, and above
    /// them the hallway 8 and 9, bedroom 10 and 11, bathroom 12, office 13.
    pub(in super::super) fn made_up_building() -> LabelledBuilding {
        let building = test_data::TestBuildingFolder::new();
        let platform = platforms::open_named("matterport", Some(&building.data_folder()), None, None).unwrap();
        LabelledBuilding::new(&survey_scene(platform.as_ref(), &SceneId::new(SCAN).unwrap()).unwrap())
    }

    pub(in super::super) fn path(places: &[usize]) -> Vec<ViewpointId> {
        places.iter().map(|at| ViewpointId::new(viewpoint_id(*at)).unwrap()).collect()
    }

    #[test]
    fn positions_are_those_of_every_label_that_a_name_could_mean() {
        let building = made_up_building();
        let start = building.viewpoint_positions(&path(&[0]));
        assert_eq!(building.room_positions("kitchen").len(), 2);
        assert_eq!(building.room_positions("hallway").len(), 3);
        assert!(building.room_positions("garage").is_empty());
        assert!(building.object_positions("piano").is_empty());
        let couch_m = nearest_m(&start, &building.object_positions("couch")).unwrap();
        assert!((4.0..5.0).contains(&couch_m), "{couch_m}");
        assert_eq!(building.object_positions("dining table").len(), 3, "every table could be taken for one");
        assert!(building.has_label(&["coffee".to_owned(), "table".to_owned()]));
        assert_eq!(nearest_m(&start, &[]), None);
    }

    #[test]
    fn singular_and_plural_follow_the_ending_of_a_noun() {
        for (one, many) in [("chair", "chairs"), ("couch", "couches"), ("bookshelf", "bookshelves"), ("box", "boxes")] {
            assert_eq!(to_plural(one), many);
        }
        for (many, one) in [("chairs", "chair"), ("couches", "couch"), ("glass", "glass"), ("pantries", "pantry")] {
            assert_eq!(to_singular(many), one);
        }
    }
}
