//! Builds the prompt and the request of one call: the tools, and the state of the walk. A prompt does not depend on the conversation
//! before it, so an interrupted walk can be resumed from the ledger at any step. All parts are bounded, so prompts do not grow
//! with the walk.

use super::{
    limits::ToolWalkLimits,
    memory::ToolWalkMemory,
    observed_scene::{ObservedScene, describe_turn},
};
use crate::{error::WalkError, one_line::shorten_line};
use minijinja::{Environment, context};
use serde::Serialize;
use wayword_core::{ChatMessage, Heading, MessageRole, ModelError, ModelRequest, ModelTool, SamplingOptions};
use wayword_follower::online::WalkerHop;

const SYSTEM_TEMPLATE: &str = include_str!("system.j2");
const STATE_TEMPLATE: &str = include_str!("state.j2");
/// Longest instruction in a prompt, characters; a longer one is cut. People's texts have up to about 2,000.
pub const MAX_INSTRUCTION_CHARS: usize = 2_000;
/// Most ways out in a prompt. Other ways are only counted.
const MAX_PROMPT_WAYS: usize = 24;
/// Most tokens of a reply, thinking included.
const MAX_REPLY_TOKENS: u32 = 600;
/// Smallest climb or descent of a way that is mentioned, metres.
const MIN_CLIMB_M: f64 = 0.2;

const OBSERVE_TOOL: ModelTool = ModelTool {
    name: "observe",
    does: "Look around where you stand. You are told what is there, by direction.",
    arguments: r#"{"type": "object", "properties": {"why": {"type": "string", "description": "the reason, in one sentence"}, "note": {"type": "string", "description": "which part of the instruction is done; replaces your last note"}}, "required": ["why"]}"#,
};
const STEP_TOOL: ModelTool = ModelTool {
    name: "step",
    does: "Walk one of the ways out of where you stand, to its end.",
    arguments: r#"{"type": "object", "properties": {"way": {"type": "integer", "description": "the number of the way"}, "why": {"type": "string", "description": "the reason, in one sentence"}, "note": {"type": "string", "description": "which part of the instruction is done; replaces your last note"}}, "required": ["way", "why"]}"#,
};
const STOP_TOOL: ModelTool = ModelTool {
    name: "stop",
    does: "End the walk where you stand, because the instruction ends here.",
    arguments: r#"{"type": "object", "properties": {"why": {"type": "string", "description": "the reason, in one sentence"}}, "required": ["why"]}"#,
};
const STOP_AT_OBJECT_TOOL: ModelTool = ModelTool {
    name: "stop",
    does: "End the walk where you stand, and name the object that the instruction means.",
    arguments: r#"{"type": "object", "properties": {"object": {"type": "string", "description": "the number of the object in the list, or its name"}, "why": {"type": "string", "description": "the reason, in one sentence"}}, "required": ["object", "why"]}"#,
};
/// The tools of a walk that ends without naming an object.
static TOOLS: [ModelTool; 3] = [OBSERVE_TOOL, STEP_TOOL, STOP_TOOL];
/// The tools of a walk in which the model also names the object that the instruction means.
static TOOLS_FOR_OBJECTS: [ModelTool; 3] = [OBSERVE_TOOL, STEP_TOOL, STOP_AT_OBJECT_TOOL];

/// All texts of the prompts. A comparison stores them, so that it does not continue walks that were made with other prompts.
#[must_use]
pub fn prompt_wording() -> String {
    format!("{SYSTEM_TEMPLATE}{STATE_TEMPLATE}{TOOLS:?}{TOOLS_FOR_OBJECTS:?}")
}

/// How the agent perceives a place, as the template of the prompt names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum PromptSightKind {
    Labels,
    Pictures,
    Captions,
}

