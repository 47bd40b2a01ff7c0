//! Tests of replays, with walks through a small invented town.

use super::*;
use crate::pages::load_templates;
use wayword_core::{Heading, SceneId};
use wayword_metrics::TargetGrounding;
use wayword_navigation::{
    directions::SplitInstruction,
    walk::{AgentStep, StepViewScores, SurroundingsSummary},
};

const SCRIPT: &str = "<script>alert('x')</script>";

/// Six places in two rows, and the annotated path.
pub(in crate::pages) struct Town {
    graph: ViewpointGraph,
    reference: Vec<ViewpointId>,
}

fn id(name: &str) -> ViewpointId {
    ViewpointId::new(name).unwrap()
}

fn step(viewpoint: &str, deg: f64, best: Option<usize>, choice: StepChoice) -> AgentStep {
    let view = |at| StepViewScores {
        phrase: if best == Some(at) { 0.9 } else { 0.2 },
        activity: 0.1 * at as f32,
        ways: usize::from(at < 2),
    };
    AgentStep {
        viewpoint: id(viewpoint),
        heading_rad: Heading::new(deg.to_radians()).unwrap(),
        views: if best.is_some() { (0..4).map(view).collect() } else { vec![] },
        phrase: usize::from(choice == StepChoice::Stop),
        told: None,
        choice,
        reason: None,
    }
}

impl Town {
    pub(in crate::pages) fn new() -> Self {
        let mut graph = ViewpointGraph::default();
        let names = ["a", "b", "c", "d", "e", "f"];
        for (at, name) in names.into_iter().enumerate() {
            let place = DVec3::new(2.5 * (at % 3) as f64, 3.0 * (at / 3) as f64, 1.5);
            graph.add_viewpoint(id(name), place, Some(1)).unwrap();
        }
        for (one, other) in [("a", "b"), ("b", "c"), ("a", "d"), ("d", "e"), ("e", "f"), ("b", "e")] {
            graph.join_viewpoints(&id(one), &id(other)).unwrap();
        }
        Self { graph, reference: ["a", "b", "e", "f"].map(id).into() }
    }

    /// A walk that enters a dead end, goes back, and continues.
    pub(in crate::pages) fn walk(&self, agent: &str) -> AgentWalkRecord {
        AgentWalkRecord {
            agent: agent.into(),
            set: "original".into(),
            item: "7_1".into(),
            text_index: 2,
            text: "Go past the sofa to the kitchen and wipe the sink.".into(),
            scene: SceneId::new("town").unwrap(),
            directions: Some(SplitInstruction {
                phrases: vec!["go past the sofa".into()],
                activity: "wipe the sink".into(),
            }),
            steps: vec![
                step("a", 0.0, Some(1), StepChoice::Onward(1)),
                step("b", 90.0, Some(1), StepChoice::Onward(1)),
                step("c", 90.0, Some(3), StepChoice::Back),
                step("b", 270.0, None, StepChoice::Onward(0)),
                step("e", 0.0, Some(2), StepChoice::Stop),
            ],
            end: WalkEnd::Stopped,
            object: None,
            effort: None,
        }
    }

    pub(in crate::pages) fn score(&self) -> TrajectoryScore {
        let outcome = SuccessOutcome { success: false, oracle_success: true, spl: 0.0, sdtw: 0.0 };
        TrajectoryScore {
            length_m: 10.5,
            navigation_error_m: Some(2.5),
            oracle_error_m: Some(2.5),
            distance: SuccessOutcome { success: true, spl: 0.5, ..outcome },
            visible: Some(outcome),
            grounding: Some(TargetGrounding { rgs: false, rgspl: 0.0 }),
            ndtw: 0.6,
            cls: 0.5,
        }
    }
}

pub(in crate::pages) fn replay<'a>(
    town: &'a Town,
    walk: &'a AgentWalkRecord,
    score: &'a TrajectoryScore,
) -> WalkReplay<'a> {
    WalkReplay { walk, graph: &town.graph, reference: &town.reference, score, rule: TrajectorySuccessRule::Visible }
}

fn card(replay: &WalkReplay<'_>) -> String {
    let templates = load_templates().unwrap();
    let view = minijinja::Value::from_serialize(ReplayView::new(1, replay));
    templates.get_template("replay.html").unwrap().render(view).unwrap()
}

#[test]
fn a_walk_is_as_before() {
    let town = Town::new();
    let (walk, score) = (town.walk("seq-clip-nav"), town.score());
    insta::assert_snapshot!(card(&replay(&town, &walk, &score)));
}

#[test]
fn card_names_and_draws_the_way_back() {
    let town = Town::new();
    let (walk, score) = (town.walk("seq-clip-nav"), town.score());
    let card = card(&replay(&town, &walk, &score));
    assert_eq!((card.matches("class=\"retreat\"").count(), card.matches("↩ goes back").count()), (1, 1));
    assert_eq!((card.matches("class=\"hop").count(), card.matches("class=\"annotated\"").count()), (3, 1));
    assert_eq!(card.matches("class=\"view chosen\"").count(), 2);
    assert!(card.contains("at&nbsp;2"), "step 4 stands where step 2 stood");
}

