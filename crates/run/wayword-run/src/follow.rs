//! Follows a text through a building with the rules of `wayword-follower`. Finds turns that are wrong, whether the text leads to
//! another place than its path, and how many places it may mean.

use crate::{error::CommandError, platforms::MAX_KEPT_SURVEYS};
use serde::Serialize;
use std::{
    collections::BTreeSet,
    sync::{Arc, LazyLock},
};
use wayword_checks::{
    CheckWorld, Evidence, FrameEvidence, TextFindings, TurnJudge, WalkMemory, align_with_walk, count_objects_meant,
};
use wayword_core::{
    CheckFinding, CheckKind, DVec3, Frame, Heading, InstructionPart, Path, Platform, Pose, RecentCache, SceneId,
    TextAmbiguity, Verdict, ViewpointSurvey,
};
use wayword_follower::{
    FeatureWeights, Guide, KnownBuilding, PathPlace, PathThing, WalkOnGraph, WalkPrior,
    alignment::{AlignmentCase, AlignmentWeights, PartReading, PartedText},
    route::{GainThresholds, KnownWalk, RouteVerdict, UnfollowedReason, goal_probability, judge_route, judge_steps},
};
use wayword_language::{
    Language,
    reading::{TextReading, read_instruction},
};
use wayword_synthesis::offline::BuildingListing;
use wayword_world::survey_scene;

/// A scene that was surveyed.
pub(crate) struct KnownScene {
    /// Its viewpoints.
    pub(crate) survey: ViewpointSurvey,
    /// Its listed objects, for the checks.
    pub(crate) inventory: Arc<wayword_checks::BuildingInventory>,
    /// The same list, for the description of a target.
    pub(crate) listing: BuildingListing,
    /// The building as the follower knows it: viewpoints, rooms and things.
    pub(crate) building: KnownBuilding,
}

/// A cache of the scenes that were surveyed last.
pub struct KnownScenes(RecentCache<SceneId, KnownScene>);

impl KnownScenes {
    /// An empty cache.
    #[must_use]
    pub fn new() -> Self {
        Self(RecentCache::new(MAX_KEPT_SURVEYS))
    }

    /// A scene, surveyed if it is not known. It has no viewpoints where the platform has no graph.
    pub(crate) fn get_or_survey(
        &self,
        platform: &dyn Platform,
        scene: &SceneId,
    ) -> Result<Arc<KnownScene>, CommandError> {
        self.0.get_or_make(scene.clone(), || {
            let survey = survey_scene(platform, scene)?;
            let listed = Arc::new(wayword_checks::BuildingInventory::from_survey(&survey));
            let followed = KnownBuilding::from_survey(&survey);
            let listing = BuildingListing::from_survey(&survey);
            Ok(KnownScene { survey, inventory: listed, listing, building: followed })
        })
    }
}

impl Default for KnownScenes {
    fn default() -> Self {
        Self::new()
    }
}

/// The weights of the follower that chooses between candidate texts. They differ from those that judge texts and from those of
/// the agents, so that a text chosen because it suits one set of weights by chance has no advantage when it is judged.
static CHOICE_WEIGHTS: LazyLock<FeatureWeights> = LazyLock::new(FeatureWeights::by_hand);

/// A path as the follower knows it.
pub(crate) struct FollowedPath<'a> {
    place: FollowedPlace<'a>,
    /// The viewpoints of the path, as indices into the building.
    walk: Vec<usize>,
    /// The heading at the start, radians clockwise from north.
    heading_rad: f64,
}

/// The surroundings of a path, as far as they are known.
enum FollowedPlace<'a> {
    /// The building with its viewpoint graph.
    Graph(&'a KnownScene),
    /// A path that leaves the viewpoints of its building.
    JoinedGraph {
        /// The building with its viewpoint graph, on which the path was put.
        building: KnownBuilding,
        /// The frames of the path. The parts of a text are aligned with them alone.
        frames: Vec<PathPlace>,
    },
    /// The path alone: there is no graph, so no other walk is known.
    PathAlone(KnownBuilding),
}

