//! Samples of true and wrong claims. True ones are claims of people about a path; wrong ones have the name of another room or
//! object in the same place of the text.

use super::Walk;
use rand::{Rng, seq::IndexedRandom};
use std::collections::{BTreeMap, BTreeSet};
use wayword_checks::open::{Case, Claim, Missed, Relation, Sight, Weights, sight};
use wayword_core::{SceneId, Survey, rng};
use wayword_language::lexicon::{Class, Thing, agree, same_room, thing};

/// The share of wrong claims that come from labels.
const LABELS_SHARE: f64 = 1.0 / 3.0;
/// Most draws to find another name.
const TRIES: usize = 30;

/// A claim, checked against the evidence of a path.
pub struct Held {
    /// The walk's place in the list.
    pub walk: usize,
    /// The text's place among the walk's.
    pub text: usize,
    /// The claim.
    pub claim: Claim,
    /// Whether it is a wrong claim that was made here.
    pub wrong: bool,
    /// Whether the evidence shows or misses it.
    pub sight: Sight,
}

impl Held {
    /// The missed thing, if the evidence misses it.
    #[must_use]
    pub fn missed(&self) -> Option<&Missed> {
        match &self.sight {
            Sight::Missed(missed) => Some(missed),
            Sight::Shown | Sight::Unknown => None,
        }
    }
}

/// Returns every claim of every text, and for each known one a wrong claim, in which another room or object takes its place. The
/// replacements come from texts about other paths, half of them of the same building and half of any. A third of them come from
/// labels: of objects, half of the same building and half of any, and of rooms from any building.
#[must_use]
pub fn held(walks: &[&Walk], labels: &Labels, weights: &Weights, seed: u64) -> Vec<Held> {
    let mut rng = rng(seed, &["fit-evidence"]);
    let all: Vec<(usize, &Claim)> = walks
        .iter()
        .enumerate()
        .flat_map(|(at, walk)| walk.texts.iter().flat_map(move |text| text.claims.iter().map(move |claim| (at, claim))))
        .filter(|(_, claim)| is_known(claim))
        .collect();
    let mut by_scene: BTreeMap<&SceneId, Vec<(usize, &Claim)>> = BTreeMap::new();
    for (at, claim) in &all {
        by_scene.entry(&walks[*at].path.scene).or_default().push((*at, claim));
    }
    let mut held = Vec::new();
    for (at, walk) in walks.iter().enumerate() {
        for (number, text) in walk.texts.iter().enumerate() {
            let see = |claim: &Claim| sight(claim, &walk.evidence, walk.around.as_ref(), weights);
            let sights: Vec<Sight> = text.claims.iter().map(see).collect();
            for (place, claim) in text.claims.iter().enumerate() {
                let add = |claim: Claim, wrong: bool| {
                    let mut sight = see(&claim);
                    if let Sight::Missed(missed) = &mut sight {
                        missed.keep_company(sights[..place].iter().chain(&sights[place + 1..]));
                    }
                    Held { walk: at, text: number, claim, wrong, sight }
                };
                held.push(add(claim.clone(), false));
                if !is_known(claim) {
                    continue;
                }
                if claim.is_only_room() && rng.random_bool(LABELS_SHARE) {
                    let drawn = (0..TRIES).filter_map(|_| labels.rooms.choose(&mut rng));
                    let drawn = drawn.into_iter().find(|name| !same_room(name, &claim.name));
                    held.extend(drawn.map(|name| add(Claim { name: name.clone(), ..claim.clone() }, true)));
                    continue;
                }
                if !claim.is_only_room() && rng.random_bool(LABELS_SHARE) {
                    let here = labels.by_scene.get(&walk.path.scene).filter(|_| rng.random_bool(0.5));
                    let pool = here.unwrap_or(&labels.all);
                    let drawn = (0..TRIES).filter_map(|_| pool.choose(&mut rng)).find(|name| !agree(name, &claim.name));
                    held.extend(drawn.map(|name| add(named(claim, name), true)));
                    continue;
                }
                let pool = if rng.random_bool(0.5) { &by_scene[&walk.path.scene] } else { &all };
                let mut drawn = (0..TRIES).filter_map(|_| pool.choose(&mut rng));
                let drawn = drawn.find(|(from, other)| *from != at && is_other(claim, other));
                held.extend(drawn.map(|(_, other)| add(put(claim, other), true)));
            }
        }
    }
    held
}

/// Whether the lexicon knows the claimed object or room.
#[must_use]
pub fn is_known(claim: &Claim) -> bool {
    claim.is_room || thing(&claim.name).is_some()
}

/// Whether a claim may replace another one and has another name.
fn is_other(claim: &Claim, other: &Claim) -> bool {
    let same = agree(&claim.name, &other.name) || same_room(&claim.name, &other.name);
    claim.is_only_room() == other.is_only_room() && !same
}

/// A claim with the place of another one.
fn put(claim: &Claim, other: &Claim) -> Claim {
    Claim { event: claim.event, span: claim.span, relation: claim.relation, ..other.clone() }
}

/// A claim of an object of another name.
fn named(claim: &Claim, name: &str) -> Claim {
    let class = thing(name).map_or(Class::Unknown, |thing| thing.class);
    Claim { name: name.to_owned(), is_room: false, is_thing: true, class, ..claim.clone() }
}

/// The names of landmarks that labels have, each once.
#[derive(Default)]
pub struct Labels {
    all: Vec<String>,
    rooms: Vec<String>,
    by_scene: BTreeMap<SceneId, Vec<String>>,
}

impl Labels {
    /// The names in these surveys.
    #[must_use]
    pub fn of<'a>(surveys: impl Iterator<Item = (&'a SceneId, &'a Survey)>) -> Self {
        let is_landmark =
            |thing: &&Thing| thing.salience > 0 && !matches!(thing.class, Class::Fabric | Class::Door | Class::Unknown);
        let names = |survey: &Survey| -> BTreeSet<String> {
            let things = survey.objects().iter().filter_map(|placed| thing(&placed.name)).filter(is_landmark);
            things.map(|thing| thing.name.to_owned()).collect()
        };
        let surveys: Vec<_> = surveys.collect();
        let viewpoints = surveys.iter().flat_map(|(_, survey)| survey.viewpoints());
        let rooms: BTreeSet<String> = viewpoints.filter_map(|viewpoint| viewpoint.known.room.clone()).collect();
        let by_scene: BTreeMap<SceneId, Vec<String>> =
            surveys.into_iter().map(|(scene, survey)| (scene.clone(), names(survey).into_iter().collect())).collect();
        let all: BTreeSet<&String> = by_scene.values().flatten().collect();
        Self { all: all.into_iter().cloned().collect(), rooms: rooms.into_iter().collect(), by_scene }
    }
}

/// Whether a claim belongs to the table of a case, if it is not listed within reach.
#[must_use]
pub fn belongs(claim: &Claim, case: Case) -> bool {
    let at_stop = claim.relation == Relation::Stop;
    match case {
        Case::Thing => !claim.is_only_room() && !at_stop,
        Case::ThingAtStop => !claim.is_only_room() && at_stop,
        Case::Room => claim.is_only_room() && !at_stop,
        Case::RoomAtStop => claim.is_only_room() && at_stop,
        Case::RoomLacking => claim.is_only_room(),
    }
}