#[test]
fn success_goes_by_the_rule() {
    let town = Town::new();
    let (walk, score) = (town.walk("a"), town.score());
    let by_sight = replay(&town, &walk, &score);
    let by_distance = WalkReplay { rule: TrajectorySuccessRule::Distance, ..by_sight };
    assert!(card(&by_sight).contains("✗ no success") && card(&by_distance).contains("✓ success"));
    let unknown = TrajectoryScore { visible: None, ..score };
    assert!(card(&WalkReplay { score: &unknown, ..by_sight }).contains("? not judged"));
}

#[test]
fn card_escapes_texts_from_files() {
    let town = Town::new();
    let mut walk = town.walk(SCRIPT);
    for text in [&mut walk.set, &mut walk.item, &mut walk.text] {
        *text = format!("{SCRIPT}\" onload=\"alert(1)");
    }
    walk.directions = Some(SplitInstruction { phrases: vec![SCRIPT.into()], activity: SCRIPT.into() });
    let score = town.score();
    let card = card(&replay(&town, &walk, &score));
    assert!(!card.contains("<script") && !card.contains("\" onload"));
    assert!(card.matches("&lt;script&gt;").count() > 5);
}

#[test]
fn hostile_walks_do_no_harm() {
    let town = Town::new();
    let score = town.score();
    let mut walk = town.walk("a");
    walk.steps[0].choice = StepChoice::Onward(usize::MAX);
    walk.steps[0].phrase = usize::MAX;
    walk.steps[1].views[0].phrase = f32::INFINITY;
    walk.steps[1].views[1].phrase = f32::NAN;
    let extra = walk.steps[2].views[0];
    walk.steps[2].views = vec![extra; 90];
    walk.steps[3].viewpoint = id("nowhere");
    walk.steps.extend(vec![walk.steps[4].clone(); 500]);
    let card_of = |walk: &AgentWalkRecord| card(&replay(&town, walk, &score));
    let card = card_of(&walk);
    assert!(card.contains("make no map") && card.contains("405 more steps left out"));
    walk.steps.clear();
    assert!(card_of(&walk).contains("make no map"));
}

#[test]
fn card_shows_a_walk_of_an_agent_that_does_not_read() {
    let town = Town::new();
    let score = town.score();
    let walk = AgentWalkRecord {
        text: String::new(),
        set: UNREAD_SET_NAME.into(),
        directions: None,
        steps: vec![step("a", 0.0, None, StepChoice::Unseeing), step("b", 90.0, None, StepChoice::Stop)],
        ..town.walk("random/5")
    };
    let card = card(&replay(&town, &walk, &score));
    assert!(card.contains("this agent reads nothing") && card.matches("does not look").count() == 2);
}

#[test]
fn card_shows_the_information_that_a_reader_got() {
    let town = Town::new();
    let score = town.score();
    let told = SurroundingsSummary { room: Some(SCRIPT.into()), ways: 2, things: 1 };
    let mut walk = AgentWalkRecord { directions: None, ..town.walk("reader") };
    for step in &mut walk.steps {
        step.views.clear();
        step.told = Some(told.clone());
    }
    walk.steps[4].told = Some(SurroundingsSummary { room: None, ..told });
    let shown = card(&replay(&town, &walk, &score));
    assert_eq!((shown.matches("is told: ").count(), shown.matches("↩ goes back").count()), (5, 1));
    assert!(shown.contains("2 ways on, 1 thing") && shown.contains("in a room without a name"));
    assert!(!shown.contains("<script") && !shown.contains("does not look"));
    walk.text.clear();
    assert!(card(&replay(&town, &walk, &score)).contains("(an empty text)"));
}

#[test]
fn a_models_reasons_are_shown_and_escaped() {
    let town = Town::new();
    let score = town.score();
    let effort = WalkEffort { calls: 3, tokens_in: 2_100, tokens_out: 90, usd: Some(0.0021), ..WalkEffort::default() };
    let mut walk =
        AgentWalkRecord { directions: None, effort: Some(effort), end: WalkEnd::Circles, ..town.walk("tools") };
    for step in &mut walk.steps {
        step.views.clear();
        step.told = Some(SurroundingsSummary { room: None, ways: 2, things: 0 });
        step.reason = Some(format!("it says left{SCRIPT}{}", "x".repeat(10_000)));
    }
    let card = card(&replay(&town, &walk, &score));
    assert_eq!(card.matches("it says left").count(), 5);
    assert!(!card.contains("<script") && card.len() < 40_000, "{}", card.len());
    assert!(card.contains("3 calls, 2100 tokens in, 90 out, $0.0021, 0.0 s") && card.contains("it walked in circles"));
}