/// How likely each of some texts leads to the end of a path, by its evidence and the survey of its scene; `None` for a text that cannot
/// be followed.
///
/// # Errors
/// When the platform cannot list its scene.
pub fn shares_of_arriving(
    platform: &dyn Platform,
    scenes: &KnownScenes,
    path: &Path,
    evidence: &Evidence,
    texts: &[&str],
) -> Result<Vec<Option<f64>>, CommandError> {
    let scene = scenes.get_or_survey(platform, &path.scene)?;
    let followed = FollowedPath::new(platform, Some(&scene), path, evidence);
    Ok(texts.iter().map(|text| followed.as_ref().ok()?.leads_there(text)).collect())
}

/// The result of following a text.
pub(crate) struct FollowerFindings {
    /// The finding about the route, and findings about wrong turns.
    pub(crate) findings: Vec<CheckFinding>,
    /// `None` if the text could not be followed.
    pub(crate) route: Option<RouteShares>,
    /// How much the text would fit better with its most doubtful turn reversed: a difference of natural logs of likelihood.
    pub(crate) turn_gain: Option<f64>,
    /// The places where the text may end; `None` if it could not be followed.
    pub(crate) ends: Option<TextEnds>,
    /// Whether its turns were judged.
    pub(crate) turns: TurnJudge,
    /// Whether the walks were compared over a graph of the ground, and not over the viewpoints of a dataset. The weights were fitted to
    /// the latter.
    is_over_ground: bool,
}

/// How likely it is that a text means a walk, among the walks that the follower thinks of.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct RouteShares {
    /// The annotated walk.
    pub annotated: f64,
    /// The likeliest other walk that ends elsewhere.
    pub other: f64,
}

/// The ends that a text may mean.
pub(crate) struct TextEnds {
    /// Number of places where the text may end, the end of the path among them.
    pub(crate) count: usize,
    /// A thing or room that only the end of the path has, if there is one: naming it would settle which end is meant.
    pub(crate) told_apart_by: Option<String>,
}

