//! Samples of true and wrong claims. True ones are claims of people about a path; wrong ones have the name of another room or
//! object in the same place of the text.

use super::PeopleWalk;
use rand::{Rng, seq::IndexedRandom};
use std::collections::{BTreeMap, BTreeSet};
use wayword_checks::open::{
    ClaimCase, ClaimSight, MissedClaim, PlaceClaim, SilenceWeights, WalkerRelation, sight_of_claim,
};
use wayword_core::{SceneId, ViewpointSurvey, seeded_rng};
use wayword_language::lexicon::{LexiconThing, ThingClass, find_thing, names_agree, same_room};

/// The share of wrong claims that come from labels.
const LABELS_SHARE: f64 = 1.0 / 3.0;
/// Most draws to find another name.
const MAX_DRAWS: usize = 30;

/// A claim, checked against the evidence of a path.
pub struct ClaimSample {
    /// The walk's place in the list.
    pub walk: usize,
    /// The text's place among the walk's.
    pub text: usize,
    /// The claim.
    pub claim: PlaceClaim,
    /// Whether it is a wrong claim that was made here.
    pub wrong: bool,
    /// Whether the evidence shows or misses it.
    pub sight: ClaimSight,
}

impl ClaimSample {
    /// The missed thing, if the evidence misses it.
    #[must_use]
    pub fn missed_evidence(&self) -> Option<&MissedClaim> {
        match &self.sight {
            ClaimSight::Missed(missed) => Some(missed),
            ClaimSight::Shown | ClaimSight::Unknown => None,
        }
    }
}

/// Returns every claim of every text, and for each known one a wrong claim, in which another room or object takes its place. The
/// replacements come from texts about other paths, half of them of the same building and half of any. A third of them come from
/// labels: of objects, half of the same building and half of any, and of rooms from any building.
#[must_use]
pub fn sample_claims(
    walks: &[&PeopleWalk],
    labels: &LabelNames,
    weights: &SilenceWeights,
    seed: u64,
) -> Vec<ClaimSample> {
    let mut rng = seeded_rng(seed, &["fit-evidence"]);
    let all: Vec<(usize, &PlaceClaim)> = walks
        .iter()
        .enumerate()
        .flat_map(|(at, walk)| walk.texts.iter().flat_map(move |text| text.claims.iter().map(move |claim| (at, claim))))
        .filter(|(_, claim)| is_known(claim))
        .collect();
    let mut by_scene: BTreeMap<&SceneId, Vec<(usize, &PlaceClaim)>> = BTreeMap::new();
    for (at, claim) in &all {
        by_scene.entry(&walks[*at].path.scene).or_default().push((*at, claim));
    }
    let mut held = Vec::new();
    for (at, walk) in walks.iter().enumerate() {
        for (number, text) in walk.texts.iter().enumerate() {
            let see = |claim: &PlaceClaim| sight_of_claim(claim, &walk.evidence, walk.around.as_ref(), weights);
            let sights: Vec<ClaimSight> = text.claims.iter().map(see).collect();
            for (place, claim) in text.claims.iter().enumerate() {
                let add = |claim: PlaceClaim, wrong: bool| {
                    let mut sight = see(&claim);
                    if let ClaimSight::Missed(missed) = &mut sight {
                        missed.keep_company(sights[..place].iter().chain(&sights[place + 1..]));
                    }
                    ClaimSample { walk: at, text: number, claim, wrong, sight }
                };
                held.push(add(claim.clone(), false));
                if !is_known(claim) {
                    continue;
                }
                if claim.is_only_room() && rng.random_bool(LABELS_SHARE) {
                    let drawn = (0..MAX_DRAWS).filter_map(|_| labels.rooms.choose(&mut rng));
                    let drawn = drawn.into_iter().find(|name| !same_room(name, &claim.name));
                    held.extend(drawn.map(|name| add(PlaceClaim { name: name.clone(), ..claim.clone() }, true)));
                    continue;
                }
                if !claim.is_only_room() && rng.random_bool(LABELS_SHARE) {
                    let here = labels.by_scene.get(&walk.path.scene).filter(|_| rng.random_bool(0.5));
                    let pool = here.unwrap_or(&labels.all);
                    let drawn = (0..MAX_DRAWS)
                        .filter_map(|_| pool.choose(&mut rng))
                        .find(|name| !names_agree(name, &claim.name));
                    held.extend(drawn.map(|name| add(rename_claim(claim, name), true)));
                    continue;
                }
                let pool = if rng.random_bool(0.5) { &by_scene[&walk.path.scene] } else { &all };
                let mut drawn = (0..MAX_DRAWS).filter_map(|_| pool.choose(&mut rng));
                let drawn = drawn.find(|(from, other)| *from != at && is_other(claim, other));
                held.extend(drawn.map(|(_, other)| add(place_claim(claim, other), true)));
            }
        }
    }
    held
}

/// Whether the lexicon knows the claimed object or room.
#[must_use]
pub fn is_known(claim: &PlaceClaim) -> bool {
    claim.is_room || find_thing(&claim.name).is_some()
}

/// Whether a claim may replace another one and has another name.
fn is_other(claim: &PlaceClaim, other: &PlaceClaim) -> bool {
    let same = names_agree(&claim.name, &other.name) || same_room(&claim.name, &other.name);
    claim.is_only_room() == other.is_only_room() && !same
}

/// A claim with the place of another one.
fn place_claim(claim: &PlaceClaim, other: &PlaceClaim) -> PlaceClaim {
    PlaceClaim { event: claim.event, span: claim.span, relation: claim.relation, ..other.clone() }
}

/// A claim of an object of another name.
fn rename_claim(claim: &PlaceClaim, name: &str) -> PlaceClaim {
    let class = find_thing(name).map_or(ThingClass::Unknown, |thing| thing.class);
    PlaceClaim { name: name.to_owned(), is_room: false, is_thing: true, class, ..claim.clone() }
}

/// The names of landmarks that labels have, each once.
#[derive(Default)]
pub struct LabelNames {
    all: Vec<String>,
    rooms: Vec<String>,
    by_scene: BTreeMap<SceneId, Vec<String>>,
}

impl LabelNames {
    /// The names in these surveys.
    #[must_use]
    pub fn from_surveys<'a>(surveys: impl Iterator<Item = (&'a SceneId, &'a ViewpointSurvey)>) -> Self {
        let is_landmark = |thing: &&LexiconThing| {
            thing.salience > 0 && !matches!(thing.class, ThingClass::Fabric | ThingClass::Door | ThingClass::Unknown)
        };
        let names = |survey: &ViewpointSurvey| -> BTreeSet<String> {
            let things = survey.objects().iter().filter_map(|placed| find_thing(&placed.name)).filter(is_landmark);
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
pub fn belongs_to_case(claim: &PlaceClaim, case: ClaimCase) -> bool {
    let at_stop = claim.relation == WalkerRelation::Stop;
    match case {
        ClaimCase::Thing => !claim.is_only_room() && !at_stop,
        ClaimCase::ThingAtStop => !claim.is_only_room() && at_stop,
        ClaimCase::Room => claim.is_only_room() && !at_stop,
        ClaimCase::RoomAtStop => claim.is_only_room() && at_stop,
        ClaimCase::RoomLacking => claim.is_only_room(),
    }
}
