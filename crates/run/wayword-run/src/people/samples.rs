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
/// Most draws to find another name. A claim for which none is found gets no wrong claim.
const MAX_DRAWS: usize = 30;

/// A claim, checked against the evidence of a path.
pub struct ClaimSample {
    /// The index of its walk in the list of walks.
    pub walk: usize,
    /// The index of its text among the texts of the walk.
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

/// Returns every claim of every text. For each known claim it adds a wrong one, in which the name of another room or
/// object takes the place of the right name. A third of the other names come from labels: those of objects half from
/// the same building and half from any, those of rooms from any building. The rest come from texts about other paths,
/// half of them of the same building and half of any.
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
    let mut samples = Vec::new();
    for (at, walk) in walks.iter().enumerate() {
        for (number, text) in walk.texts.iter().enumerate() {
            let see = |claim: &PlaceClaim| sight_of_claim(claim, &walk.evidence, walk.around.as_ref(), weights);
            let sights: Vec<ClaimSight> = text.claims.iter().map(see).collect();
            for (place, claim) in text.claims.iter().enumerate() {
                let make_sample = |claim: PlaceClaim, wrong: bool| {
                    let mut sight = see(&claim);
                    if let ClaimSight::Missed(missed) = &mut sight {
                        missed.add_company_features(sights[..place].iter().chain(&sights[place + 1..]));
                    }
                    ClaimSample { walk: at, text: number, claim, wrong, sight }
                };
                samples.push(make_sample(claim.clone(), false));
                if !is_known(claim) {
                    continue;
                }
                if claim.is_only_room() && rng.random_bool(LABELS_SHARE) {
                    let drawn = (0..MAX_DRAWS).filter_map(|_| labels.rooms.choose(&mut rng));
                    let drawn = drawn.into_iter().find(|name| !same_room(name, &claim.name));
                    samples.extend(
                        drawn.map(|name| make_sample(PlaceClaim { name: name.clone(), ..claim.clone() }, true)),
                    );
                    continue;
                }
                if !claim.is_only_room() && rng.random_bool(LABELS_SHARE) {
                    let scene_names = labels.by_scene.get(&walk.path.scene).filter(|_| rng.random_bool(0.5));
                    let pool = scene_names.unwrap_or(&labels.all);
                    let drawn = (0..MAX_DRAWS)
                        .filter_map(|_| pool.choose(&mut rng))
                        .find(|name| !names_agree(name, &claim.name));
                    samples.extend(drawn.map(|name| make_sample(rename_claim(claim, name), true)));
                    continue;
                }
                let pool = if rng.random_bool(0.5) { &by_scene[&walk.path.scene] } else { &all };
                let mut drawn = (0..MAX_DRAWS).filter_map(|_| pool.choose(&mut rng));
                let drawn = drawn.find(|(from, other)| *from != at && can_replace(claim, other));
                samples.extend(drawn.map(|(_, other)| make_sample(move_claim(claim, other), true)));
            }
        }
    }
    samples
}

/// Whether the lexicon knows the claimed object or room.
#[must_use]
pub fn is_known(claim: &PlaceClaim) -> bool {
    claim.is_room || find_thing(&claim.name).is_some()
}

/// Whether a claim may replace another one and has another name.
fn can_replace(claim: &PlaceClaim, other: &PlaceClaim) -> bool {
    let same = names_agree(&claim.name, &other.name) || same_room(&claim.name, &other.name);
    claim.is_only_room() == other.is_only_room() && !same
}

/// The claim `other`, put into the place of `claim` in its text.
fn move_claim(claim: &PlaceClaim, other: &PlaceClaim) -> PlaceClaim {
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
    /// Objects of all scenes.
    all: Vec<String>,
    /// Rooms of all scenes.
    rooms: Vec<String>,
    /// Objects by scene.
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

/// Whether a claim is weighed by the table of this case where the labels around the path lack it.
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
