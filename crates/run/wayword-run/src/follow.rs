//! Follows a text through a building with the rules of `wayword-follower`. Finds turns that are wrong, whether the text leads to
//! another place than its path, and how many places it may mean.

use crate::{error::Error, platforms::SCENES_KEPT};
use serde::Serialize;
use std::{
    collections::BTreeSet,
    sync::{Arc, LazyLock},
};
use wayword_checks::{Checked, Evidence, FrameEvidence, Turns, World, objects_meant};
use wayword_core::{Ambiguity, Check, Finding, Frame, Path, Platform, Recent, SceneId, Survey, Verdict};
use wayword_follower::{
    Building, Guide, Place, Prior, Weights,
    route::{Known, Route, Thresholds, Unfollowed, judge, leads_there, route},
};
use wayword_language::{
    Language,
    reading::{Reading, read},
};
use wayword_synthesis::offline::Listing;
use wayword_world::survey;

/// A scene that was surveyed.
pub(crate) struct KnownScene {
    /// Its viewpoints.
    pub(crate) survey: Survey,
    /// Its listed objects, for the checks.
    pub(crate) listed: Arc<wayword_checks::Building>,
    /// The same list, for the description of a target.
    pub(crate) listing: Listing,
    /// The same building, for the follower.
    pub(crate) followed: Building,
}

/// A cache of the scenes that were surveyed last.
pub struct KnownScenes(Recent<SceneId, KnownScene>);

impl KnownScenes {
    /// None yet.
    #[must_use]
    pub fn new() -> Self {
        Self(Recent::new(SCENES_KEPT))
    }

    /// A scene, surveyed if it is not known. It has no viewpoints where the platform has no graph.
    pub(crate) fn get(&self, platform: &dyn Platform, scene: &SceneId) -> Result<Arc<KnownScene>, Error> {
        self.0.get_or_make(scene.clone(), || {
            let survey = survey(platform, scene)?;
            let listed = Arc::new(wayword_checks::Building::of(&survey));
            let followed = Building::of(&survey);
            let listing = Listing::of(&survey);
            Ok(KnownScene { survey, listed, listing, followed })
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
static CHOOSES: LazyLock<Weights> = LazyLock::new(Weights::by_hand);

/// A path as the follower knows it.
pub(crate) struct Followed<'a> {
    place: Surrounded<'a>,
    walk: Vec<usize>,
    heading_rad: f64,
}

/// The surroundings of a path, as far as they are known.
enum Surrounded<'a> {
    /// The building with its viewpoint graph.
    By(&'a KnownScene),
    /// The path alone: there is no graph, so no other walk is known.
    Nothing(Building),
}

/// The result of following a text.
pub(crate) struct Told {
    pub(crate) findings: Vec<Finding>,
    pub(crate) route: Option<Shares>,
    /// How much the text would fit better with its most doubtful turn reversed: a difference of natural logs of likelihood.
    pub(crate) turn_gain: Option<f64>,
    pub(crate) ends: Option<Ends>,
    /// Whether its turns were judged.
    pub(crate) turns: Turns,
}

/// How likely it is that a text means a walk, among the walks that the follower thinks of.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Shares {
    /// The annotated walk.
    pub annotated: f64,
    /// The likeliest other walk that ends elsewhere.
    pub other: f64,
}

/// The ends that a text may mean.
pub(crate) struct Ends {
    pub(crate) count: usize,
    pub(crate) told_apart_by: Option<String>,
}

impl<'a> Followed<'a> {
    /// A path in its scene. If the path does not go along the viewpoints of a graph, the building consists of its own frames and
    /// what they show.
    ///
    /// # Errors
    /// With the reason, where its motion is unknown, or it goes nowhere.
    pub(crate) fn new(scene: Option<&'a KnownScene>, path: &Path, evidence: &Evidence) -> Result<Self, &'static str> {
        if !path.motion.is_known() {
            return Err(GOES_UNKNOWN);
        }
        let [first, _, ..] = &path.frames[..] else { return Err("its path is one place, so it goes nowhere") };
        let heading_rad = first.pose.heading.rad();
        let on_graph = |scene: &KnownScene| {
            let place = |frame: &Frame| scene.survey.place(frame.viewpoint.as_ref()?);
            path.frames.iter().map(place).collect::<Option<Vec<usize>>>()
        };
        if let Some((scene, walk)) = scene.and_then(|scene| Some((scene, on_graph(scene)?))) {
            return Ok(Self { place: Surrounded::By(scene), walk, heading_rad });
        }
        let place = |(frame, seen): (&Frame, &FrameEvidence)| Place {
            position: frame.pose.position,
            room: seen.rooms.first().cloned(),
            things: seen
                .things
                .iter()
                .map(|thing| (thing.name.clone(), thing.turn_rad.map(|rad| frame.pose.heading.turned(rad).rad())))
                .collect(),
        };
        let building = Building::along(path.frames.iter().zip(&evidence.frames).map(place).collect());
        let walk = (0..path.frames.len()).collect();
        Ok(Self { place: Surrounded::Nothing(building), walk, heading_rad })
    }

    /// Follows a text, and judges its steps. `tag` is that of its language, where its file gives one.
    pub(crate) fn follow(&self, text: &str, tag: Option<&str>) -> Told {
        let guide = match guide(text, tag) {
            Ok(guide) => guide,
            Err(why) => return Told::unknown(why),
        };
        let mut told = self.routed(&guide);
        if told.turns == Turns::JudgedElsewhere {
            let judged = judge(&guide, self.known(), Weights::fitted(), Thresholds::default());
            told.findings.extend(judged.wrong);
            told.turn_gain = judged.turn_gain;
        }
        told
    }

    /// Only judges where a text leads, without its single turns.
    pub(crate) fn route(&self, text: &str) -> Told {
        guide(text, None).map_or_else(Told::unknown, |guide| self.routed(&guide))
    }

    /// How likely a text leads to the end of the path, for the choice between texts; `None` where it cannot be followed.
    pub(crate) fn leads_there(&self, text: &str) -> Option<f64> {
        let guide = guide(text, None).ok()?;
        leads_there(&guide, self.known(), self.prior(), &CHOOSES).ok()
    }

    /// The prior over other walks; `None` if the path alone is known.
    fn prior(&self) -> Option<Prior> {
        matches!(self.place, Surrounded::By(_)).then(Prior::default)
    }

    pub(crate) fn known(&self) -> Known<'_> {
        let building = match &self.place {
            Surrounded::By(scene) => &scene.followed,
            Surrounded::Nothing(building) => building,
        };
        Known { building, walk: &self.walk, heading_rad: self.heading_rad }
    }

    fn routed(&self, guide: &Guide) -> Told {
        let known = self.known();
        let routed = route(guide, known, self.prior(), Weights::fitted(), Thresholds::default());
        let apart = |route: &Route| match route.ends.split_first() {
            Some((own, others)) if !others.is_empty() => known.building.told_apart_by(*own, others).map(str::to_owned),
            _ => None,
        };
        if let Err(why @ (Unfollowed::TooManySteps | Unfollowed::TooFewSteps)) = routed {
            return Told::unknown(why.why());
        }
        let seen = routed.as_ref().ok();
        let ends = seen.map(|route| Ends { count: route.ends.len(), told_apart_by: apart(route) });
        let route = seen.map(|route| Shares { annotated: route.share, other: route.other });
        let finding = routed.map_or_else(|why| unknown_route(why.why()), |route| route.finding);
        Told { findings: vec![finding], route, turn_gain: None, ends, turns: Turns::JudgedElsewhere }
    }
}

/// The steps that a text gives to a walker; an error, with the reason, for a text that cannot be followed.
pub(crate) fn guide(text: &str, tag: Option<&str>) -> Result<Guide, &'static str> {
    followable(text, tag).map(|(guide, _)| guide)
}

/// As [`guide`], with the reading of the text as well.
pub(crate) fn followable(text: &str, tag: Option<&str>) -> Result<(Guide, Reading), &'static str> {
    let reading = read(text, &BTreeSet::new());
    if !is_understood(&reading, tag) {
        return Err("the program does not understand it");
    }
    let guide = Guide::of(text, &reading);
    if guide.is_empty() { Err("the text tells no step") } else { Ok((guide, reading)) }
}

