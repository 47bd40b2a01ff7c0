//! What several answers say of one thing, joined.

use wayword_core::{Sighting, Witness};
use wayword_language::lexicon::{is_thing, kinds, normal};

/// A sighting, and whether it answers a question for that very thing.
pub(super) struct Told {
    pub(super) sighting: Sighting,
    pub(super) direct: bool,
}

/// Everything told, each thing once, in the order in which it was told.
///
/// Any denial outweighs whatever else is said of a thing, before or after it: a robot is better told too little than sent to a
/// ghost. Between seen and not sure, the later answer to a question for the thing itself decides; to be unsure of it in passing
/// takes nothing back.
pub(super) fn join(exchanges: impl Iterator<Item = Vec<Told>>) -> Vec<Sighting> {
    let mut joined: Vec<Sighting> = Vec::new();
    for exchange in exchanges {
        let earlier = joined.len();
        for told in exchange {
            if told.sighting.witness == Witness::Denied {
                deny(&mut joined, told.sighting);
            } else {
                add(&mut joined, earlier, told);
            }
        }
    }
    joined
}

/// Whether a denial speaks of a thing: "no chair" denies a dining chair, but neither "no dining chair" nor "no red chair" denies
/// a chair.
pub(in crate::dialogue) fn denies(denial: &Sighting, name: &str, colour: Option<&str>) -> bool {
    if denial.witness != Witness::Denied {
        return false;
    }
    let (denied, name) = (normal(&denial.name), normal(name));
    if denied == name || colour.is_some_and(|colour| denied == normal(&format!("{colour} {name}"))) {
        return true;
    }
    let general = kinds(&denied);
    // More words than a name of the lexicon tell one of its kind from others.
    let is_one_of_many = !is_thing(&denied) && general[0] != denied;
    !is_one_of_many && kinds(&name).contains(&general[0])
}

fn places_agree(a: &Sighting, b: &Sighting) -> bool {
    a.place == b.place || a.place.is_none() || b.place.is_none()
}

fn deny(joined: &mut Vec<Sighting>, denial: Sighting) {
    let mut known = false;
    for before in joined.iter_mut() {
        let other = before.witness != Witness::Denied && !places_agree(before, &denial);
        if denies(&denial, &before.name, before.colour.as_deref()) {
            // "No chair on the left" takes nothing from a chair on the right, and has no more to say.
            known |= other || kinds(&before.name)[0] == kinds(&denial.name)[0] || before.name == denial.name;
            if !other {
                before.witness = Witness::Denied;
            }
        }
    }
    if !known {
        joined.push(denial);
    }
}

fn add(joined: &mut Vec<Sighting>, earlier: usize, told: Told) {
    let Told { mut sighting, direct } = told;
    let colours_agree =
        |before: &Sighting| before.colour.is_none() || sighting.colour.is_none() || before.colour == sighting.colour;
    let fits = |before: &Sighting| places_agree(before, &sighting) && colours_agree(before);
    let exact = joined.iter().position(|before| before.name == sighting.name && fits(before));
    let of_kind = || {
        let kind = kinds(&sighting.name);
        joined[..earlier].iter().position(|before| fits(before) && kinds(&before.name).contains(&kind[0]))
    };
    if let Some(at) = exact.or_else(of_kind) {
        let before = &mut joined[at];
        before.place = before.place.or(sighting.place);
        before.colour = before.colour.take().or(sighting.colour);
        before.several |= sighting.several;
        before.witness = match (before.witness, sighting.witness) {
            (Witness::Denied, _) => Witness::Denied,
            (Witness::Seen, Witness::Unsure) if direct => Witness::Unsure,
            (Witness::Unsure, later) => later,
            (before, _) => before,
        };
        return;
    }
    let is_denied = |denial: &Sighting| {
        places_agree(denial, &sighting) && denies(denial, &sighting.name, sighting.colour.as_deref())
    };
    if joined.iter().any(is_denied) {
        sighting.witness = Witness::Denied;
    }
    joined.push(sighting);
}