impl<'a> FollowedPath<'a> {
    /// A path in its scene. If the path does not go along the viewpoints of the scene's graph, its places are joined to them; without a
    /// graph, the building consists of its own frames and what they show.
    ///
    /// # Errors
    /// With the reason, where its motion is unknown, or it goes nowhere.
    pub(crate) fn new(
        platform: &dyn Platform,
        scene: Option<&'a KnownScene>,
        path: &Path,
        evidence: &Evidence,
    ) -> Result<Self, &'static str> {
        if !path.motion.is_known() {
            return Err(UNKNOWN_MOTION_REASON);
        }
        let Some(first) = path.frames.first().filter(|_| evidence.goes_anywhere()) else {
            return Err("its path is one place, so it goes nowhere");
        };
        let heading_rad = first.pose.heading.rad();
        let on_graph = |scene: &KnownScene| {
            let place = |frame: &Frame| scene.survey.viewpoint_index(frame.viewpoint.as_ref()?);
            path.frames.iter().map(place).collect::<Option<Vec<usize>>>()
        };
        if let Some((scene, walk)) = scene.and_then(|scene| Some((scene, on_graph(scene)?))) {
            return Ok(Self { place: FollowedPlace::Graph(scene), walk, heading_rad });
        }
        let places: Vec<PathPlace> = path.frames.iter().zip(&evidence.frames).map(path_place).collect();
        let Some(scene) = scene.filter(|scene| !scene.building.is_empty()) else {
            let walk = (0..places.len()).collect();
            return Ok(Self { place: FollowedPlace::PathAlone(KnownBuilding::along_path(places)), walk, heading_rad });
        };
        let knows_ground = path
            .frames
            .windows(2)
            .any(|pair| matches!(platform.ground().ground_route(&path.scene, &pair[0], &pair[1]), Ok(Some(_))));
        let can_walk = |from: DVec3, to: DVec3| match knows_ground {
            true => walks_straight(platform, &path.scene, from, to),
            false => from.distance(to) <= ASSUMED_STRAIGHT_M && (from.z - to.z).abs() <= ASSUMED_LEVEL_M,
        };
        let WalkOnGraph { building, walk } = WalkOnGraph::new(&scene.building, &places, &can_walk);
        let place = FollowedPlace::JoinedGraph { building, frames: places };
        Ok(Self { place, walk, heading_rad })
    }

    /// Follows the steps of a text, and judges its route and its single steps.
    pub(crate) fn follow_guide(&self, guide: &Guide) -> FollowerFindings {
        let mut followed = self.judge_guide(guide);
        if followed.turns == TurnJudge::JudgedElsewhere {
            let judged = judge_steps(guide, self.known_path(), FeatureWeights::fitted(), GainThresholds::default());
            followed.findings.extend(judged.wrong);
            followed.turn_gain = judged.turn_gain;
        }
        followed
    }

    /// Aligns a text with the path: its parts, each with the frames that it describes. Where the path is known well enough, the claims of
    /// the text decide; else the weights of the follower.
    ///
    /// # Errors
    /// With the reason, where the text cannot be followed.
    pub(crate) fn align_text(
        &self,
        text: &str,
        tag: Option<&str>,
        known: (&Evidence, &WalkMemory),
    ) -> Result<Vec<InstructionPart>, &'static str> {
        let (_, reading) = read_followable(text, tag)?;
        Ok(self.align_reading(text, &reading, known))
    }

    /// As [`Self::align_text`], for a text that was read before.
    pub(crate) fn align_reading(
        &self,
        text: &str,
        reading: &TextReading,
        known: (&Evidence, &WalkMemory),
    ) -> Vec<InstructionPart> {
        if let Some(parts) = align_with_walk(text, known) {
            return parts;
        }
        let parted = PartedText::from_reading(text, reading);
        let (alone, frame_numbers): (KnownBuilding, Vec<usize>);
        let path = match &self.place {
            FollowedPlace::JoinedGraph { frames, .. } => {
                alone = KnownBuilding::along_path(frames.clone());
                frame_numbers = (0..frames.len()).collect();
                KnownWalk { building: &alone, walk: &frame_numbers, heading_rad: self.heading_rad }
            }
            FollowedPlace::Graph(_) | FollowedPlace::PathAlone(_) => self.known_path(),
        };
        let case = AlignmentCase::new(&parted, path.building, path.walk, path.heading_rad, FeatureWeights::fitted());
        case.align_parts(AlignmentWeights::fitted(PartReading::Words)).into_parts()
    }

    /// Whether another way than that of the path is open at a frame. Where no graph says so, one may be.
    pub(crate) fn has_other_way(&self, frame: usize) -> bool {
        /// Ways in directions that differ by less are one way, radians.
        const SAME_WAY_RAD: f64 = 0.6;
        let FollowedPlace::Graph(scene) = &self.place else { return true };
        let all = scene.survey.viewpoints();
        let at = |frame: usize| all.get(*self.walk.get(frame)?);
        let (Some(here), Some(next)) = (at(frame), at(frame + 1)) else { return true };
        let before = frame.checked_sub(1).and_then(at);
        let towards = |to: DVec3| Heading::towards(here.position, to);
        let known: Vec<Heading> =
            [Some(next), before].into_iter().flatten().filter_map(|place| towards(place.position)).collect();
        let neighbours = here.neighbours.iter().filter_map(|neighbour| all.get(*neighbour));
        let mut ways = neighbours.filter_map(|neighbour| towards(neighbour.position));
        ways.any(|way| known.iter().all(|known| known.turn_to(way).abs() >= SAME_WAY_RAD))
    }

    /// Only judges where a text leads, without its single turns.
    pub(crate) fn judge_route(&self, text: &str) -> FollowerFindings {
        read_guide(text).map_or_else(FollowerFindings::not_followed, |guide| self.judge_guide(&guide))
    }

    /// How likely a text leads to the end of the path, for the choice between texts; `None` where it cannot be followed.
    pub(crate) fn leads_there(&self, text: &str) -> Option<f64> {
        let guide = read_guide(text).ok()?;
        goal_probability(&guide, self.known_path(), self.walk_prior(), &CHOICE_WEIGHTS).ok()
    }

    /// The prior over other walks; `None` if the path alone is known.
    fn walk_prior(&self) -> Option<WalkPrior> {
        match self.place {
            FollowedPlace::PathAlone(_) => None,
            FollowedPlace::Graph(_) => Some(WalkPrior::default()),
            // Such paths can be longer than those of R2R.
            FollowedPlace::JoinedGraph { .. } => Some(WalkPrior::Shortest(self.walk.len().max(8))),
        }
    }

    pub(crate) fn known_path(&self) -> KnownWalk<'_> {
        let building = match &self.place {
            FollowedPlace::Graph(scene) => &scene.building,
            FollowedPlace::JoinedGraph { building, .. } | FollowedPlace::PathAlone(building) => building,
        };
        KnownWalk { building, walk: &self.walk, heading_rad: self.heading_rad }
    }

    /// Judges where the steps of a text lead. The turns are left to the caller, which `TurnJudge::JudgedElsewhere`
    /// marks.
    fn judge_guide(&self, guide: &Guide) -> FollowerFindings {
        let known = self.known_path();
        let routed = judge_route(guide, known, self.walk_prior(), FeatureWeights::fitted(), GainThresholds::default());
        let apart = |route: &RouteVerdict| match route.ends.split_first() {
            Some((own, others)) if !others.is_empty() => {
                known.building.distinguishing_name(*own, others, &guide.end_names()).map(str::to_owned)
            }
            _ => None,
        };
        if let Err(why @ (UnfollowedReason::TooManySteps | UnfollowedReason::TooFewSteps)) = routed {
            return FollowerFindings::not_followed(why.reason_words());
        }
        let verdict = routed.as_ref().ok();
        let ends = verdict.map(|route| TextEnds { count: route.ends.len(), told_apart_by: apart(route) });
        let route = verdict.map(|route| RouteShares { annotated: route.share, other: route.other });
        let finding = routed.map_or_else(|why| unknown_route(why.reason_words()), |route| route.finding);
        let is_over_ground = matches!(self.place, FollowedPlace::JoinedGraph { .. });
        let turns = TurnJudge::JudgedElsewhere;
        FollowerFindings { findings: vec![finding], route, turn_gain: None, ends, turns, is_over_ground }
    }
}

