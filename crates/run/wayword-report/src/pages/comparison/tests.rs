//! Tests of every format, with a small invented comparison.

use super::*;
use crate::pages::replay::tests::{Town, replay};
use std::collections::{BTreeMap, BTreeSet};
use wayword_metrics::{McNemar, MeanEstimate, TrajectoryMetric, TrajectorySuccessRule};
use wayword_navigation::{
    comparison::{
        AgentKind, ComparisonInfo, ComparisonRow, EffortSummary, InstructionSet, ListeningVerdict, RowDifference,
        SwapEffect,
    },
    swap::InstructionSwap,
    walk::{UselessReplies, WalkEnd},
};

const SCRIPT: &str = "<script>alert('x')</script>";
/// Characters with a meaning in one of the formats.
const SPECIALS: &str = "a_b|c*d`e$f&g#h%i{j}k~l^m\\n\"o[p](q)\u{1b}[31m";

fn estimate(mean: f64, half: f64) -> MeanEstimate {
    MeanEstimate { mean, low: mean - half, high: mean + half, values: 501, clusters: 126 }
}

fn figures(sr: f64, half: f64) -> BTreeMap<TrajectoryMetric, MeanEstimate> {
    let of = [
        (TrajectoryMetric::SuccessRate, sr),
        (TrajectoryMetric::OracleSuccessRate, (2.0 * sr).min(1.0)),
        (TrajectoryMetric::Spl, 0.8 * sr),
        (TrajectoryMetric::NavigationErrorM, 9.0 * (1.0 - sr)),
        (TrajectoryMetric::Ndtw, 0.3 + 0.7 * sr),
    ];
    of.into_iter().map(|(metric, mean)| (metric, estimate(mean, half))).collect()
}

fn difference(sr: f64, half: f64) -> RowDifference {
    RowDifference { figures: figures(sr, half), mcnemar: McNemar { only_first: 12, only_second: 30, p: 0.0079 } }
}

fn row(agent: &str, kind: AgentKind, set: Option<&str>, sr: f64, less: Option<f64>) -> ComparisonRow {
    let against_first = less.map(|less| difference(less, 0.02));
    ComparisonRow {
        agent: agent.into(),
        kind,
        set: set.map(str::to_owned),
        figures: figures(sr, 0.021),
        against_first,
        effort: None,
    }
}

fn swapped(agent: &str, swap: InstructionSwap, lost: f64, listening: ListeningVerdict) -> SwapEffect {
    SwapEffect {
        agent: agent.into(),
        swap,
        changed: 1_320,
        texts: 1_504,
        figures: figures(0.05, 0.02),
        lost: difference(lost, 0.015),
        listening,
    }
}

fn set(name: &str, source: &str, left_out: usize) -> InstructionSet {
    InstructionSet { name: name.into(), source: source.into(), texts: 1_504, left_out, words: 18.25 }
}

fn comparison() -> AgentComparison {
    let agent = AgentKind::Agent;
    let parameters = BTreeMap::from([("stop_threshold".to_owned(), "0.7".to_owned())]);
    AgentComparison {
        about: ComparisonInfo {
            platform: "matterport".into(),
            episodes: "episodes_val.json".into(),
            grounder: "labels".into(),
            detector: "labels/detector".into(),
            detector_score: None,
            encoder: Some("some-encoder".into()),
            splitter: "rules".into(),
            tools: None,
            rule: TrajectorySuccessRule::Visible,
            level: 0.95,
            resamples: 10_000,
            seed: 0,
            items: 501,
            paths: 126,
            failed: 2,
            swept: true,
            prior: None,
            parameters: BTreeMap::from([("clip-nav".to_owned(), parameters)]),
            wayword: "0.0.0".into(),
        },
        sets: vec![set("original", "episodes_val.json", 0), set("central", "central#reverie", 3)],
        rows: vec![
            row("clip-nav", agent, Some("original"), 0.07, None),
            row("clip-nav", agent, Some("central"), 0.062, Some(-0.008)),
            row("glip-nav", agent, Some("original"), 0.17, None),
            row("glip-nav", agent, Some("central"), 0.12, Some(-0.05)),
            row("random/5", AgentKind::LowerBound, None, 0.012, None),
            row("nearest-room", AgentKind::Informed, None, 0.25, None),
            row("oracle", AgentKind::UpperBound, None, 0.97, None),
        ],
        swaps: vec![
            swapped("clip-nav", InstructionSwap::Directions, 0.0, ListeningVerdict::NotShown),
            swapped("clip-nav", InstructionSwap::OtherPath, 0.004, ListeningVerdict::NotShown),
            swapped("glip-nav", InstructionSwap::Directions, -0.003, ListeningVerdict::TooFew),
            swapped("glip-nav", InstructionSwap::OtherPath, 0.1, ListeningVerdict::Shown),
        ],
    }
}

