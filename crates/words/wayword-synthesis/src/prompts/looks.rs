//! Writes the looks of a thing with its name: "several white-and-grey fabric pillows", "picture of a ship".

use wayword_checks::memory::RememberedThing;
use wayword_core::ObjectSighting;
use wayword_language::lexicon::{ThingClass, find_thing, is_fabric, to_plural};

/// Most colours of a thing.
const MAX_COLOURS: usize = 2;
/// Words with which a detail begins that reads on behind the name of its thing.
const BEHIND_LEADS: [&str; 5] = ["of", "with", "showing", "depicting", "in"];

/// The looks of a thing, and its name.
pub(super) struct ThingLooks<'a> {
    name: &'a str,
    colours: Vec<&'a str>,
    material: Option<&'a str>,
    detail: Option<&'a str>,
    several: bool,
}

impl<'a> ThingLooks<'a> {
    pub(super) fn of_thing(thing: &'a RememberedThing) -> Self {
        let RememberedThing { name, colour, more_colours, material, detail, several, .. } = thing;
        Self::new(name, colour.iter().chain(more_colours), (material.as_deref(), detail.as_deref()), *several)
    }

    pub(super) fn of_sighting(sighting: &'a ObjectSighting) -> Self {
        let ObjectSighting { name, colour, more_colours, material, detail, several, .. } = sighting;
        Self::new(name, colour.iter().chain(more_colours), (material.as_deref(), detail.as_deref()), *several)
    }

    /// What the name says is left out, and "wooden" of wood. A picture is known by what it shows; its colour may be that of its frame.
    fn new(
        name: &'a str,
        colours: impl Iterator<Item = &'a String>,
        (material, detail): (Option<&'a str>, Option<&'a str>),
        several: bool,
    ) -> Self {
        let is_of_frame = detail.is_some() && is_picture(name);
        let is_told = |colour: &&str| {
            let is_material = material.is_some_and(|material| colour.starts_with(material));
            !name.contains(colour) && !is_material && !is_of_frame
        };
        Self {
            name,
            colours: colours.map(String::as_str).filter(is_told).take(MAX_COLOURS).collect(),
            material: material.filter(|material| !name.contains(material)),
            detail,
            several: several && !is_fabric(name),
        }
    }

    /// The looks before the name, and a detail that reads on behind it.
    pub(super) fn to_words(&self) -> String {
        let Self { name, colours, material, detail, several } = self;
        let words = [
            several.then(|| "several".to_owned()),
            (!colours.is_empty()).then(|| colours.join("-and-")),
            detail.filter(|detail| self.is_adjective(detail)).map(str::to_owned),
            material.map(str::to_owned),
            Some(if *several { to_plural(name) } else { (*name).to_owned() }),
            detail.filter(|detail| reads_on(detail)).map(str::to_owned),
        ];
        words.into_iter().flatten().collect::<Vec<_>>().join(" ")
    }

    /// A detail that reads on neither before the name nor behind it: "filled with books".
    pub(super) fn remark(&self) -> Option<&'a str> {
        self.detail.filter(|detail| detail.contains(' ') && !reads_on(detail))
    }

    /// Whether a detail is one word ("checkered") that says more than the name and the material; "wooden" of wood does not.
    fn is_adjective(&self, detail: &str) -> bool {
        let mut known = self.name.split(' ').chain(self.material);
        !detail.contains(' ') && !known.any(|known| detail.starts_with(known) || known.starts_with(detail))
    }
}

/// Whether a name is that of a picture or a hanging, which is known by what it shows.
pub(super) fn is_picture(name: &str) -> bool {
    find_thing(name).is_some_and(|thing| thing.class == ThingClass::WallArt)
}

fn reads_on(detail: &str) -> bool {
    detail.split_once(' ').is_some_and(|(lead, _)| BEHIND_LEADS.contains(&lead))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_stand_where_they_read_on() {
        let thing = |name: &str, material: &str, detail: &str| RememberedThing {
            name: name.into(),
            colour: Some("brown".into()),
            material: (!material.is_empty()).then(|| material.into()),
            detail: Some(detail.into()),
            ..RememberedThing::default()
        };
        for (name, material, detail, words, remark) in [
            ("floor", "tile", "checkered", "brown checkered tile floor", None),
            ("bookshelf", "wood", "wooden", "brown wood bookshelf", None),
            ("picture", "", "of a ship", "picture of a ship", None),
            ("bookshelf", "wood", "filled with books", "brown wood bookshelf", Some("filled with books")),
        ] {
            let thing = thing(name, material, detail);
            let looks = ThingLooks::of_thing(&thing);
            assert_eq!((looks.to_words().as_str(), looks.remark()), (words, remark));
        }
    }
}
