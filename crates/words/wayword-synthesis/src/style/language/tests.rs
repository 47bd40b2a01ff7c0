use super::*;
use std::collections::BTreeSet;
use wayword_language::{languages::ReadableText, reading::read_instruction};

/// A shape filled with these names, one for each slot, and sides.
fn filled(shape: &str, names: [&str; 3], side: &str) -> String {
    let slots = ["{l}", "{r}", "{a}"].iter().zip(names);
    let text = slots.fold(shape.to_owned(), |text, (slot, name)| text.replace(slot, name));
    text.replace("{s}", side).replace("{p}", side)
}

#[test]
fn every_built_in_shape_is_read_as_what_its_kind_says() {
    for wording in READ.iter() {
        assert!(wording.way.shapes.len() > 38, "the file of {} is not read", wording.tag);
        let english = WayWording::built_in();
        let mut wrong = Vec::new();
        for (kind, shapes) in &wording.way.shapes {
            let room = if matches!(kind, ClauseKind::Along | ClauseKind::AlongToEnd | ClauseKind::TurnAtEnd) {
                "hallway"
            } else {
                "bedroom"
            };
            let names = ["sofa", room, "kitchen"];
            let own = names.map(|name| wording.usual_name(name).unwrap());
            for shape in shapes.keys() {
                let same_slots = |other: &&String| other.contains("{r}") == shape.contains("{r}");
                let Some(pattern) = english.shapes[kind].keys().find(same_slots) else {
                    wrong.push(format!("{kind:?}: {shape}: no English shape"));
                    continue;
                };
                let text = filled(shape, own, wording.side(Side::Left));
                let readable = ReadableText::new(&text, Some(wording.tag));
                let (said, expected) =
                    (TextContent::read(readable.english()), TextContent::read(&filled(pattern, names, "left")));
                let is_whole = read_instruction(readable.english(), &BTreeSet::new())
                    .clauses
                    .iter()
                    .all(|clause| clause.understood);
                if said.difference(&expected) > 0 || !is_whole {
                    wrong.push(format!("{kind:?}: {text}: {}", readable.english()));
                }
            }
        }
        assert!(wrong.is_empty(), "{wrong:#?}");
    }
}
