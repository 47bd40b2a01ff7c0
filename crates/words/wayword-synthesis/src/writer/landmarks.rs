//! Chooses which things of a walk's memory a text names as landmarks, and where.
//!
//! Every kind of thing has one home: the spot of the text that it suits best. Each spot then names the best of the
//! things at home there. So a thing that comes or goes changes the text in its own spot only.

use super::{WritingBrief, dice::TextDice};
use rand::Rng;
use std::collections::BTreeMap;
use wayword_checks::memory::{AHEAD_FRAMES, MAX_BARE_STOP_GAP_M, MAX_TOLD_GAP_M, RememberedThing};
use wayword_core::{Side, Verdict};
use wayword_language::lexicon::{
    LexiconThing, ThingClass, find_thing, is_fabric, is_room, kinds_of, names_agree, normalise_name, to_plural,
};

/// Chooses landmarks, each kind of thing once in a text.
pub(super) struct LandmarkChooser<'a> {
    brief: &'a WritingBrief<'a>,
    /// Names that other parts of the text use: that of the task's target.
    reserved: Vec<String>,
    /// Names that checks complained about in earlier texts.
    avoided: Vec<String>,
    dice: TextDice,
}

/// A search for a thing: at a frame, with a least salience, for one use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct LandmarkSearch {
    /// The frame from which the thing has to be seen.
    pub(super) frame: usize,
    /// The frame behind what the text tells before: from there the walker looks for the thing.
    pub(super) since: usize,
    /// The least salience, as the lexicon rates things, from 0.
    pub(super) salience: u8,
    /// The use of the landmark.
    pub(super) purpose: LandmarkUse,
}

/// A spot of a text that may name a thing.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LandmarkSpot {
    /// The searches for a thing, in order; if several find the same thing, the first counts.
    pub(super) searches: Vec<LandmarkSearch>,
    /// Whether a second thing near it is named with it.
    pub(super) pair: bool,
    /// Whether it is only used if another spot finds no thing.
    pub(super) is_spare: bool,
}

/// A landmark in words.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ChosenLandmark {
    /// "the sofa", "the green lamp".
    pub(super) phrase: String,
    /// The name alone.
    pub(super) name: String,
    /// Its colour, where it is known.
    pub(super) colour: Option<String>,
    /// Whether another thing of this name with another colour is seen there.
    pub(super) needs_colour: bool,
    /// How many of its name and colour are seen there.
    pub(super) alike: usize,
    /// The side of the walker on which it is from the frame for which it was chosen.
    pub(super) side: Option<Side>,
    /// Whether it lies in front of a walker who arrives at that frame, as far as is known.
    pub(super) in_front: bool,
    /// The frame at which the walker passes it, and the side.
    pub(super) passed: Option<(usize, Side)>,
    /// The name of another thing near it that is named with it: "the table and chairs".
    pub(super) with: Option<String>,
}

/// Greatest distance of a landmark from the frame where it is named, metres.
const NEAR_M: f64 = 2.5;
/// Greatest distance of a thing at which the walker turns, metres.
const MAX_TURN_DISTANCE_M: f64 = 2.2;
/// A thing at which the walker turns is passed at most so long before the turn, metres.
const MAX_PASSED_BEFORE_TURN_M: f64 = 0.8;
/// Greatest distance of a thing that the walker stops at, metres.
const MAX_STOP_DISTANCE_M: f64 = 1.9;

/// How far to either side a walker who looks ahead sees, radians.
const VISIBLE_AHEAD_RAD: f64 = 1.05;
/// From this angle on a thing lies behind a walker who stops at a viewpoint, radians.
const BEHIND_RAD: f64 = 1.9;
/// The same for a walker whose frames lie close together: the stop is where the thing comes beside the walker.
const BESIDE_RAD: f64 = 1.5;
/// A thing closer to the walking direction than this is in front, radians.
const IN_FRONT_RAD: f64 = 1.1;
/// Things of one name are "the two chairs" if they are at most this far apart, metres.
const TOGETHER_M: f64 = 1.5;
/// Bonus, in units of a thing's value, of a thing in front of the walker at a stop.
const IN_FRONT_BONUS: f64 = 1.5;
/// Things of one name are passed together if the way between them is at most this long, metres.
const PASSED_TOGETHER_M: f64 = 0.8;
/// Greatest distance between two things that are named together, metres.
const BESIDE_M: f64 = 1.5;

