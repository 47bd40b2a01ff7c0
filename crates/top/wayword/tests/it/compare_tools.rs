//! `wayword compare --agents tools`: a scripted model walks through a made-up building by calling tools.
//!
//! `WAYWORD_KILLS` sets how often a comparison is killed (default 3).

#![cfg(unix)]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stderr,
    reason = "a test fails by panicking, and prints what it counted"
)]

use crate::common::{Building, Ran, files, run};
use rand::Rng;
use serde_json::Value;
use std::{env, fs, process::Stdio, thread, time::Duration};
use wayword_core::{Heading, seeded_rng};
use wayword_formats::Episode;
use wayword_testkit::provider::{
    ProviderBehaviour, ProviderDialect, ScriptRequest, ScriptedProvider,
    scripts::{BROKEN_REPLIES, ScriptedRoute, ScriptedWalker, WalkerGait},
};

const R2R: &str = "data/r2r/R2R_val_seen.json";
const REVERIE: &str = "data/reverie/REVERIE_val_seen.json";

/// A building, and a provider with models that walk through it: `route`, `random` and `broken`.
struct Stage {
    building: Building,
    provider: ScriptedProvider,
}

impl Stage {
    fn new(latency: Duration) -> Self {
        let building = Building::new();
        let known = |gait| ScriptedWalker::new(gait, 0, routes(&building));
        let behaviour = ProviderBehaviour::for_model("route", known(WalkerGait::Route))
            .and_model("random", known(WalkerGait::Random(10)))
            .and_model("broken", known(WalkerGait::Broken))
            .and_model("names", Names(known(WalkerGait::Route)))
            .and_model("eye", |_: &ScriptRequest| "A plain room with a red door and a long grey bench.".to_owned());
        let provider = ScriptedProvider::start(ProviderBehaviour { latency, ..behaviour }).unwrap();
        Self { building, provider }
    }

    /// The flags of a comparison with a model of the provider.
    fn flags(&self, model: &str, episodes: &str, out: &str) -> Vec<String> {
        let base = self.provider.base_url(ProviderDialect::OpenAi);
        let flags = ["--agents", "tools", "--swaps", "none", "--resamples", "200", "--ledger", "ledger.db"];
        let all = ["compare", "--platform", "matterport", "--data", "data", "--episodes", episodes, "--out", out];
        let model = format!("server/{model}");
        let more = ["--llm", &model, "--base-url", &base];
        all.into_iter().chain(flags).chain(more).map(str::to_owned).collect()
    }

    fn compare(&self, model: &str, episodes: &str, out: &str, more: &[&str]) -> Ran {
        let flags = self.flags(model, episodes, out);
        let flags: Vec<&str> = flags.iter().map(String::as_str).chain(more.iter().copied()).collect();
        self.building.wayword(&flags)
    }

    fn comparison(&self, out: &str) -> Value {
        serde_json::from_str(&fs::read_to_string(self.building.path(&format!("{out}/comparison.json"))).unwrap())
            .unwrap()
    }
}

/// The route of every instruction of the building's episodes. Their goals are the last viewpoints of their paths.
fn routes(building: &Building) -> Vec<(String, ScriptedRoute)> {
    let world = wayword_platforms::matterport::MatterportPlatform::open(&building.data()).unwrap();
    let mut known = Vec::new();
    for file in [building.r2r(), building.reverie()] {
        for Episode { scene, viewpoints, start_heading, instructions, .. } in
            wayword_formats::read_any_format(&file).unwrap()
        {
            let graph = wayword_core::Platform::graph_for_scene(&world, &scene).unwrap();
            let way = graph.shortest_path(&viewpoints[0], viewpoints.last().unwrap()).unwrap().unwrap();
            let route = ScriptedRoute::along_graph(&graph, start_heading.unwrap_or(Heading::NORTH), &way.viewpoints);
            known.extend(instructions.into_iter().map(|text| (text, route.clone())));
        }
    }
    known
}

/// Walks along the route, and names the first object that it is shown at the end.
struct Names(ScriptedWalker);

impl wayword_testkit::provider::ModelScript for Names {
    fn reply(&self, heard: &ScriptRequest) -> String {
        let reply = self.0.reply(heard);
        reply.replace("stop {", "stop {\"object\": 1, ")
    }
}

