//! Pairs of a film and a text that are made wrong in known ways.

use super::films::SeenFilm;
use crate::corrupt_people::flip_one_turn;
use rand::{Rng, seq::IndexedRandom};
use std::collections::BTreeSet;
use wayword_core::seeded_rng;
use wayword_follower::pair::FilmedWalk;
use wayword_language::{
    lexicon::{find_thing, names_agree},
    reading::{EventContent, read_instruction},
};

/// The fault of a pair.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum PairFault {
    /// Nothing.
    None,
    /// The text is of another walk.
    OtherWalk,
    /// One turn of the text is flipped.
    TurnFlipped,
    /// A thing that the text names is exchanged for one that the film does not show.
    LandmarkExchanged,
    /// The first or the last half of the film is missing.
    HalfFrames,
}

impl PairFault {
    pub(super) const ALL: [Self; 5] =
        [Self::None, Self::OtherWalk, Self::TurnFlipped, Self::LandmarkExchanged, Self::HalfFrames];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::None => "right",
            Self::OtherWalk => "another walk's text",
            Self::TurnFlipped => "a turn flipped",
            Self::LandmarkExchanged => "a landmark exchanged",
            Self::HalfFrames => "half the frames missing",
        }
    }

    /// Its share of the pairs.
    fn share(self) -> f64 {
        match self {
            Self::OtherWalk => 0.3,
            Self::HalfFrames => 0.1,
            Self::None | Self::TurnFlipped | Self::LandmarkExchanged => 0.2,
        }
    }
}

/// A film and a text, and the fault of the pair.
pub(super) struct MadePair {
    pub(super) by_poses: FilmedWalk,
    /// The same with the turns that its pictures show.
    pub(super) by_pictures: FilmedWalk,
    pub(super) text: String,
    pub(super) fault: PairFault,
}

/// Draws pairs from films, in the shares of the faults.
pub(super) fn make_pairs(films: &[SeenFilm], count: usize, seed: u64) -> Vec<MadePair> {
    let names: BTreeSet<&str> = films
        .iter()
        .flat_map(|film| &film.by_poses.places)
        .flat_map(|place| &place.things)
        .map(String::as_str)
        .collect();
    let names: Vec<&str> = names.into_iter().filter(|name| find_thing(name).is_some()).collect();
    let mut rng = seeded_rng(seed, &["pairs"]);
    let mut pairs = Vec::new();
    for fault in PairFault::ALL {
        let wanted = (fault.share() * count as f64).round() as usize;
        let (mut made, mut tries) = (0, 0);
        while made < wanted && tries < 50 * count {
            tries += 1;
            let Some(film) = films.choose(&mut rng) else { break };
            let Some(pair) = make_pair(film, films, &names, fault, &mut rng) else { continue };
            pairs.push(pair);
            made += 1;
        }
    }
    pairs
}

fn make_pair(
    film: &SeenFilm,
    films: &[SeenFilm],
    names: &[&str],
    fault: PairFault,
    rng: &mut impl Rng,
) -> Option<MadePair> {
    let own = film.texts.choose(rng)?;
    let text = match fault {
        PairFault::None | PairFault::HalfFrames => own.clone(),
        PairFault::OtherWalk => other_text(film, films, rng)?,
        PairFault::TurnFlipped => flip_one_turn(own, rng)?,
        PairFault::LandmarkExchanged => exchange_landmark(own, &film.by_poses, names, rng)?,
    };
    let (mut by_poses, mut by_pictures) = (film.by_poses.clone(), film.by_pictures.clone());
    if fault == PairFault::HalfFrames {
        let is_first = rng.random_bool(0.5);
        (by_poses, by_pictures) = (half_of(&by_poses, is_first)?, half_of(&by_pictures, is_first)?);
    }
    Some(MadePair { by_poses, by_pictures, text, fault })
}

/// A text of another walk, of the same house where there is one, in half of the cases.
fn other_text(film: &SeenFilm, films: &[SeenFilm], rng: &mut impl Rng) -> Option<String> {
    let same_house = rng.random_bool(0.5);
    let others = films.iter().filter(|other| !std::ptr::eq(*other, film));
    let near: Vec<&SeenFilm> = others.clone().filter(|other| same_house && other.scene == film.scene).collect();
    let others: Vec<&SeenFilm> = if near.is_empty() { others.collect() } else { near };
    let text = others.choose(rng)?.texts.choose(rng)?;
    (!film.texts.contains(text)).then(|| text.clone())
}

/// A text with one thing exchanged for one that the film does not show.
fn exchange_landmark(text: &str, walk: &FilmedWalk, names: &[&str], rng: &mut impl Rng) -> Option<String> {
    let reading = read_instruction(text, &BTreeSet::new());
    let spans: Vec<([usize; 2], String)> = reading
        .events
        .iter()
        .filter_map(|event| match &event.what {
            EventContent::Place(place) if place.is_thing && !place.is_room => Some((event.span, place.name.clone())),
            _ => None,
        })
        .collect();
    let ([from, to], old) = spans.choose(rng)?.clone();
    let shown = |name: &str| walk.places.iter().flat_map(|place| &place.things).any(|seen| names_agree(seen, name));
    let others: Vec<&&str> = names.iter().filter(|name| !shown(name) && !names_agree(name, &old)).collect();
    let new = others.choose(rng)?;
    Some(format!("{}{new}{}", &text[..from], &text[to..]))
}

/// The first or the last half of a walk.
fn half_of(walk: &FilmedWalk, first: bool) -> Option<FilmedWalk> {
    let half = walk.places.len() / 2;
    if half < 2 {
        return None;
    }
    Some(match first {
        true => FilmedWalk { places: walk.places[..half].to_vec(), hops: walk.hops[..half - 1].to_vec() },
        false => {
            let from = walk.places.len() - half;
            FilmedWalk { places: walk.places[from..].to_vec(), hops: walk.hops[from..].to_vec() }
        }
    })
}