// The value of a thing as a landmark is a sum without a unit; the best thing of a spot is named.
/// Weight of how often a style's texts name a thing, per unit of the natural logarithm.
const MENTIONED_WEIGHT: f64 = 0.7;
/// Weight of a thing's salience.
const SALIENCE_WEIGHT: f64 = 0.8;
/// Extra reach for wide things, metres: a bed counts as near from this much farther, seats and tables from half of it.
const WIDE_THING_REACH_M: f64 = 1.2;
/// Upper bound of the random part of a thing's value.
const MAX_CHANCE_WORTH: f64 = 1.5;
/// Share of things with a much larger random part, so that texts differ.
const MORE_CHANCE_SHARE: f64 = 0.2;
/// Deduction where the first search of the spot did not find it.
const LATER_SEARCH_COST: f64 = 2.0;
/// Deduction at a spot that replaces another one.
const SPARE_SPOT_COST: f64 = 1.0;
/// Bonus of a thing at the stop of the walk.
const STOP_BONUS: f64 = 0.5;

/// The use of a landmark in a text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LandmarkUse {
    /// It is named while the walker is at a frame.
    Here,
    /// The walker turns there.
    Turn,
    /// The walker goes to it or past it on the way to a frame.
    Onward,
    /// The walker stops there.
    Stop,
    /// The same where nothing fixes the spot better: also at a rug, or at one of several alike. The checks decide whether it holds.
    StopAtAny,
}

impl LandmarkUse {
    /// Whether the walker stops there.
    fn is_stop(self) -> bool {
        matches!(self, Self::Stop | Self::StopAtAny)
    }
}

/// A kind of thing with its best spot.
struct LandmarkHome<'a> {
    /// The number of the spot.
    spot: usize,
    /// The value of the thing there.
    worth: f64,
    seen: &'a RememberedThing,
    /// The search that found it; `None` if it is only named together with another thing.
    found_by: Option<LandmarkSearch>,
}

impl LandmarkHome<'_> {
    /// Whether a thing suits this spot better than another one. The stop takes precedence over things that are passed.
    fn goes_before(&self, other: &Self) -> bool {
        let rank = |at: &LandmarkHome<'_>| (at.found_by.is_some(), at.worth + at.stop_bonus());
        let ((is_found, worth), (other_is_found, other_worth)) = (rank(self), rank(other));
        (is_found, worth) > (other_is_found, other_worth)
    }

    /// The bonus for being at the stop, where the search was for the stop.
    fn stop_bonus(&self) -> f64 {
        if self.found_by.is_some_and(|search| search.purpose.is_stop()) { STOP_BONUS } else { 0.0 }
    }
}

impl LandmarkSearch {
    /// The search for a second thing near the first.
    fn search_beside(self) -> Self {
        Self { purpose: if self.purpose.is_stop() { self.purpose } else { LandmarkUse::Here }, ..self }
    }
}

impl<'a> LandmarkChooser<'a> {
    /// Avoids names that checks complained about in earlier texts.
    pub(super) fn new(brief: &'a WritingBrief<'a>, dice: TextDice) -> Self {
        let blamed = brief.complaints.iter().flat_map(|complaint| {
            let failed = complaint.findings.iter().filter(|finding| finding.verdict != Verdict::Pass);
            failed.filter_map(|finding| complaint.text.get(finding.span?[0]..finding.span?[1])).map(normalise_name)
        });
        Self { brief, reserved: Vec::new(), avoided: blamed.collect(), dice }
    }

