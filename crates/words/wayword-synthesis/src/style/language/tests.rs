use super::{learn::filled_shape, *};
use std::collections::BTreeSet;
use wayword_language::{languages::ReadableText, reading::read_instruction};

#[test]
fn every_built_in_shape_is_read_as_what_its_kind_says() {
    for wording in READ.iter() {
        assert!(wording.way.shapes.len() > 38, "the file of {} is not read", wording.tag);
        let english = WayWording::built_in();
        let mut wrong = Vec::new();
        for (kind, shapes) in &wording.way.shapes {
            for shape in shapes.keys() {
                let same_slots = |other: &&String| other.contains("{r}") == shape.contains("{r}");
                let Some(pattern) = english.shapes[kind].keys().find(same_slots) else {
                    wrong.push(format!("{kind:?}: {shape}: no English shape"));
                    continue;
                };
                let (text, names) = filled_shape(wording, *kind, shape, Side::Left);
                let expected = ["{l}", "{r}", "{a}"].iter().zip(names);
                let expected = expected.fold(pattern.to_owned(), |text, (slot, name)| text.replace(slot, name));
                let expected = TextContent::read(&expected.replace("{s}", "left").replace("{p}", "left"));
                let readable = ReadableText::new(&text, Some(wording.tag));
                let reading = read_instruction(readable.english(), &BTreeSet::new());
                let is_whole = reading.clauses.iter().all(|clause| clause.understood);
                if TextContent::read(readable.english()).difference(&expected) > 0 || !is_whole {
                    wrong.push(format!("{kind:?}: {text}: {}", readable.english()));
                }
            }
        }
        assert!(wrong.is_empty(), "{wrong:#?}");
    }
}