/// Everything that the prompt of one call depends on.
pub(super) struct PromptState<'a> {
    /// The instruction.
    pub(super) text: &'a str,
    pub(super) sees: PromptSightKind,
    /// Whether the model is to name an object when it stops.
    pub(super) names_object: bool,
    pub(super) memory: &'a ToolWalkMemory,
    /// The number of the current place, and the heading.
    pub(super) here: (usize, Heading),
    pub(super) ways: &'a [PromptWay],
    /// The scene at the current place, if the agent has looked around.
    pub(super) scene: Option<&'a ObservedScene>,
    pub(super) limits: &'a ToolWalkLimits,
    /// Calls of the model so far, and hops so far.
    pub(super) calls: usize,
    pub(super) hops: usize,
    /// The problem of the last reply, if it was useless.
    pub(super) trouble: Option<&'a str>,
    pub(super) seed: u64,
}

/// A way out, as the prompt describes it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct PromptWay {
    words: String,
}

impl PromptWay {
    /// Describes a hop that leads to the visited place with the number `leads_to`, or else to the new point `spot` of the map.
    pub(super) fn new(hop: &WalkerHop, leads_to: Option<usize>, spot: &str) -> Self {
        let rise_m = hop.length_m * libm::sin(hop.elevation_rad);
        let climb = match rise_m {
            rise_m if rise_m >= MIN_CLIMB_M => format!(", up {rise_m:.1} m"),
            rise_m if rise_m <= -MIN_CLIMB_M => format!(", down {:.1} m", -rise_m),
            _ => String::new(),
        };
        let to = leads_to.map_or_else(|| format!("new {spot}"), |number| format!("to place {number}"));
        Self { words: format!("{}, {:.1} m{climb}; {to}", describe_turn(hop.turn_rad), hop.length_m) }
    }
}

/// The request of one call.
pub(super) fn build_request(state: &PromptState<'_>) -> Result<ModelRequest, WalkError> {
    let PromptState { sees, names_object, memory, here, ways, scene, limits, calls, hops, trouble, .. } = *state;
    let system = render_template(SYSTEM_TEMPLATE, context! { sees, names_object })?;
    let (places, more) = memory.map_lines();
    let (here, heading) = here;
    let facing = match memory.turn_from_start(heading).to_degrees().round() {
        0.0 => "as at the start".to_owned(),
        deg if deg > 0.0 => format!("{deg} degrees to the right of how you looked at the start"),
        deg => format!("{} degrees to the left of how you looked at the start", -deg),
    };
    let values = context! {
        text => shorten_line(state.text, MAX_INSTRUCTION_CHARS),
        ways => &ways[..ways.len().min(MAX_PROMPT_WAYS)],
        ways_left_out => ways.len().saturating_sub(MAX_PROMPT_WAYS),
        places, more, here, facing, trouble,
        last => memory.last_steps().collect::<Vec<_>>(),
        note => memory.note,
        looked => scene.is_some(),
        room => scene.and_then(|scene| scene.room.as_deref()),
        seen => scene.map(|scene| &scene.lines[..]).unwrap_or_default(),
        calls => limits.max_calls.saturating_sub(calls),
        hops => limits.max_hops.saturating_sub(hops),
    };
    let images = scene.map(|scene| scene.pictures.clone()).unwrap_or_default();
    Ok(ModelRequest {
        messages: vec![
            ChatMessage { role: MessageRole::System, text: system, images: Vec::new() },
            ChatMessage::about_images(render_template(STATE_TEMPLATE, values)?, images),
        ],
        sampling: SamplingOptions { temperature: 0.0, max_tokens: MAX_REPLY_TOKENS, seed: state.seed },
        replicate: 0,
        schema: None,
        tools: if names_object { &TOOLS_FOR_OBJECTS } else { &TOOLS },
    })
}

fn render_template(template: &str, values: minijinja::Value) -> Result<String, WalkError> {
    let failed = |error: minijinja::Error| ModelError::Failed { model: "tools".to_owned(), reason: error.to_string() };
    let mut environment = Environment::new();
    environment.set_trim_blocks(true);
    environment.set_lstrip_blocks(true);
    Ok(environment.render_str(template, values).map_err(failed)?)
}