    /// Whether a name may be used: neither reserved nor avoided.
    fn is_free(&self, name: &str) -> bool {
        !self.reserved.iter().any(|other| names_agree(other, name))
            && !self
                .avoided
                .iter()
                .any(|blamed| *blamed == normalise_name(name) || blamed.ends_with(&normalise_name(name)))
    }

    /// Keeps a name from being used as a landmark.
    pub(super) fn reserve_name(&mut self, name: &str) {
        self.reserved.push(normalise_name(name));
    }

    /// The landmark of at least that salience that identifies a frame best, if there is one.
    pub(super) fn choose_for_frame(&self, frame: usize, salience: u8) -> Option<ChosenLandmark> {
        let search = LandmarkSearch { frame, since: frame, salience, purpose: LandmarkUse::Here };
        let found = self.brief.memory.seen_from(frame).filter(|seen| self.search_finds(search, seen));
        let best = found.max_by(|a, b| self.landmark_worth(a, search).total_cmp(&self.landmark_worth(b, search)))?;
        Some(self.describe_landmark(best, frame))
    }

    /// The landmark of each spot, if it has one. Each kind of thing belongs to its best spot, independently of other
    /// things, and each spot names the best of its own.
    pub(super) fn landmarks_at(&self, spots: &[LandmarkSpot]) -> Vec<Option<ChosenLandmark>> {
        let mut homes: BTreeMap<String, LandmarkHome<'_>> = BTreeMap::new();
        for seen in &self.brief.memory.things {
            let Some(best) = self.best_spot(seen, spots) else { continue };
            let kind = thing_kind(&seen.name);
            match homes.get_mut(&kind) {
                Some(home) if !best.goes_before(home) => {}
                Some(home) => *home = best,
                None => {
                    homes.insert(kind, best);
                }
            }
        }
        let of_spot = |number: usize| homes.values().filter(move |home| home.spot == number);
        (0..spots.len())
            .map(|number| {
                let found = of_spot(number).filter(|home| home.found_by.is_some());
                let best = found.max_by(|a, b| a.worth.total_cmp(&b.worth))?;
                let search = best.found_by?;
                let landmark = self.describe_landmark(best.seen, search.frame);
                let others = of_spot(number).filter(|home| home.seen != best.seen);
                let with = self.name_beside(best.seen, search, others).filter(|_| spots[number].pair);
                Some(ChosenLandmark { with, ..landmark })
            })
            .collect()
    }

