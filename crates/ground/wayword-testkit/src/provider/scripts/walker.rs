//! A scripted language model for the agent that walks by tools: it follows a known route, walks at random, or misbehaves.
//!
//! It parses the prompts of `wayword-navigation`, which contain the agent's place on the map and the ways out of it.

use super::{ModelScript, ScriptRequest, rng_for_text};
use rand::Rng;
use std::{collections::BTreeMap, fmt::Write};
use wayword_core::{DVec3, Heading, ViewpointGraph, ViewpointId};

/// How the model walks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WalkerGait {
    /// Along the route of its instruction.
    Route,
    /// This many hops, each through a random way, all equally likely.
    Random(usize),
    /// Not at all: it always gives one of the replies of [`BROKEN_REPLIES`], chosen by the instruction.
    Broken,
}

/// Largest error of a place on the map of a prompt, metres: the map rounds each of three axes to 0.1 m, so
/// a place is off by less than this.
const ROUNDED_M: f64 = 0.2;

/// A scripted model that chooses an agent's steps.
#[derive(Debug, Clone)]
pub struct ScriptedWalker {
    gait: WalkerGait,
    seed: u64,
    /// The route of each instruction, by its text.
    routes: BTreeMap<String, ScriptedRoute>,
}

/// The places of a route relative to its start, metres: to the right, ahead and up of the walker as it looks at the start.
#[derive(Debug, Clone, PartialEq)]
pub struct ScriptedRoute(Vec<DVec3>);

/// Replies of a broken model; one of them is repeated at each call.
pub const BROKEN_REPLIES: [&str; 10] = [
    "I would go to the left here.",
    "fly {\"way\": 1, \"why\": \"it is quicker\"}",
    "step {\"way\": ",
    "step {\"way\": 99, \"why\": \"I like the number\"}",
    "step {\"why\": \"any way will do\"}",
    "observe {\"why\": \"to be sure\"}",
    "stop {\"why\": \"I am there\"}",
    "step {\"way\": 1, \"why\": \"always the first\"}",
    "<script>alert(1)</script> step {\"way\": \"first\"}",
    "{\"tool\": \"step\", \"way\": -1}",
];

impl ScriptedRoute {
    /// The route over some viewpoints of a graph, for a walker that starts along a heading. Viewpoints that the graph does not
    /// have are left out.
    #[must_use]
    pub fn along_graph(graph: &ViewpointGraph, heading: Heading, viewpoints: &[ViewpointId]) -> Self {
        let places: Vec<DVec3> = viewpoints.iter().filter_map(|viewpoint| graph.position_of(viewpoint)).collect();
        let (ahead, right) = (heading.unit_vector(), heading.turned_by(std::f64::consts::FRAC_PI_2).unit_vector());
        let from = places.first().copied().unwrap_or_default();
        let relative_to_start = |place: &DVec3| {
            let off = *place - from;
            DVec3::new(off.dot(right), off.dot(ahead), off.z)
        };
        Self(places.iter().map(relative_to_start).collect())
    }
}

impl ScriptedWalker {
    /// A model that knows the routes of some instructions.
    #[must_use]
    pub fn new(gait: WalkerGait, seed: u64, routes: impl IntoIterator<Item = (String, ScriptedRoute)>) -> Self {
        Self { gait, seed, routes: routes.into_iter().collect() }
    }

    /// Takes the way that ends nearest to the next place of the route. The walker's progress along the route is the number of its
    /// hops, as long as that place matches its position; positions alone are ambiguous, because the map is rounded and places
    /// can lie close together.
    fn reply_along_route(&self, state: &WalkPrompt<'_>) -> String {
        let Some(ScriptedRoute(route)) = self.routes.get(state.text) else {
            return "I do not know this one.".to_owned();
        };
        let is_at = |place: &usize| route.get(*place).is_some_and(|place| place.distance(state.here) < ROUNDED_M);
        let place_by_position =
            || (0..route.len()).rev().find(is_at).unwrap_or_else(|| nearest_place(route, state.here));
        let here = Some(state.hops).filter(is_at).unwrap_or_else(place_by_position);
        let Some(next) = route.get(here + 1) else { return format_call("stop", None, "the route ends here") };
        let way = nearest_place(&state.way_ends(), *next) + 1;
        format!(
            "{}\n{}",
            format_call("step", Some(way), "the route leads there"),
            format_call("observe", None, "to see it")
        )
    }