/// A frame of a path with what is seen from it, as the follower knows a place.
fn path_place((frame, seen): (&Frame, &FrameEvidence)) -> PathPlace {
    let things = seen.things.iter().map(|thing| PathThing {
        name: thing.name.clone(),
        position: thing.position,
        direction_rad: thing.turn_rad.map(|rad| frame.pose.heading.turned_by(rad).rad()),
    });
    let (position, room) = (frame.pose.position, seen.rooms.first().cloned());
    PathPlace { position, room, level: frame.level, things: things.collect() }
}

/// A way over the ground counts as straight if it is at most this many times as long as the line, and not much longer.
const STRAIGHT_FACTOR: f64 = 1.1;
/// The ground is known to the nearest cell, metres.
const STRAIGHT_SLACK_M: f64 = 0.1;
/// Where the ground is not known, one is taken to walk straight between places that lie so near to each other, metres.
const ASSUMED_STRAIGHT_M: f64 = 1.5;
/// Places with more height between them are on different floors or stairs, metres.
const ASSUMED_LEVEL_M: f64 = 0.5;

/// Whether the way over the known ground from below one eye to below another is straight.
fn walks_straight(platform: &dyn Platform, scene: &SceneId, from: DVec3, to: DVec3) -> bool {
    let frame = |position| Frame { pose: Pose::looking_level(position, Heading::NORTH), viewpoint: None, level: None };
    let line_m = from.distance(to);
    match platform.ground().ground_route(scene, &frame(from), &frame(to)) {
        Ok(Some(way)) => way.length_m <= line_m * STRAIGHT_FACTOR + STRAIGHT_SLACK_M,
        Ok(None) | Err(_) => false,
    }
}

