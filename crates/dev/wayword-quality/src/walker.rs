//! Runs `wayword compare` with an agent that uses a scripted language model. The model walks the shortest way, at random, or it breaks, so
//! the right figures are known beforehand and the tools, the bounds and the table can be verified.

use crate::checked_texts::{text_item, write_items};
use std::{collections::BTreeMap, str::FromStr};
use wayword_core::Heading;
use wayword_experiments::{
    compare::{args::CompareArgs, run_comparison},
    episodes,
};
use wayword_run::{error::CommandError, output::CommandOutput, platforms, settings::AskedSettings};
use wayword_testkit::provider::{
    ProviderBehaviour, ProviderDialect, ScriptedProvider,
    scripts::{ScriptedRoute, ScriptedWalker, WalkerGait},
};

/// The flags of `wayword compare`, and how the model walks.
#[derive(Debug, clap::Args)]
pub struct ScriptedWalkerArgs {
    /// How the model walks: route (the shortest way to the goal), random/N (N random hops), broken (in one of ten ways, by the
    /// item).
    #[arg(long, default_value = "route")]
    gait: GaitArg,
    #[command(flatten)]
    compare: CompareArgs,
}

/// How the model walks, as typed.
#[derive(Debug, Clone, Copy)]
struct GaitArg(WalkerGait);

impl FromStr for GaitArg {
    type Err = String;

    fn from_str(typed: &str) -> Result<Self, String> {
        match typed.strip_prefix("random/").map(str::parse) {
            Some(Ok(hops)) => Ok(Self(WalkerGait::Random(hops))),
            None if typed == "route" => Ok(Self(WalkerGait::Route)),
            None if typed == "broken" => Ok(Self(WalkerGait::Broken)),
            _ => Err("give route, random/10 or broken".to_owned()),
        }
    }
}

/// Walks every item of the episodes by one instruction that only names the item. The scripted model knows the routes by these texts.
///
/// # Errors
/// When the episodes or the platform cannot be read, the provider cannot be started, and as `wayword compare`.
pub fn measure_walker(
    ScriptedWalkerArgs { gait: GaitArg(gait), mut compare }: ScriptedWalkerArgs,
    output: &CommandOutput,
) -> Result<(), CommandError> {
    let io = |source| CommandError::Io { path: std::env::temp_dir(), doing: "set the measurement up in", source };
    let platform = platforms::open_platform(&AskedSettings::from(compare.platform.clone()).resolve()?)?;
    let mut known = BTreeMap::new();
    let mut items = Vec::new();
    for (number, episode) in episodes::read_episodes(&compare.episodes, platform.as_ref())?.iter().enumerate() {
        let graph = platform.graph_for_scene(&episode.scene)?;
        let ends = episode.viewpoints.first().zip(episode.viewpoints.last());
        let route = ends.and_then(|(start, goal)| graph.shortest_path(start, goal).ok().flatten());
        let text = format!("Walk to the goal of item {number}.");
        let viewpoints = route.map_or_else(Vec::new, |route| route.viewpoints);
        known.insert(
            text.clone(),
            ScriptedRoute::along_graph(&graph, episode.start_heading.unwrap_or(Heading::NORTH), &viewpoints),
        );
        items.push(text_item(number, episode, &text));
    }
    let folder = tempfile::tempdir().map_err(io)?;
    compare.episodes = folder.path().join("items.json");
    write_items(&compare.episodes, &items)?;
    let provider =
        ScriptedProvider::start(ProviderBehaviour::for_model("walker", ScriptedWalker::new(gait, compare.seed, known)))
            .map_err(io)?;
    compare.llm = Some("server/walker".to_owned());
    compare.base_url = Some(provider.base_url(ProviderDialect::OpenAi));
    run_comparison(&compare, output).map(drop)
}