    /// Takes a random way, until `hops` hops were made.
    fn reply_at_random(&self, state: &WalkPrompt<'_>, prompt: &str, hops: usize) -> String {
        if state.hops >= hops || state.ways.is_empty() {
            return format_call("stop", None, "enough");
        }
        let way = rng_for_text(self.seed, prompt).random_range(1..=state.ways.len());
        format_call("step", Some(way), "why not")
    }
}

/// A call of a tool as a script writes it, as `step {"way": 1, "why": "..."}`.
fn format_call(tool: &str, way: Option<usize>, why: &str) -> String {
    let mut line = format!("{tool} {{");
    if let Some(way) = way {
        // Writing to a text cannot fail.
        let _ = write!(line, "\"way\": {way}, ");
    }
    line + &format!("\"why\": \"{why}\"}}")
}

/// The place nearest to another, by its number from 0.
fn nearest_place(places: &[DVec3], to: DVec3) -> usize {
    let distance = |at: &usize| places[*at].distance(to);
    (0..places.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or_default()
}

impl ModelScript for ScriptedWalker {
    fn reply(&self, request: &ScriptRequest) -> String {
        let prompt = request.prompt();
        let Some(state) = WalkPrompt::from_prompt(prompt) else { return "I was asked something else.".to_owned() };
        match self.gait {
            WalkerGait::Route => self.reply_along_route(&state),
            WalkerGait::Random(hops) => self.reply_at_random(&state, prompt, hops),
            WalkerGait::Broken => {
                let kind = rng_for_text(self.seed, state.text).random_range(0..BROKEN_REPLIES.len());
                BROKEN_REPLIES[kind].to_owned()
            }
        }
    }
}

/// The state of the walk, as parsed from a prompt.
struct WalkPrompt<'a> {
    /// The instruction.
    text: &'a str,
    /// The walker's place on the map of the prompt, metres: to the right, ahead and up of the start.
    here: DVec3,
    /// The direction in which the walker looks, radians to the right of how it looked at the start.
    heading_rad: f64,
    /// Hops so far, according to the prompt.
    hops: usize,
    /// Turn (radians, positive right), length and climb (metres) of each way out.
    ways: Vec<(f64, f64, f64)>,
}

impl<'a> WalkPrompt<'a> {
    /// Parses a prompt; `None` if it is not one for a step of a walk.
    fn from_prompt(prompt: &'a str) -> Option<Self> {
        let text = prompt.split("<instruction>\n").nth(1)?.split("\n</instruction>").next()?;
        let places: BTreeMap<usize, DVec3> = prompt.lines().filter_map(parse_place).collect();
        let here = number_after(prompt, "You stand at place ")? as usize;
        let last = prompt.lines().filter_map(parse_step).next_back();
        let deg = number_after(prompt, ", and look ").unwrap_or(0.0);
        let is_left = prompt.contains("degrees to the left of how you looked");
        let heading_rad = if is_left { -deg.to_radians() } else { deg.to_radians() };
        let ways = prompt.split("Ways out:\n").nth(1)?.lines().map_while(parse_way).collect();
        Some(Self { text, here: *places.get(&here)?, heading_rad, hops: last.map_or(0, |(number, ..)| number), ways })
    }

    /// Where each way ends.
    fn way_ends(&self) -> Vec<DVec3> {
        let end = |(turn_rad, length_m, climb_m): &(f64, f64, f64)| {
            let flat_m = (length_m * length_m - climb_m * climb_m).max(0.0).sqrt();
            let direction = self.heading_rad + turn_rad;
            self.here + DVec3::new(flat_m * libm::sin(direction), flat_m * libm::cos(direction), *climb_m)
        };
        self.ways.iter().map(end).collect()
    }
}