    /// The best spot for a thing.
    fn best_spot(&self, seen: &'a RememberedThing, spots: &[LandmarkSpot]) -> Option<LandmarkHome<'a>> {
        let home_at = |(spot, LandmarkSpot { searches, pair, is_spare }): (usize, &LandmarkSpot)| {
            let found = searches.iter().enumerate().find(|(_, search)| self.search_finds(**search, seen));
            if let Some((rank, search)) = found {
                let deduction = LATER_SEARCH_COST * rank.min(1) as f64 + if *is_spare { SPARE_SPOT_COST } else { 0.0 };
                let worth = self.landmark_worth(seen, *search) - deduction;
                return Some(LandmarkHome { spot, worth, seen, found_by: Some(*search) });
            }
            let beside = searches.first().filter(|_| *pair)?;
            let here = LandmarkSearch { salience: 1, ..beside.search_beside() };
            self.search_finds(here, seen).then(|| LandmarkHome {
                spot,
                worth: self.landmark_worth(seen, here),
                seen,
                found_by: None,
            })
        };
        let mut best: Option<LandmarkHome<'a>> = None;
        for found in spots.iter().enumerate().filter_map(home_at) {
            if best.as_ref().is_none_or(|before| found.goes_before(before)) {
                best = Some(found);
            }
        }
        best
    }

    /// Whether a search finds a thing.
    fn search_finds(&self, search: LandmarkSearch, seen: &RememberedThing) -> bool {
        seen.glimpse_from(search.frame).is_some()
            && is_tellable(&seen.name, search.salience)
            && self.is_free(&seen.name)
            && self.fits_use(seen, search.frame, search.purpose)
            && (search.purpose != LandmarkUse::Onward || self.shows_way(seen, search))
    }

    /// Whether a walker who has done what the text tells before, and goes straight on, comes to see a thing ahead.
    fn shows_way(&self, seen: &RememberedThing, LandmarkSearch { frame, since, .. }: LandmarkSearch) -> bool {
        let memory = self.brief.memory;
        let is_ahead = |at: usize| seen.is_ahead_from(&(at..=at)) && memory.goes_straight(since, at);
        frame >= since && (memory.is_on_graph() || seen.position.is_none() || (since..=frame).any(is_ahead))
    }

    /// The value of a thing as the landmark of a search.
    fn landmark_worth(&self, seen: &RememberedThing, LandmarkSearch { frame, purpose: to, .. }: LandmarkSearch) -> f64 {
        let kind = thing_kind(&seen.name);
        // Now and then the random part dominates, so that texts differ.
        let chance = if self.dice.named_rng(&["rare", &kind]).random_bool(MORE_CHANCE_SHARE) {
            4.0 * MAX_CHANCE_WORTH
        } else {
            MAX_CHANCE_WORTH
        };
        let ahead = if to.is_stop() && is_in_front(seen, frame) { IN_FRONT_BONUS } else { 0.0 };
        let mut drawn = self.dice.named_rng(&["thing", &kind]);
        self.landmark_score(seen, frame) + ahead + drawn.random_range(0.0..chance)
    }

    /// The name of another thing of the same spot near the landmark.
    fn name_beside<'b>(
        &self,
        landmark: &RememberedThing,
        search: LandmarkSearch,
        others: impl Iterator<Item = &'b LandmarkHome<'b>>,
    ) -> Option<String> {
        let (memory, here) = (self.brief.memory, search.search_beside());
        let place = landmark.position?;
        let beside = others.map(|other| other.seen).filter(|seen| {
            let is_beside = seen.position.is_some_and(|other| other.distance(place) <= BESIDE_M);
            let is_other = !names_agree(&seen.name, &landmark.name) && seen.colour.is_none();
            is_beside && is_other && self.fits_use(seen, here.frame, here.purpose)
        });
        let best =
            beside.max_by(|a, b| self.landmark_score(a, here.frame).total_cmp(&self.landmark_score(b, here.frame)))?;
        let alike = memory
            .seen_from(here.frame)
            .filter(|other| normalise_name(&other.name) == normalise_name(&best.name))
            .count();
        Some(if alike > 1 { to_plural(&best.name) } else { best.name.clone() })
    }