/// The comparison with an agent by a language model of this name.
fn with_tools(name: &str) -> AgentComparison {
    let mut comparison = comparison();
    comparison.about.tools = Some((name.into(), "labels".into()));
    let took = |calls: f64| EffortSummary {
        walks: 1_504,
        calls: estimate(calls, 0.4),
        hops: estimate(5.2, 0.1),
        tokens_in: estimate(800.0 * calls, 120.0),
        tokens_out: estimate(60.0 * calls, 9.0),
        usd: Some(estimate(0.0123, 0.0004)),
        seconds: estimate(9.5, 0.5),
        most_tokens_in: 1_234,
        undescribed: 2,
        useless: UselessReplies { no_call: 7, no_way: 5, idle: 3, failed: 1 },
        at_once: 12,
        ended: BTreeMap::from([(WalkEnd::Stopped, 1_400), (WalkEnd::Cap, 90), (WalkEnd::Circles, 14)]),
    };
    for (set, sr, calls) in [("original", 0.4, 8.0), ("central", 0.5, 7.5)] {
        let row = row("tools", AgentKind::Agent, Some(set), sr, None);
        comparison.rows.push(ComparisonRow { effort: Some(took(calls)), ..row });
    }
    comparison
}

/// The comparison with `name` in every field that comes from files.
fn named(name: &str) -> AgentComparison {
    let mut comparison = comparison();
    let about = &mut comparison.about;
    for text in
        [&mut about.platform, &mut about.episodes, &mut about.grounder, &mut about.detector, &mut about.splitter]
    {
        *text = name.to_owned();
    }
    about.wayword = name.to_owned();
    about.tools = Some((name.to_owned(), name.to_owned()));
    about.parameters = BTreeMap::from([(name.to_owned(), BTreeMap::from([(name.to_owned(), name.to_owned())]))]);
    comparison.sets = vec![set(name, &format!("{name} "), 0)];
    for row in &mut comparison.rows {
        row.agent = name.to_owned();
        row.set = row.set.as_ref().map(|_| name.to_owned());
    }
    for swapped in &mut comparison.swaps {
        swapped.agent = name.to_owned();
    }
    comparison
}

/// Asserts that every element is closed, innermost first, and every attribute quoted.
pub(crate) fn assert_well_formed(page: &str) {
    const VOID: [&str; 3] = ["meta", "!doctype", "img"];
    let (head, rest) = page.split_once("<style>").unwrap();
    let (_, body) = rest.split_once("</style>").unwrap();
    let text = format!("{head}{body}");
    let mut open: Vec<&str> = Vec::new();
    for tag in text.split('<').skip(1) {
        let (tag, _) = tag.split_once('>').unwrap_or_else(|| panic!("no end: {tag}"));
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        let name = tag.split([' ', '/', '\n']).find(|part| !part.is_empty()).unwrap();
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "{tag} closes what is not open");
        } else if !tag.ends_with('/') && !VOID.contains(&name) {
            open.push(name);
        }
    }
    assert_eq!(open, Vec::<&str>::new());
}

fn values<'a>(page: &'a str, attribute: &str) -> Vec<&'a str> {
    let opening = format!(" {attribute}=\"");
    page.split(opening.as_str()).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

#[test]
fn the_text_is_as_before() {
    insta::assert_snapshot!("markdown", markdown_tables(&comparison()));
    insta::assert_snapshot!("latex", latex_table(&comparison()));
    insta::assert_snapshot!("screen", screen_text(&comparison()));
}

