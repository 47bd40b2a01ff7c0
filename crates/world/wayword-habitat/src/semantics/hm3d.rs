//! Reads the `*.semantic.txt` of HM3D (the Habitat-Matterport 3D dataset), which gives the name and the room of the object for
//! each colour of the semantic mesh.
//!
//! A header, then `id,RRGGBB,"category",region` on each line; a category may contain commas (HM3D's semantics, version
//! 0.2).

use super::{SemanticThing, broken_lines::refuse_if_most_broken};
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::ObjectId;

const ANNOTATIONS_HEADER: &str = "HM3D Semantic Annotations";

/// The contents of the file.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Hm3dAnnotations {
    pub(super) things: Vec<SemanticThing>,
    /// Index of the thing of each colour.
    pub(super) by_colour: BTreeMap<[u8; 3], usize>,
    /// The lines that cannot be read, each with its reason. Their objects are left out.
    pub(super) broken_lines: Vec<String>,
}

/// Parses the file. A line that cannot be read is left out; the error names the first of them if they are most of the lines.
pub(super) fn parse_annotations(text: &str) -> Result<Hm3dAnnotations, String> {
    let mut lines = text.lines().enumerate();
    let header = lines.next().map_or("", |(_, line)| line.trim_start_matches('\u{feff}').trim());
    if header != ANNOTATIONS_HEADER {
        return Err(format!("line 1: is {header:.40?}, expected {ANNOTATIONS_HEADER:?}"));
    }
    let (mut annotations, mut colours, mut ids) = (Hm3dAnnotations::default(), BTreeSet::new(), BTreeSet::new());
    for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let mut broken = |reason: &str| annotations.broken_lines.push(format!("line {}: {reason}", number + 1));
        match parse_line(line.trim()) {
            Err(reason) => broken(&reason),
            Ok((colour, _)) if !colours.insert(colour) => {
                broken("an earlier line has the same colour");
                // The colour may be either's.
                annotations.by_colour.remove(&colour);
            }
            // Two things with one id would be one object.
            Ok((_, thing)) if !ids.insert(thing.id.clone()) => broken("an earlier line has the same id"),
            Ok((colour, thing)) => {
                annotations.by_colour.insert(colour, annotations.things.len());
                annotations.things.push(thing);
            }
        }
    }
    refuse_if_most_broken(&annotations.broken_lines, annotations.things.len())?;
    Ok(annotations)
}

/// The colour and the thing of a line.
fn parse_line(line: &str) -> Result<([u8; 3], SemanticThing), String> {
    let columns = || {
        let (id, rest) = line.split_once(',')?;
        let (colour, rest) = rest.split_once(',')?;
        let (category, region) = rest.rsplit_once(',')?;
        Some((id, colour, category, region))
    };
    let (id, colour, category, region) = columns().ok_or("does not have four columns: id, colour, category, region")?;
    let number: u32 = id.trim().parse().map_err(|_| format!("{id:.20?} is not an id"))?;
    let region: i64 = region.trim().parse().map_err(|_| format!("{region:.20?} is not a region"))?;
    let colour = colour.trim();
    let is_hex = colour.len() == 6 && colour.bytes().all(|byte| byte.is_ascii_hexdigit());
    let bits = u32::from_str_radix(colour, 16).ok().filter(|_| is_hex);
    let [_, red, green, blue] = bits.ok_or_else(|| format!("{colour:.20?} is not a 6-digit hex colour"))?.to_be_bytes();
    let id = ObjectId::new(number.to_string()).map_err(|error| error.to_string())?;
    // HM3D gives the region -1 to objects outside all rooms.
    let room = u32::try_from(region).ok();
    Ok(([red, green, blue], SemanticThing { room, ..SemanticThing::new(id, category.trim().trim_matches('"')) }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn categories_may_hold_commas() {
        let text = "HM3D Semantic Annotations\n1,BC0FF7,\"table, round\",3\r\n2,00ff10,\"wall\",-1\n";
        let annotations = parse_annotations(text).unwrap();
        assert_eq!(annotations.by_colour, [([0xbc, 0x0f, 0xf7], 0), ([0, 0xff, 0x10], 1)].into());
        assert_eq!(annotations.things[0].name.as_deref(), Some("table round"));
        // A wall is a part of the building, so it has no name.
        assert_eq!(annotations.things[1].name, None);
        assert_eq!([annotations.things[0].room, annotations.things[1].room], [Some(3), None]);
    }

    #[test]
    fn errors_name_the_line() {
        let refusal = |lines: &str| {
            let read = parse_annotations(&format!("{ANNOTATIONS_HEADER}\n{lines}"));
            read.map_or_else(|first| first, |read| read.broken_lines.concat())
        };
        assert!(parse_annotations("ply").unwrap_err().starts_with("line 1: is \"ply\""));
        assert_eq!(refusal("1,BC0FF7"), "line 2: does not have four columns: id, colour, category, region");
        assert_eq!(refusal("\n1,BC0FF,\"a\",0"), "line 3: \"BC0FF\" is not a 6-digit hex colour");
        assert_eq!(refusal("x,BC0FF7,\"a\",0"), "line 2: \"x\" is not an id");
        assert_eq!(refusal("1,BC0FF7,\"a\",0\n2,bc0ff7,\"b\",0"), "line 3: an earlier line has the same colour");
    }

    #[test]
    fn an_id_given_twice_stays_with_its_first_line() {
        let lines = "1,BC0FF7,\"bed\",0\n01,00FF10,\"sofa\",1\n2,0000FF,\"lamp\",0\n1,00FFFF,\"bed\",0\n";
        let read = parse_annotations(&format!("{ANNOTATIONS_HEADER}\n{lines}")).unwrap();
        assert_eq!(
            read.broken_lines,
            ["line 3: an earlier line has the same id", "line 5: an earlier line has the same id"]
        );
        assert_eq!(read.by_colour, [([0xbc, 0x0f, 0xf7], 0), ([0, 0, 0xff], 1)].into());
    }

    #[test]
    fn a_broken_line_leaves_out_its_own_object() {
        let read = |lines: &str| parse_annotations(&format!("{ANNOTATIONS_HEADER}\n{lines}"));
        let good = "1,BC0FF7,\"bed\",0\n2,00FF10,\"sofa\",1\n";
        let bad =
            ["3,5C557,\"radiator\",0", "3,5C557A0,\"radiator\",0", "3,GC557A,\"radiator\",0", "3", "x,5C557A,\"a\",0"];
        for line in bad {
            let annotations = read(&format!("{good}{line}\n4,0000FF,\"lamp\",0\n")).unwrap();
            let names: Vec<_> = annotations.things.iter().filter_map(|thing| thing.name.as_deref()).collect();
            assert_eq!(names, ["bed", "sofa", "lamp"], "{line}");
            assert!(matches!(&annotations.broken_lines[..], [only] if only.starts_with("line 4: ")), "{annotations:?}");
            assert!(
                read(&[line; 3].join("\n")).is_err() && read(&format!("{line}\n{line}\n1,BC0FF7,\"bed\",0")).is_err()
            );
        }
        let shared = read(&format!("{good}3,bc0ff7,\"lamp\",0\n")).unwrap();
        assert_eq!(shared.by_colour, [([0, 0xff, 0x10], 1)].into(), "the colour may be the bed's or the lamp's");
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "\\PC{0,200}") {
            let _ = parse_annotations(&format!("{ANNOTATIONS_HEADER}\n1,{text}"));
            let _ = parse_annotations(&text);
        }
    }
}
