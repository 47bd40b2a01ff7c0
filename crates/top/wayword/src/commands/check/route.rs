//! What a follower says of a text: turns that are wrong, whether it leads elsewhere, and how many places it may mean.

use super::worlds::KnownScene;
use serde::Serialize;
use wayword_checks::{Evidence, FrameEvidence};
use wayword_core::{Check, Finding, Frame, Path, Verdict};
use wayword_follower::{
    Building, Guide, Place, Prior, Weights,
    route::{Known, Route, Thresholds, judge},
};

/// A path as the follower knows it.
pub(super) struct Followed<'a> {
    place: Surrounded<'a>,
    walk: Vec<usize>,
    heading_rad: f64,
}

/// What is known around a path.
enum Surrounded<'a> {
    /// The building with its viewpoint graph.
    By(&'a KnownScene),
    /// The path alone: no other walk is known.
    Nothing(Building),
}

/// What was found of a text.
pub(super) struct Told {
    pub(super) findings: Vec<Finding>,
    pub(super) route: Option<Shares>,
    /// What turning the most doubtful turn around would gain, natural logs.
    pub(super) turn_gain: Option<f64>,
    pub(super) ends: Option<Ends>,
}

/// How likely it is that a text means a walk, among the walks that the follower thinks of.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Shares {
    /// The annotated walk.
    pub annotated: f64,
    /// The likeliest other walk that ends elsewhere.
    pub other: f64,
}

/// What a text may mean.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Ambiguity {
    /// Places, 3 m apart or more, at which walks end that fit the text about as well as the annotated one, which counts too.
    /// `None` where no other walk is known.
    pub ends: Option<usize>,
    /// Objects at the end of the path that its task may mean; 0 where it names none that is known.
    pub objects: usize,
    /// What is only at the annotated end, where there are several.
    pub told_apart_by: Option<String>,
}

impl Ambiguity {
    /// Whether the text may mean several places, or several objects.
    pub(super) fn is_ambiguous(&self) -> bool {
        self.ends.is_some_and(|ends| ends > 1) || self.objects > 1
    }

    /// What is wrong with an ambiguous text, for a user who wants none.
    pub(super) fn rejection(&self) -> Option<Finding> {
        let ends = self.ends.unwrap_or(1);
        let reason = match (ends > 1, self.objects > 1) {
            (true, _) => format!("the text is ambiguous: it may end at {ends} places"),
            (_, true) => format!("the text is ambiguous: its task may mean {} objects", self.objects),
            _ => return None,
        };
        Some(Finding { check: Check::Route, verdict: Verdict::Fail, reason, span: None })
    }
}

/// The ends that a text may mean.
pub(super) struct Ends {
    pub(super) count: usize,
    pub(super) told_apart_by: Option<String>,
}

/// The walks that are thought of: the shortest path to each viewpoint up to this number of hops.
const PRIOR: Prior = Prior::Shortest(8);

impl<'a> Followed<'a> {
    /// A path in its scene; `None` where its motion is unknown, or it goes nowhere. A path that does not go along the viewpoints
    /// of a graph is followed by what its own frames show.
    pub(super) fn new(scene: Option<&'a KnownScene>, path: &Path, evidence: &Evidence) -> Option<Self> {
        let heading_rad = path.frames.first()?.pose.heading.rad();
        if !path.motion.is_known() || path.frames.len() < 2 {
            return None;
        }
        let on_graph = |scene: &KnownScene| {
            let place = |frame: &Frame| scene.survey.place(frame.viewpoint.as_ref()?);
            path.frames.iter().map(place).collect::<Option<Vec<usize>>>()
        };
        if let Some((scene, walk)) = scene.and_then(|scene| Some((scene, on_graph(scene)?))) {
            return Some(Self { place: Surrounded::By(scene), walk, heading_rad });
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
        Some(Self { place: Surrounded::Nothing(building), walk, heading_rad })
    }

    /// Follows a text.
    pub(super) fn follow(&self, text: &str) -> Told {
        let (building, prior) = match &self.place {
            Surrounded::By(scene) => (&scene.followed, Some(PRIOR)),
            Surrounded::Nothing(building) => (building, None),
        };
        let known = Known { building, walk: &self.walk, heading_rad: self.heading_rad };
        let guide = Guide::read(text);
        if guide.is_empty() {
            return Told::unknown("the text tells no step");
        }
        let judged = judge(&guide, known, prior, Weights::fitted(), Thresholds::default());
        let apart = |route: &Route| match route.ends.split_first() {
            Some((own, others)) if !others.is_empty() => building.told_apart_by(*own, others).map(str::to_owned),
            _ => None,
        };
        let ends = judged.route.as_ref().map(|route| Ends { count: route.ends.len(), told_apart_by: apart(route) });
        let mut told = match judged.route {
            Some(route) => Told {
                findings: vec![route.finding],
                route: Some(Shares { annotated: route.share, other: route.other }),
                turn_gain: None,
                ends,
            },
            None => Told::unknown("no viewpoint graph is known on which it lies, so no other walk is"),
        };
        told.findings.extend(judged.wrong);
        told.turn_gain = judged.turn_gain;
        told
    }
}

impl Told {
    /// What the text may mean, where its task may mean this number of objects.
    pub(super) fn ambiguity(&self, objects: usize) -> Ambiguity {
        Ambiguity {
            ends: self.ends.as_ref().map(|ends| ends.count),
            objects,
            told_apart_by: self.ends.as_ref().and_then(|ends| ends.told_apart_by.clone()),
        }
    }

    /// What is said of a text whose path cannot be followed.
    pub(super) fn unknown(why: &str) -> Self {
        let finding = Finding {
            check: Check::Route,
            verdict: Verdict::Unverified,
            reason: format!("the program cannot check whether the text leads elsewhere: {why}"),
            span: None,
        };
        Self { findings: vec![finding], route: None, turn_gain: None, ends: None }
    }
}