fn row<'c>(comparison: &'c Value, agent: &str) -> &'c Value {
    comparison["rows"].as_array().unwrap().iter().find(|row| row["agent"] == agent).unwrap()
}

fn success(comparison: &Value, agent: &str) -> f64 {
    row(comparison, agent)["figures"]["success_rate"]["mean"].as_f64().unwrap()
}

#[test]
fn model_that_knows_the_way_always_arrives_and_the_table_has_its_cost() {
    let stage = Stage::new(Duration::ZERO);
    let ran = stage.compare("route", R2R, "walked", &[]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let found = stage.comparison("walked");
    assert_eq!((success(&found, "tools"), success(&found, "oracle")), (1.0, 1.0));
    let effort = &row(&found, "tools")["effort"];
    let mean = |figure: &str| effort[figure]["mean"].as_f64().unwrap();
    assert!(mean("calls") > mean("hops") && mean("tokens_in") > mean("tokens_out"), "{effort}");
    assert_eq!((effort["at_once"].as_u64(), effort["useless"]["no_call"].as_u64()), (Some(0), Some(0)));
    let walks = stage.building.lines("walked/walks.jsonl");
    let calls: u64 = walks
        .iter()
        .filter(|walk| walk["agent"] == "tools")
        .map(|walk| walk["effort"]["calls"].as_u64().unwrap())
        .sum();
    assert_eq!(calls, stage.provider.request_count());
    assert_eq!(found["about"]["tools"], serde_json::json!(["server/route", "labels"]));
    for told in ["what a walk took", "what went wrong", "ground truth, not perception"] {
        assert!(ran.out.contains(told), "{told}: {}", ran.out);
    }
    let page = fs::read_to_string(stage.building.path("walked/report.html")).unwrap();
    assert!(page.contains("What a walk by a language model took") && page.contains("the route leads there"));
}

#[test]
fn random_hops_are_no_better_than_the_random_baseline() {
    let stage = Stage::new(Duration::ZERO);
    let ran = stage.compare("random", R2R, "walked", &[]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let found = stage.comparison("walked");
    let floor = &row(&found, "random/10")["figures"]["success_rate"];
    let tools = &row(&found, "tools")["figures"]["success_rate"];
    let of = |figure: &Value, field: &str| figure[field].as_f64().unwrap();
    assert!(of(tools, "low") <= of(floor, "high") && of(floor, "low") <= of(tools, "high"), "{tools} {floor}");
}

#[test]
fn a_model_that_breaks_is_counted_and_its_walks_are_scored() {
    let stage = Stage::new(Duration::ZERO);
    let ran = stage.compare("broken", R2R, "walked", &[]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let walks = stage.building.lines("walked/walks.jsonl");
    let ends: std::collections::BTreeSet<&str> =
        walks.iter().filter(|walk| walk["agent"] == "tools").map(|walk| walk["end"].as_str().unwrap()).collect();
    assert!(ends.contains("no-use") && ends.len() > 1, "{ends:?} of {} ways to break", BROKEN_REPLIES.len());
    for walk in walks.iter().filter(|walk| walk["agent"] == "tools") {
        assert!(walk["effort"]["calls"].as_u64().unwrap() <= 60 && walk["steps"].as_array().unwrap().len() <= 25);
    }
    assert!(success(&stage.comparison("walked"), "tools") < 1.0);
}

#[test]
fn a_model_that_never_calls_a_tool_ends_the_comparison() {
    let building = Building::new();
    let provider =
        ScriptedProvider::start(ProviderBehaviour::for_model("talks", |_: &ScriptRequest| "Let us see.".to_owned()))
            .unwrap();
    let stage = Stage { building, provider };
    let ran = stage.compare("talks", R2R, "walked", &[]);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.err.contains("called no tool: Let us see.") && ran.err.contains("docs/AGENTS.md"), "{ran:?}");
    assert!(stage.building.lines("walked/walks.jsonl").is_empty(), "such walks are not kept");
}

/// Walks by its route where it is asked about the first instruction alone, and refuses all others.
struct Refuses(ScriptedWalker);

impl wayword_testkit::provider::ModelScript for Refuses {
    fn reply(&self, heard: &ScriptRequest) -> String {
        if heard.prompt().contains("Leave the entryway") { self.0.reply(heard) } else { String::new() }
    }
}

/// It can be tried again, so it is no walk.
#[test]
fn a_walk_without_a_single_answer_is_an_item_that_failed() {
    let building = Building::new();
    let walker = ScriptedWalker::new(WalkerGait::Route, 0, routes(&building));
    let provider = ScriptedProvider::start(ProviderBehaviour::for_model("refuses", Refuses(walker))).unwrap();
    let stage = Stage { building, provider };
    // One call at a time: if empty answers come before the first good one, the service counts as one that never answers.
    let ran = stage.compare("refuses", R2R, "walked", &["--concurrency", "1"]);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(ran.err.contains("empty answer"), "the reason is told: {ran:?}");
}

#[test]
fn it_names_an_object_for_reverie() {
    let stage = Stage::new(Duration::ZERO);
    let ran = stage.compare("names", REVERIE, "walked", &["--limit", "4"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let walks = stage.building.lines("walked/walks.jsonl");
    let named = walks.iter().filter(|walk| walk["agent"] == "tools" && !walk["object"].is_null()).count();
    assert!(named > 0);
    assert!(!row(&stage.comparison("walked"), "tools")["figures"]["rgs"].is_null());
}

/// The same walks, whether the service has tool calls or not.
#[test]
fn tool_calls_and_lines_walk_alike() {
    let stage = Stage::new(Duration::ZERO);
    assert_eq!(stage.compare("route", R2R, "lines", &["--limit", "3"]).code, Some(0));
    stage.building.write("tools.toml", "[providers.server]\ntools = true\n");
    let ran =
        stage.compare("route", R2R, "calls", &["--limit", "3", "--config", "tools.toml", "--record", "calls.jsonl"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let steps = |out: &str| {
        let walks = stage.building.lines(&format!("{out}/walks.jsonl"));
        walks.into_iter().map(|walk| walk["steps"].clone()).collect::<Vec<_>>()
    };
    assert_eq!(steps("lines"), steps("calls"));
    let kept = fs::read_to_string(stage.building.path("calls.jsonl")).unwrap();
    assert!(kept.contains("\"tools\"") && kept.contains("step {"), "the ledger keeps tool calls as lines: {kept}");
}

#[test]
fn tools_agent_gets_captions_or_pictures() {
    let stage = Stage::new(Duration::ZERO);
    wayword_testkit::write_distinct_skyboxes(&stage.building.data()).unwrap();
    let ran = stage.compare("route", R2R, "pictures", &["--limit", "1", "--see", "pictures"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.out.contains("It is shown four pictures"), "{}", ran.out);
    assert_eq!(success(&stage.comparison("pictures"), "tools"), 1.0);
    let ran =
        stage.compare("route", R2R, "captions", &["--limit", "1", "--see", "server/eye", "--record", "calls.jsonl"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.out.contains("It is told what server/eye says"), "{}", ran.out);
    assert_eq!(success(&stage.comparison("captions"), "tools"), 1.0);
    let kept = fs::read_to_string(stage.building.path("calls.jsonl")).unwrap();
    assert!(kept.contains("ahead: A place with a red door"), "the walker is told captions");
    let blind = Stage::new(Duration::ZERO);
    let ran = blind.compare("route", R2R, "pictures", &["--limit", "1", "--see", "pictures"]);
    assert!(ran.err.contains("needs") && ran.code == Some(1), "{ran:?}");
}

#[test]
fn a_dry_run_estimates_and_asks_nothing() {
    let stage = Stage::new(Duration::ZERO);
    let flags = ["--dry-run", "--instructions", "original"];
    let ran = stage.compare("route", R2R, "walked", &flags);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    assert!(ran.out.contains("server/route (walks):") && ran.out.contains("price not known"), "{}", ran.out);
    assert_eq!(stage.provider.request_count(), 0);
    assert!(!stage.building.path("walked").exists());
    let json = stage.compare("route", R2R, "walked", &["--dry-run", "--json"]).json();
    let estimated = json["models"][0]["calls"].as_u64().unwrap();
    stage.compare("route", R2R, "walked", &[]);
    let made = stage.provider.request_count();
    // The script does not look around at the start.
    assert!(estimated >= made && estimated <= made * 3 / 2, "{estimated} were estimated, {made} made");
    assert!(json["most_tokens_in"].as_u64().unwrap() > 500, "{json}");
}

#[test]
fn flags_that_do_not_fit_together_are_refused() {
    let stage = Stage::new(Duration::ZERO);
    let refused = |args: &[&str]| {
        let all = ["compare", "--platform", "matterport", "--data", "data", "--episodes", R2R, "--out", "walked"];
        stage.building.wayword(&[&all[..], args].concat()).refused().to_owned()
    };
    assert!(refused(&["--agents", "tools"]).contains("needs a language model"));
    assert!(refused(&["--llm", "server/route"]).contains("--llm has no effect"));
    assert!(refused(&["--see", "labels"]).contains("--see has no effect"));
    stage.building.write("limits.toml", "[tools]\nmax_usd = 0.1\n");
    let unpriced = stage.compare("route", R2R, "walked", &["--parameters", "limits.toml"]);
    assert!(unpriced.refused().contains("price of server/route is not known"), "{unpriced:?}");
    stage.building.write("limits.toml", "[tools]\nmax_hop = 3\n");
    let wrong = stage.compare("route", R2R, "walked", &["--parameters", "limits.toml"]);
    assert!(wrong.refused().contains("max_hop"), "{wrong:?}");
    assert_eq!(stage.provider.request_count(), 0);
}

/// Killed at seeded moments, and continued by the same command.
#[test]
fn a_comparison_that_is_killed_ends_the_same_and_pays_once() {
    let kills: usize = env::var("WAYWORD_KILLS").map_or(3, |kills| kills.parse().unwrap());
    let latency = Duration::from_millis(15);
    let (whole, killed) = (Stage::new(latency), Stage::new(latency));
    let more = ["--concurrency", "8", "--swaps", "directions,other-path", "--quiet"];
    let flags = |stage: &Stage| -> Vec<String> {
        let flags = stage.flags("random", R2R, "walked");
        let without = flags.iter().position(|flag| flag == "--swaps").unwrap();
        let kept = flags.iter().enumerate().filter(|(at, _)| *at != without && *at != without + 1);
        kept.map(|(_, flag)| flag.clone()).chain(more.map(str::to_owned)).collect()
    };
    let begin = |stage: &Stage| {
        let flags = flags(stage);
        stage.building.command(&flags.iter().map(String::as_str).collect::<Vec<_>>())
    };
    assert_eq!(run(&mut begin(&whole)).code, Some(0));
    let calls = whole.provider.log().answered;
    let mut rng = seeded_rng(19, &["kills"]);
    let mut moments: Vec<u64> = (0..kills).map(|_| rng.random_range(1..calls * 19 / 20)).collect();
    moments.sort_unstable();
    for moment in moments {
        let mut child = begin(&killed).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        while killed.provider.request_count() < moment && child.try_wait().unwrap().is_none() {
            thread::sleep(Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let last = run(&mut begin(&killed));
    assert_eq!(last.code, Some(0), "{last:?}");
    let submissions = |stage: &Stage| files(&stage.building.path("walked/submissions"));
    assert_eq!(submissions(&whole), submissions(&killed));
    let walks = |stage: &Stage| {
        let mut walks = stage.building.lines("walked/walks.jsonl");
        walks
            .iter_mut()
            .filter_map(|walk| walk["effort"].as_object_mut())
            .for_each(|effort| drop(effort.remove("seconds")));
        walks
    };
    assert_eq!(walks(&whole), walks(&killed));
    let log = killed.provider.log();
    let again = log.answered - log.distinct_answered();
    let cost = killed.building.wayword(&["ledger", "cost", "--ledger", "ledger.db", "--json"]).json();
    let lost = cost["lost"].as_u64().unwrap();
    eprintln!("{kills} kills, {calls} calls: {again} paid again, {lost} were in flight");
    assert_eq!(log.distinct_answered(), whole.provider.log().distinct_answered());
    assert!(again <= lost, "{again} calls were paid again, and {lost} were in flight");
    assert!(lost <= kills as u64 * 32, "{lost} were in flight, of 8 that are sent at a time and those that wait");
}