    /// Whether a thing suits a use at a frame: near enough, and in a direction that the use allows.
    fn fits_use(&self, seen: &RememberedThing, frame: usize, to: LandmarkUse) -> bool {
        let memory = self.brief.memory;
        let wide_m = match find_thing(&seen.name).map(|thing| thing.class) {
            Some(ThingClass::Bed) => WIDE_THING_REACH_M,
            Some(ThingClass::Seat | ThingClass::Surface) => WIDE_THING_REACH_M / 2.0,
            _ => 0.0,
        };
        let most_m = match to {
            LandmarkUse::Stop | LandmarkUse::StopAtAny => MAX_STOP_DISTANCE_M,
            LandmarkUse::Here | LandmarkUse::Turn => MAX_TURN_DISTANCE_M,
            LandmarkUse::Onward => NEAR_M + wide_m,
        };
        let is_near = memory.distance_m(seen, frame).is_none_or(|distance_m| distance_m <= most_m);
        let side = memory.side_at(seen, frame);
        let is_there = match to {
            // A walker who comes to a rug or stands on it is at no one place.
            LandmarkUse::Here | LandmarkUse::Turn | LandmarkUse::Stop
                if lies_on_floor(&seen.name) && seen.position.is_some() =>
            {
                false
            }
            // Whoever turns where a thing is passed turns before what comes after it.
            LandmarkUse::Turn if self.is_passed_before(seen, frame) => false,
            LandmarkUse::Here | LandmarkUse::Turn => {
                side != Some(Side::Behind) && was_seen(seen, frame, VISIBLE_AHEAD_RAD)
            }
            // Whoever is sent to a thing just before the end goes on until it is reached.
            LandmarkUse::Onward if self.lies_beyond_end(seen, frame) => false,
            LandmarkUse::Onward => was_ahead(seen, frame) && (side == Some(Side::Ahead) || self.is_passed(seen, frame)),
            LandmarkUse::Stop | LandmarkUse::StopAtAny => {
                side != Some(Side::Behind) && self.can_stop_at(seen, frame, to)
            }
        };
        let before = frame.saturating_sub(1);
        let is_in_room = match to {
            LandmarkUse::Stop | LandmarkUse::StopAtAny => true,
            LandmarkUse::Here | LandmarkUse::Turn => memory.shares_room(seen, frame..=frame),
            LandmarkUse::Onward => memory.shares_room(seen, before..=frame),
        };
        // Without positions the directions of things are unknown.
        is_near && is_in_room && (is_there || side.is_none())
    }

    /// Whether a thing fixes the spot where the walk stops. At viewpoints, which lie far apart, any thing may where nothing does it better.
    fn can_stop_at(&self, seen: &RememberedThing, frame: usize, to: LandmarkUse) -> bool {
        let memory = self.brief.memory;
        let is_any = to == LandmarkUse::StopAtAny;
        let is_fixed = || self.ends_at(seen, frame) && memory.shares_room(seen, frame..=frame);
        let is_alone = || !self.has_other_before(seen, MAX_BARE_STOP_GAP_M) && !self.has_other_ahead(seen, frame);
        !hangs_overhead(&seen.name)
            && !self.has_other_before(seen, MAX_TOLD_GAP_M)
            && (is_any && memory.is_on_graph() || is_fixed())
            && (is_any && (memory.is_on_graph() || !is_picture(&seen.name)) || is_alone())
    }

    /// Whether a walker who stops at a frame comes to a thing: it was ahead just before, and was not left behind.
    fn ends_at(&self, seen: &RememberedThing, frame: usize) -> bool {
        let memory = self.brief.memory;
        let behind_rad = if memory.is_on_graph() { BEHIND_RAD } else { BESIDE_RAD };
        let is_behind = memory.turn_towards(seen, frame).is_some_and(|turn_rad| turn_rad.abs() > behind_rad);
        was_ahead(seen, frame) && !is_behind && !memory.is_left_behind(seen)
    }

    /// Whether the walk comes to another thing of the same name, not beside it, in its last room, more than `gap_m` metres before its end.
    fn has_other_before(&self, seen: &RememberedThing, gap_m: f64) -> bool {
        let memory = self.brief.memory;
        let is_other = |other: &&RememberedThing| {
            *other != seen && names_agree(&other.name, &seen.name) && !stand_together(seen, other)
        };
        memory.things.iter().filter(is_other).any(|other| memory.is_met_before_end(other, gap_m))
    }

    /// Whether a walker who comes to a frame sees another thing of the same name ahead in the room, not beside it.
    fn has_other_ahead(&self, seen: &RememberedThing, frame: usize) -> bool {
        let memory = self.brief.memory;
        let is_other = |other: &&RememberedThing| {
            *other != seen && names_agree(&other.name, &seen.name) && !stand_together(seen, other)
        };
        let is_here = |other: &RememberedThing| {
            memory.shares_room(other, frame..=frame) && was_seen(other, frame, VISIBLE_AHEAD_RAD)
        };
        !memory.is_on_graph() && memory.things.iter().filter(is_other).any(is_here)
    }