/// The number that follows some words in a text.
fn number_after(text: &str, words: &str) -> Option<f64> {
    let rest = &text[text.find(words)? + words.len()..];
    let end = rest.find(|c: char| !c.is_ascii_digit() && c != '.' && c != '-').unwrap_or(rest.len());
    rest[..end].trim_end_matches('.').parse().ok()
}

/// A place of the map, as in "place 2: right 1.0, ahead 2.0, up 0.0; hallway; ways to 1".
fn parse_place(line: &str) -> Option<(usize, DVec3)> {
    if !line.starts_with("place ") {
        return None;
    }
    let number = number_after(line, "place ")? as usize;
    Some((
        number,
        DVec3::new(number_after(line, ": right ")?, number_after(line, ", ahead ")?, number_after(line, ", up ")?),
    ))
}

/// A step, as in "3. from place 1 to place 2: it leads there".
fn parse_step(line: &str) -> Option<(usize, usize, usize)> {
    let number: usize = line.split_once(". from place ")?.0.parse().ok()?;
    Some((number, number_after(line, ". from place ")? as usize, number_after(line, " to place ")? as usize))
}

/// A way out, as in "1: left, 88 degrees left, 1.9 m, up 0.6 m; new".
fn parse_way(line: &str) -> Option<(f64, f64, f64)> {
    let (_, description) = line.split_once(": ").filter(|(number, _)| number.parse::<usize>().is_ok())?;
    let description = description.split(';').next()?;
    let (mut turn, mut length, mut climb) = (0.0, 0.0, 0.0);
    for part in description.split(", ").map(str::trim) {
        let number = |part: &str| part.split(' ').find_map(|word| word.parse::<f64>().ok());
        match part {
            part if part.ends_with("degrees right") => turn = number(part)?.to_radians(),
            part if part.ends_with("degrees left") => turn = -number(part)?.to_radians(),
            part if part.starts_with("up ") => climb = number(part)?,
            part if part.starts_with("down ") => climb = -number(part)?,
            part if part.ends_with(" m") => length = number(part)?,
            _ => {}
        }
    }
    Some((turn, length, climb))
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::MessageRole;

    const PROMPT: &str = "<instruction>\nGo to the sink.\n</instruction>\n\nWhere you have been:\n\
        place 1: right 0.0, ahead 0.0, up 0.0; hallway; ways to 2, new (0.0, 2.0)\n\
        place 2: right 2.0, ahead 0.0, up 0.0; you did not look around; ways to 1, new (2.0, 2.0)\n\n\
        Your last steps:\n1. from place 1 to place 2: because\n\nYou stand at place 2, and look 90 degrees to the right of how you looked at the start. You can make 23 more steps.\n\
        Ways out:\n1: behind, 180 degrees right, 2.0 m; to place 1\n2: left, 90 degrees left, 2.2 m, up 1.0 m; new (2.0, 2.0)\n";

    fn reply(gait: WalkerGait, route: &[[f64; 3]]) -> String {
        let route = ScriptedRoute(route.iter().map(|place| DVec3::from_array(*place)).collect());
        let walker = ScriptedWalker::new(gait, 0, [("Go to the sink.".to_owned(), route)]);
        walker.reply(&ScriptRequest {
            messages: vec![(MessageRole::User, PROMPT.to_owned())],
            ..ScriptRequest::default()
        })
    }

    #[test]
    fn walker_takes_the_way_to_the_next_place_and_stops_at_the_last() {
        let route = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 1.0]];
        assert!(reply(WalkerGait::Route, &route).starts_with("step {\"way\": 2, "));
        assert!(reply(WalkerGait::Route, &route[..2]).starts_with("stop {"));
    }

    #[test]
    fn random_walker_stops_after_its_hops() {
        assert!(reply(WalkerGait::Random(2), &[]).starts_with("step {"));
        assert!(reply(WalkerGait::Random(1), &[]).starts_with("stop {"));
        assert!(BROKEN_REPLIES.contains(&reply(WalkerGait::Broken, &[]).as_str()));
    }
}