/// Whether the rules understand at least one clause of a text. A text in another language may have words that look English, so
/// its language is checked first.
fn is_understood(reading: &Reading, tag: Option<&str>) -> bool {
    let is_foreign = matches!(reading.language.or_tagged(tag), Language::Other(_));
    let mut clauses = reading.clauses.iter().filter(|clause| clause.span[0] < clause.span[1]).peekable();
    !is_foreign && (clauses.peek().is_none() || clauses.any(|clause| clause.understood))
}

/// The reason that is given for a path without poses, which cannot be followed.
pub(crate) const GOES_UNKNOWN: &str = "it is not known how its path goes";

fn unknown_route(why: &str) -> Finding {
    let reason = format!("the program cannot check whether the text leads elsewhere: {why}");
    Finding { check: Check::Route, verdict: Verdict::Unverified, reason, span: None }
}

impl Told {
    /// The result for a text that cannot be followed, for this reason.
    pub(crate) fn unknown(why: &'static str) -> Self {
        let findings = vec![unknown_route(why)];
        Self { findings, route: None, turn_gain: None, ends: None, turns: Turns::NotJudged(why) }
    }

    /// How ambiguous the text is: places where it may end, and objects that it may mean.
    pub(crate) fn ambiguity(&self, text: &str, evidence: &Evidence) -> Ambiguity {
        let unfollowed = self.findings.iter().find(|finding| finding.check == Check::Route && self.ends.is_none());
        Ambiguity {
            ends: self.ends.as_ref().map(|ends| ends.count),
            objects: objects_meant(text, evidence),
            told_apart_by: self.ends.as_ref().and_then(|ends| ends.told_apart_by.clone()),
            unverified: unfollowed.map(|finding| finding.reason.clone()),
        }
    }

    /// Adds the follower's findings to those of a checked text. In a closed world the checks have judged the turns already, so
    /// only the route is added.
    pub(crate) fn add_to(&self, checked: &mut Checked) {
        let is_route = |finding: &&Finding| finding.check == Check::Route;
        let all = checked.world == World::Open;
        checked.add(self.findings.iter().filter(|finding| all || is_route(finding)).cloned());
    }
}

/// The failure of an ambiguous text, for `--reject-ambiguous`.
pub(crate) fn rejection(ambiguity: &Ambiguity) -> Option<Finding> {
    let reason = ambiguity.told()?;
    Some(Finding { check: Check::Route, verdict: Verdict::Fail, reason, span: None })
}