/// The steps that a text gives to a walker; an error, with the reason, for a text that cannot be followed.
pub(crate) fn read_guide(text: &str) -> Result<Guide, &'static str> {
    read_followable(text, None).map(|(guide, _)| guide)
}

/// As [`read_guide`], with the reading of the text as well. `tag` is the tag of its language, where its file gives one.
pub(crate) fn read_followable(text: &str, tag: Option<&str>) -> Result<(Guide, TextReading), &'static str> {
    let reading = read_instruction(text, &BTreeSet::new());
    if !is_understood(&reading, tag) {
        return Err("the program does not understand it");
    }
    let guide = Guide::from_reading(&reading);
    if guide.is_empty() { Err("the text tells no step") } else { Ok((guide, reading)) }
}

/// Whether the rules understand at least one clause of a text. A text in another language may have words that look English, so
/// its language is checked first.
fn is_understood(reading: &TextReading, tag: Option<&str>) -> bool {
    let is_foreign = matches!(reading.language.or_tagged(tag), Language::Other(_));
    let mut clauses = reading.clauses.iter().filter(|clause| clause.span[0] < clause.span[1]).peekable();
    !is_foreign && (clauses.peek().is_none() || clauses.any(|clause| clause.understood))
}

/// The reason that is given for a path without poses, which cannot be followed.
const UNKNOWN_MOTION_REASON: &str = "it is not known how its path goes";

fn unknown_route(why: &str) -> CheckFinding {
    let reason = format!("the program cannot check whether the text leads elsewhere: {why}");
    CheckFinding { check: CheckKind::Route, verdict: Verdict::Unverified, reason, span: None }
}

/// Why the texts of a run without labels are not followed: the survey of their scene would be made of labels.
pub(crate) const WITHOUT_LABELS: &str = "the texts are not checked against labels";

impl FollowerFindings {
    /// The result for a text that cannot be followed, for this reason.
    pub(crate) fn not_followed(why: &'static str) -> Self {
        let findings = vec![unknown_route(why)];
        let turns = TurnJudge::NotJudged(why);
        Self { findings, route: None, turn_gain: None, ends: None, turns, is_over_ground: false }
    }

    /// How ambiguous the text is: places where it may end, and objects that it may mean.
    pub(crate) fn text_ambiguity(&self, text: &str, evidence: &Evidence) -> TextAmbiguity {
        let unfollowed = self.findings.iter().find(|finding| finding.check == CheckKind::Route && self.ends.is_none());
        TextAmbiguity {
            ends: self.ends.as_ref().map(|ends| ends.count),
            objects: count_objects_meant(text, evidence),
            told_apart_by: self.ends.as_ref().and_then(|ends| ends.told_apart_by.clone()),
            unverified: unfollowed.map(|finding| finding.reason.clone()),
        }
    }

    /// Adds the follower's findings to those of a checked text. In a closed world the checks have judged the turns already, so
    /// only the route is added. A text that ends in a task need not tell its way, and over the ground there are many ways to a place, so
    /// there a better way says nothing against it.
    pub(crate) fn add_to(&self, checked: &mut TextFindings) {
        let ends_in_task = checked.findings.iter().any(|finding| finding.check == CheckKind::Task);
        let is_route = |finding: &&CheckFinding| finding.check == CheckKind::Route;
        let all = checked.world == CheckWorld::Open;
        let says_nothing = |finding: &&CheckFinding| {
            ends_in_task && self.is_over_ground && is_route(finding) && finding.verdict == Verdict::Fail
        };
        let added = self.findings.iter().filter(|finding| (all || is_route(finding)) && !says_nothing(finding));
        checked.add_findings(added.cloned());
    }
}

/// The failure of an ambiguous text, for `--reject-ambiguous`.
pub(crate) fn ambiguity_rejection(ambiguity: &TextAmbiguity) -> Option<CheckFinding> {
    let reason = ambiguity.to_sentence()?;
    Some(CheckFinding { check: CheckKind::Route, verdict: Verdict::Fail, reason, span: None })
}