#[test]
fn every_form_has_the_notes() {
    let comparison = comparison();
    for text in [
        markdown_tables(&comparison),
        latex_table(&comparison),
        screen_text(&comparison),
        comparison_html(&comparison).unwrap(),
    ] {
        for told in [
            "the target is visible where the agent stops",
            "501 items on 126 paths",
            "clustered by path",
            "mean over its texts",
            "ground-truth labels, not perception",
            "--detector names a network",
            "not shown to do worse with another path",
            "its rows say nothing about the instructions",
            "encoded by some-encoder",
            "2 items could not be walked",
        ] {
            assert!(text.contains(told), "{told} is not in {text}");
        }
    }
    for text in [markdown_tables(&comparison), screen_text(&comparison), comparison_html(&comparison).unwrap()] {
        assert!(text.contains("1504 texts") && text.contains("descriptive"), "{text}");
    }
}

#[test]
fn an_agent_that_follows_has_no_warning_and_one_that_was_not_tested_has_its_own() {
    let mut comparison = comparison();
    let warnings = notes::list_warnings(&comparison);
    assert!(warnings.len() == 1 && warnings[0].starts_with("† clip-nav is not shown to do worse"), "{warnings:?}");
    assert!(notes::listener_notes(&comparison)[0].starts_with("glip-nav follows its instructions"));
    comparison.swaps[1].listening = ListeningVerdict::TooFew;
    let warnings = notes::list_warnings(&comparison);
    assert!(warnings.len() == 1 && warnings[0].starts_with("clip-nav: the swap test"), "{warnings:?}");
    comparison.swaps.clear();
    let warnings = notes::list_warnings(&comparison);
    assert!(warnings.len() == 1 && warnings[0].starts_with("clip-nav, glip-nav: the swap test"), "{warnings:?}");
}

/// Ground truth is not mistaken for perception, nor the knowledge of the map for understanding of the text.
#[test]
fn notes_name_the_labels_and_rooms_that_readers_get() {
    let mut comparison = comparison();
    comparison.about.prior = Some("shortest:1-8".into());
    comparison.about.parameters.clear();
    comparison.rows = vec![
        row("reader", AgentKind::Agent, Some("original"), 0.5, None),
        row("reader-map", AgentKind::Informed, Some("original"), 0.7, None),
        row("reader-map", AgentKind::Informed, Some("original~empty"), 0.1, None),
        row("reader-map", AgentKind::Informed, Some("original~other-path"), 0.12, None),
    ];
    comparison.swaps = vec![swapped("reader-map", InstructionSwap::Directions, 0.2, ListeningVerdict::Shown)];
    for text in [
        markdown_tables(&comparison),
        latex_table(&comparison),
        screen_text(&comparison),
        comparison_html(&comparison).unwrap(),
    ] {
        for told in
            ["reader is told at each viewpoint", "ground truth, not perception", "1-8 hops away", "an empty text"]
        {
            assert!(text.contains(told), "{told} is not in {text}");
        }
        assert!(text.contains("knows the map") && text.contains("another path"), "{text}");
        assert!(!text.contains("split into phrases") && !text.contains("REVERIE's train split"), "{text}");
    }
    comparison.about.prior = Some("none".into());
    comparison.about.grounder = "hf/some/clip".into();
    let text = screen_text(&comparison);
    assert!(
        text.contains("walks of two shortest pieces") && text.contains("score high enough by hf/some/clip"),
        "{text}"
    );
}

#[test]
fn another_rule_is_named() {
    let mut comparison = comparison();
    comparison.about.rule = TrajectorySuccessRule::Distance;
    assert!(screen_text(&comparison).contains("less than 3 m from the goal"));
    assert!(!screen_text(&comparison).contains("target is visible"));
}

#[test]
fn names_stay_text_in_markdown_and_latex_and_on_the_screen() {
    let [script, special] = [named(SCRIPT), named(SPECIALS)];
    assert!(!markdown_tables(&script).contains("<script") && markdown_tables(&script).contains("&lt;script"));
    assert!(markdown_tables(&special).contains("a\\_b\\|c\\*d\\`e\\$f&amp;g"));
    let expected =
        "a\\_b\\textbar{}c*d`e\\$f\\&g\\#h\\%i\\{j\\}k\\textasciitilde{}l\\textasciicircum{}m\\textbackslash{}n";
    assert!(latex_table(&special).contains(expected), "{}", latex_table(&special));
    assert!(!latex_table(&special).contains("a_b") && !latex_table(&special).contains("\n["));
    for text in
        [screen_text(&special), markdown_tables(&special), latex_table(&special), comparison_html(&special).unwrap()]
    {
        assert!(!text.contains('\u{1b}'));
    }
}

