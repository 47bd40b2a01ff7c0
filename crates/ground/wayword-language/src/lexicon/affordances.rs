//! What one can do with things: carry them, open them, switch them on, sit on them.

use super::{
    things::{ThingClass, class_named, find_thing, kinds_of},
    to_singular,
};
use crate::data;
use std::sync::LazyLock;

const AFFORDANCE_LIST: &str = include_str!("../languages/en/affordances.txt");

/// A thing that one can do with some things: a row of `languages/en/affordances.txt`.
struct ThingAffordance {
    verbs: Vec<&'static str>,
    classes: Vec<ThingClass>,
    also: Vec<&'static str>,
    not: Vec<&'static str>,
}

static AFFORDANCES: LazyLock<Vec<ThingAffordance>> = LazyLock::new(|| {
    let row = |line| {
        let [_, verbs, classes, also, not] = data::row_columns(line);
        let [verbs, also, not] = [verbs, also, not].map(|column| data::split_names(column).collect());
        ThingAffordance { verbs, classes: data::split_names(classes).map(class_named).collect(), also, not }
    };
    data::content_lines(AFFORDANCE_LIST).map(row).collect()
});

/// Whether one can do this with a thing of that name: "bring me {o}" with a vase, but not with a sofa. `task` begins with its verb. Tasks
/// of which the list says nothing can be done with anything.
#[must_use]
pub fn affords_task(task: &str, name: &str) -> bool {
    let begins = |verb: &&&str| task.strip_prefix(**verb).is_some_and(|rest| rest.is_empty() || rest.starts_with(' '));
    let asked = AFFORDANCES.iter().flat_map(|row| row.verbs.iter().map(move |verb| (row, verb)));
    let asked = asked.filter(|(_, verb)| begins(verb)).max_by_key(|(_, verb)| verb.len());
    asked.is_none_or(|(row, _)| row.is_of(name))
}

impl ThingAffordance {
    fn is_of(&self, name: &str) -> bool {
        for kind in kinds_of(&to_singular(name)) {
            if self.not.contains(&kind.as_str()) {
                return false;
            }
            if self.also.contains(&kind.as_str()) {
                return true;
            }
        }
        find_thing(name).is_none_or(|thing| self.classes.contains(&thing.class))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn affords_task_goes_by_the_most_specific_name() {
        for (task, name, wanted) in [
            ("bring me {o}", "vase", true),
            ("bring me {o}", "chair", true),
            ("bring me {o}", "armchair", false),
            ("bring me {o}", "bulletin board", false),
            ("open {o}", "kitchen cabinet", true),
            ("open {o}", "bookshelf", false),
            ("pull out {o}", "dining chairs", true),
            ("pull out {o}", "sofa", false),
            ("turn on {o}", "floor lamp", true),
            ("turn around {o}", "floor lamp", true),
            ("take down {o}", "picture", true),
            ("sit on {o}", "wardrobe", false),
            ("clean {o}", "wardrobe", true),
            ("look inside {o}", "microwave", true),
            ("look at {o}", "sofa", true),
        ] {
            assert_eq!(affords_task(task, name), wanted, "{task} {name}");
        }
    }

    #[test]
    fn the_list_names_only_things_and_classes_of_the_lexicon_and_no_verb_twice() {
        let mut verbs: Vec<&str> = AFFORDANCES.iter().flat_map(|row| row.verbs.clone()).collect();
        let count = verbs.len();
        verbs.sort_unstable();
        verbs.dedup();
        assert_eq!(verbs.len(), count);
        for row in AFFORDANCES.iter() {
            assert!(!row.classes.contains(&ThingClass::Unknown), "{:?}", row.verbs);
            for name in row.also.iter().chain(&row.not) {
                assert!(find_thing(name).is_some_and(|thing| thing.name == *name), "{name}");
            }
        }
    }
}