    /// Whether a frame lies just before the end, and a thing ahead lies farther than the walk goes.
    fn lies_beyond_end(&self, seen: &RememberedThing, frame: usize) -> bool {
        let memory = self.brief.memory;
        let end = memory.frame_count().saturating_sub(1);
        let is_far = memory.distance_m(seen, end).is_some_and(|far_m| far_m > MAX_STOP_DISTANCE_M);
        is_far && memory.walked_m(frame, end) <= MAX_BARE_STOP_GAP_M && memory.side_at(seen, end) == Some(Side::Ahead)
    }

    /// Whether the walker passes a thing on the way to a frame, behind the turn with which that way begins.
    fn is_passed(&self, seen: &RememberedThing, frame: usize) -> bool {
        let memory = self.brief.memory;
        let before = frame.saturating_sub(1);
        let turn = memory.bends.iter().find(|bend| (bend.first..=bend.last).contains(&before));
        let begin_m = memory.walked_m(0, turn.map_or(before, |bend| bend.last));
        seen.passed.is_some_and(|passed| {
            (before..=frame).contains(&passed.frame)
                && (turn.is_none() || seen.position.is_none() || passed.along_m >= begin_m)
        })
    }

    /// Whether the walker has passed a thing some way before a frame.
    fn is_passed_before(&self, seen: &RememberedThing, frame: usize) -> bool {
        let here_m = self.brief.memory.walked_m(0, frame);
        let has_door_between = |from: usize| {
            self.brief.memory.openings.iter().any(|opening| from <= opening.before && opening.behind <= frame)
        };
        seen.passed.filter(|_| seen.position.is_some()).is_some_and(|passed| {
            passed.along_m < here_m - MAX_PASSED_BEFORE_TURN_M
                || self.brief.memory.knows_doors() && has_door_between(passed.frame)
        })
    }

    /// The fixed part of a thing's value: high for salient things that people often name, that are near the frame and
    /// rare in the walk.
    fn landmark_score(&self, seen: &RememberedThing, frame: usize) -> f64 {
        let memory = self.brief.memory;
        let known = find_thing(&seen.name);
        let salience = known.map_or(0.0, |thing| f64::from(thing.salience));
        let mentions = known.map_or(0.0, |thing| self.brief.profile.way.thing_mentions(thing.name));
        let far_m = memory.distance_m(seen, frame).unwrap_or(NEAR_M);
        let alike = || memory.things.iter().filter(|other| names_agree(&other.name, &seen.name));
        let elsewhere = alike().filter(|other| other.glimpse_from(frame).is_none()).count();
        let earlier = alike().filter(|other| other.first_seen() < frame);
        let on_wall = known.is_some_and(|thing| matches!(thing.class, ThingClass::WallArt | ThingClass::Glass));
        salience * SALIENCE_WEIGHT - f64::from(u8::from(on_wall)) + mentions.ln_1p() * MENTIONED_WEIGHT
            - far_m * 0.5
            - elsewhere.min(5) as f64 * 0.6
            - earlier.count().min(3) as f64 * 0.5
    }

    /// A thing as a landmark at a frame: its words, and how many alike are there.
    fn describe_landmark(&self, seen: &RememberedThing, frame: usize) -> ChosenLandmark {
        let name = seen.name.clone();
        let phrase = match &seen.colour {
            Some(colour) => format!("the {colour} {name}"),
            None => format!("the {name}"),
        };
        let memory = self.brief.memory;
        let is_alike = |other: &&RememberedThing| {
            normalise_name(&other.name) == normalise_name(&seen.name) && other.colour == seen.colour
        };
        let stands_by = |other: &&RememberedThing| match (seen.position, other.position) {
            (Some(here), Some(there)) => here.distance(there) <= TOGETHER_M,
            _ => true,
        };
        // Of several that stand together the walker may turn off before the second.
        let is_passed_with = |other: &&RememberedThing| match (seen.passed, other.passed) {
            (Some(own), Some(other)) => own.side == other.side && other.along_m - own.along_m <= PASSED_TOGETHER_M,
            (own, _) => own.is_none() || memory.is_on_graph(),
        };
        let alike = memory.seen_from(frame).filter(is_alike).filter(stands_by).filter(is_passed_with).count();
        let like = |other: &&RememberedThing| normalise_name(&other.name) == normalise_name(&seen.name);
        let needs_colour = memory.seen_from(frame).filter(like).any(|other| other.colour != seen.colour);
        let passed = seen.passed.map(|passed| (passed.frame, passed.side));
        ChosenLandmark {
            in_front: is_in_front(seen, frame),
            phrase,
            name,
            colour: seen.colour.clone(),
            needs_colour,
            alike,
            side: memory.side_at(seen, frame),
            passed,
            with: None,
        }
    }
}