#[test]
fn names_stay_text_on_the_page() {
    let page = comparison_html(&named(&format!("{SCRIPT}\" onload=\"alert(1)"))).unwrap();
    assert!(!page.contains("<script") && !page.contains("\" onload") && page.contains("default-src 'none'"));
    assert!(page.matches("&lt;script&gt;").count() > 20);
    assert_well_formed(&page);
}

#[test]
fn page_is_well_formed_and_loads_no_files() {
    let town = Town::new();
    let walks = [town.walk("a"), town.walk("b")];
    let score = town.score();
    let replays: Vec<_> = walks.iter().map(|walk| replay(&town, walk, &score)).collect();
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("report.html");
    let written = write_comparison(&out, &comparison(), &replays, 5).unwrap();
    assert_eq!((written.replays, written.left_out), (2, 5));
    let page = std::fs::read_to_string(&out).unwrap();
    assert_well_formed(&page);
    assert!(page.contains("shows 2 of 7 walks"));
    let places: BTreeSet<&str> = values(&page, "id").into_iter().collect();
    assert_eq!(places.len(), values(&page, "id").len(), "two places of one name");
    for link in values(&page, "href") {
        assert!(link.strip_prefix('#').is_some_and(|place| places.contains(place)), "{link} leads nowhere");
    }
    assert!(!page.contains("http:") && !page.contains("https:") && !page.contains("url(") && !page.contains("@import"));
    assert_eq!(page.matches("<article ").count(), 2);
}

#[test]
fn plots_show_agents_lines_and_what_lies_beyond() {
    let page = comparison_html(&comparison()).unwrap();
    assert_eq!(page.matches("<section class=\"panel forest\">").count(), 3);
    assert!(page.contains("class=\"line lower-bound\"") && page.contains("Beyond the axis: <bdi>oracle 97.0</bdi>"));
    // The interval of one difference and of one swap excludes zero.
    assert_eq!(page.matches("class=\"dot\"").count(), 4 + 1 + 1);
    assert_eq!(page.matches("class=\"dot hollow\"").count(), 1 + 3);
}

#[test]
fn every_format_accepts_a_comparison_without_walks() {
    let mut comparison = comparison();
    comparison.rows.clear();
    comparison.swaps.clear();
    comparison.sets.clear();
    for text in [
        markdown_tables(&comparison),
        latex_table(&comparison),
        screen_text(&comparison),
        comparison_html(&comparison).unwrap(),
    ] {
        assert!(text.contains("501 items"));
    }
}

#[test]
fn wild_numbers_stay_on_the_page() {
    let mut comparison = comparison();
    for row in &mut comparison.rows {
        for estimate in row.figures.values_mut() {
            (estimate.low, estimate.high) = (f64::MIN, f64::MAX);
        }
    }
    assert_well_formed(&comparison_html(&comparison).unwrap());
    assert!(screen_text(&comparison).lines().all(|line| line.len() < 400));
}

#[test]
fn every_format_shows_effort_and_problems_of_walks_by_a_language_model() {
    let comparison = with_tools("some/model");
    let shown = screen_text(&comparison);
    let (_, took) = shown.split_once("what a walk took").unwrap();
    insta::assert_snapshot!("took", took.split("original (").next().unwrap());
    let page = comparison_html(&comparison).unwrap();
    assert_well_formed(&page);
    for told in [&page, &markdown_tables(&comparison)] {
        assert!(told.contains("What a walk by a language model took") && told.contains("6400.0"), "{told}");
        assert!(told.contains("ended by a limit") && told.contains("104"), "{told}");
    }
    assert!(!markdown_tables(&super::tests::comparison()).contains("language model"));
}

#[test]
fn sets_whose_target_no_agent_walks_past_are_named() {
    let told = |comparison: &AgentComparison| {
        super::notes::all_notes(comparison).into_iter().find(|note| note.starts_with("OSR equals SR for "))
    };
    let mut found = comparison();
    assert_eq!(told(&found), None);
    for row in found.rows.iter_mut().filter(|row| row.set.as_deref() == Some("central")) {
        let success = row.figures[&TrajectoryMetric::SuccessRate];
        row.figures.insert(TrajectoryMetric::OracleSuccessRate, success);
    }
    assert!(told(&found).is_some_and(|note| note.starts_with("OSR equals SR for central: ")));
    found.about.grounder = "hf/openai/clip-vit-base-patch32".into();
    assert_eq!(told(&found), None);
}
