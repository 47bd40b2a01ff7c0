//! What a follower says of a text: turns that are wrong, whether it leads elsewhere, and how many places it may mean.

use super::worlds::KnownScene;
use serde::Serialize;
use wayword_core::{Check, Finding, Path, Verdict};
use wayword_follower::{
    Guide, Prior, Weights,
    route::{Known, Route, Thresholds, judge},
};

/// A path as the follower knows it.
pub(super) struct Followed<'a> {
    scene: &'a KnownScene,
    walk: Vec<usize>,
    heading_rad: f64,
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

/// The ends that a text may mean.
pub(super) struct Ends {
    pub(super) count: usize,
    pub(super) told_apart_by: Option<String>,
}

/// The walks that are thought of: the shortest path to each viewpoint up to this number of hops.
const PRIOR: Prior = Prior::Shortest(8);

impl<'a> Followed<'a> {
    /// A path in its scene; `None` where the path does not go along the viewpoints of a graph, or its motion is unknown.
    pub(super) fn new(scene: &'a KnownScene, path: &Path) -> Option<Self> {
        let place = |frame: &wayword_core::Frame| scene.survey.place(frame.viewpoint.as_ref()?);
        let walk: Vec<usize> = path.frames.iter().map(place).collect::<Option<_>>()?;
        let heading_rad = path.frames.first()?.pose.heading.rad();
        (path.motion.is_known() && walk.len() > 1).then_some(Self { scene, walk, heading_rad })
    }

    /// Follows a text.
    pub(super) fn follow(&self, text: &str) -> Told {
        let building = &self.scene.followed;
        let known = Known { building, walk: &self.walk, heading_rad: self.heading_rad };
        let guide = Guide::read(text);
        if guide.is_empty() {
            return Told::unknown("the text tells no step");
        }
        let judged = judge(&guide, known, Some(PRIOR), Weights::fitted(), Thresholds::default());
        let mut findings = judged.turns;
        findings.extend(judged.route.iter().map(|route| route.finding.clone()));
        let ends = judged.route.as_ref().map(|route: &Route| Ends {
            count: route.ends.len(),
            told_apart_by: route
                .ends
                .split_first()
                .filter(|(_, others)| !others.is_empty())
                .and_then(|(own, others)| building.told_apart_by(*own, others).map(str::to_owned)),
        });
        let route = judged.route.map(|route| Shares { annotated: route.share, other: route.other });
        Told { findings, route, turn_gain: judged.turn_gain, ends }
    }
}

impl Told {
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