/// Whether two things of one name stand so close together that a text means both.
fn stand_together(one: &RememberedThing, other: &RememberedThing) -> bool {
    one.position.zip(other.position).is_some_and(|(here, there)| here.distance(there) <= TOGETHER_M)
}

/// The kind of a thing, which names its random draws: it is the same from other frames and on other platforms.
fn thing_kind(name: &str) -> String {
    kinds_of(name).swap_remove(0)
}

/// Whether a name is suitable for a landmark: known as a thing that helps, and not the name of a room or list.
fn is_tellable(name: &str, salience: u8) -> bool {
    let plain =
        name.len() <= 30 && name.chars().all(|c| c.is_alphabetic() || c == ' ' || c == '-') && !name.contains(" and ");
    let is_fixed = |class: ThingClass| matches!(class, ThingClass::Door | ThingClass::Stairs | ThingClass::Switch);
    // Lamps are landmarks; other lights are too common.
    let is_faint = |thing: &LexiconThing| thing.salience == 1 && thing.class == ThingClass::Light;
    let tells =
        find_thing(name).is_some_and(|thing| thing.salience >= salience && !is_fixed(thing.class) && !is_faint(thing));
    plain && !is_room(&normalise_name(name)) && !is_fabric(name) && tells
}

/// Whether a walker who looks this far to either side has seen a thing by the time of a frame, as far as is known. A
/// thing that is only visible behind the walker is no landmark.
fn was_seen(seen: &RememberedThing, frame: usize, aside_rad: f64) -> bool {
    let within = |turn_rad: Option<f64>| turn_rad.is_none_or(|turn_rad| turn_rad.abs() <= aside_rad);
    seen.glimpses.iter().any(|glimpse| glimpse.frame <= frame && within(glimpse.turn_rad))
}

/// Whether a thing is a picture or the like, of which a room has many.
fn is_picture(name: &str) -> bool {
    find_thing(name).is_some_and(|thing| thing.class == ThingClass::WallArt)
}

/// Whether a thing is a part of the floor, as a rug.
pub(super) fn lies_on_floor(name: &str) -> bool {
    find_thing(name).is_some_and(|thing| thing.class == ThingClass::Floor)
}

/// Whether a thing hangs overhead, so that a walker does not stop at it.
fn hangs_overhead(name: &str) -> bool {
    let is_lamp_by_hand = |name: &str| name.ends_with("lamp");
    find_thing(name).is_some_and(|thing| thing.class == ThingClass::Light) && !is_lamp_by_hand(name)
}

/// Whether a walker saw a thing ahead at a frame or not long before.
fn was_ahead(seen: &RememberedThing, frame: usize) -> bool {
    seen.is_ahead_from(&(frame.saturating_sub(AHEAD_FRAMES)..=frame))
}

/// Whether a thing lies in front of a walker who arrives at a frame, as far as is known.
fn is_in_front(seen: &RememberedThing, frame: usize) -> bool {
    let turn_rad = seen.glimpse_from(frame).and_then(|glimpse| glimpse.turn_rad);
    turn_rad.is_none_or(|turn_rad| turn_rad.abs() < IN_FRONT_RAD)
}
