//! Reads the tool calls in a model's reply, such as `step {"way": 2, "why": "..."}`. Replies of services with native tool calls
//! are in this form too. A reply that consists only of a name and at most a number is a call as well.

use crate::one_line::shorten_line;
use serde_json::{Map, Value};
use wayword_replies::find_tool_calls;

/// A call of a tool.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct AgentToolCall {
    pub(super) act: AgentToolAction,
    /// The model's reason, in one line; empty where it gave none.
    pub(super) why: String,
    /// A note that the model wants to see in the next prompts.
    pub(super) note: Option<String>,
}

/// The action of a call.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum AgentToolAction {
    /// Look around.
    Observe,
    /// Take a way out, by its number from 1; `None` where the call names no number.
    Step(Option<usize>),
    /// End the walk, and perhaps name the object.
    Stop(Option<ObjectChoice>),
}

/// An object that a model names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum ObjectChoice {
    /// By its number in the list that the prompt had.
    Number(usize),
    /// In words.
    Words(String),
}

/// Longest reason, note and words for an object, characters; longer ones are cut.
const MAX_ARGUMENT_CHARS: usize = 300;
const TOOL_NAMES: [&str; 3] = ["observe", "step", "stop"];

/// The calls of a reply, in their order; empty where there is none.
pub(super) fn read_calls(reply: &str) -> Vec<AgentToolCall> {
    let calls = find_tool_calls(reply, &TOOL_NAMES);
    if calls.is_empty() {
        return read_bare_call(reply.trim()).into_iter().collect();
    }
    calls.into_iter().filter_map(|call| call_from_arguments(call.name, &call.arguments)).collect()
}

/// The tool that a reply begins with, and the rest of the reply.
fn tool_name(reply: &str) -> Option<(&'static str, &str)> {
    let is_name = |name: &&str| reply.get(..name.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(name));
    let name = TOOL_NAMES.into_iter().find(is_name)?;
    Some((name, reply[name.len()..].trim_start_matches([' ', ':', '(', '\t'])))
}

/// Reads a reply that consists only of a tool's name and at most a number.
fn read_bare_call(reply: &str) -> Option<AgentToolCall> {
    let (name, rest) = tool_name(reply.trim_matches('`'))?;
    let rest = rest.trim_end_matches(|c: char| c.is_whitespace() || ")`.".contains(c));
    let rest = rest.strip_prefix("way").map_or(rest, |rest| rest.trim_start_matches([' ', '=', ':']));
    let act = match name {
        "step" => AgentToolAction::Step(Some(rest.parse().ok()?)),
        "observe" if rest.is_empty() => AgentToolAction::Observe,
        "stop" if rest.is_empty() => AgentToolAction::Stop(None),
        _ => return None,
    };
    Some(AgentToolCall { act, why: String::new(), note: None })
}

/// The call of the tool `name` with its arguments; `None` if there is no such tool.
fn call_from_arguments(name: &str, arguments: &Map<String, Value>) -> Option<AgentToolCall> {
    let act = match name {
        "observe" => AgentToolAction::Observe,
        "step" => AgentToolAction::Step(arguments.get("way").and_then(read_number)),
        "stop" => AgentToolAction::Stop(arguments.get("object").and_then(read_object_choice)),
        _ => return None,
    };
    let words = |field: &str| Some(shorten_line(arguments.get(field)?.as_str()?, MAX_ARGUMENT_CHARS));
    let note = words("note").filter(|note| !note.is_empty());
    Some(AgentToolCall { act, why: words("why").unwrap_or_default(), note })
}

/// Reads a number; it may be in quotes or brackets, or have a decimal point.
fn read_number(value: &Value) -> Option<usize> {
    match value {
        Value::String(text) => text.trim_matches(|c: char| c.is_whitespace() || "[]".contains(c)).parse().ok(),
        value => {
            let number = value.as_f64().filter(|number| number.fract() == 0.0 && (0.0..1e6).contains(number))?;
            Some(number as usize)
        }
    }
}

/// Reads the argument `object` of `stop`: a number in the prompt's list, or words.
fn read_object_choice(value: &Value) -> Option<ObjectChoice> {
    let words =
        || value.as_str().map(|words| shorten_line(words, MAX_ARGUMENT_CHARS)).filter(|words| !words.is_empty());
    read_number(value).map(ObjectChoice::Number).or_else(|| words().map(ObjectChoice::Words))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn acts(reply: &str) -> Vec<AgentToolAction> {
        read_calls(reply).into_iter().map(|called| called.act).collect()
    }

    #[test]
    fn a_call_is_a_line_with_a_name_and_json() {
        let reply =
            "I turn left here.\nstep {\"way\": 2, \"why\": \"the text\\nsays <left>\", \"note\": \"\"}\nobserve {}";
        let calls = read_calls(reply);
        assert_eq!(acts(reply), [AgentToolAction::Step(Some(2)), AgentToolAction::Observe]);
        assert_eq!((calls[0].why.as_str(), &calls[0].note), ("the text says left", &None));
        assert_eq!(acts("stop {\"object\": 3}"), [AgentToolAction::Stop(Some(ObjectChoice::Number(3)))]);
        assert_eq!(
            acts("stop {\"object\": \"the sink\"}"),
            [AgentToolAction::Stop(Some(ObjectChoice::Words("the sink".into())))]
        );
    }

    #[test]
    fn other_ways_to_write_a_call_are_read_too() {
        for reply in [
            "- **step {\"way\": \"2\"}",
            "```json\n{\n \"tool\": \"step\",\n \"way\": 2\n}\n```",
            "{\"name\": \"Step\", \"arguments\": {\"way\": 2}}",
            "{\"name\": \"step\", \"arguments\": \"{\\\"way\\\": 2}\"}",
            "[{\"tool\": \"step\", \"way\": 2.0}]",
            "step {\"way\": \"[2]\"}",
            "step(2)",
            "Step: way 2",
            "`step 2`",
        ] {
            assert_eq!(acts(reply), [AgentToolAction::Step(Some(2))], "{reply}");
        }
        assert_eq!(acts("STOP"), [AgentToolAction::Stop(None)]);
    }

    #[test]
    fn prose_and_broken_calls_are_no_calls() {
        for reply in [
            "",
            "Stop there and think.",
            "Step 1.\nThe text says to leave the room.\nStep 2.\nThen it turns.",
            "Here is my plan:\n- observe\n- step 2\n- stop",
            "I turn around.\nStop.",
            "Step 2 looks right to me.",
            "I would step {\"way\": 2}",
            "step {\"way\": 2",
            "jump {\"way\": 2}",
            "[1, 2]",
            "{\"way\": 2}",
        ] {
            assert_eq!(acts(reply), [], "{reply}");
        }
        assert_eq!(acts("step {\"way\": -1}"), [AgentToolAction::Step(None)]);
        assert_eq!(acts("step {\"way\": 1.5}"), [AgentToolAction::Step(None)]);
    }

    proptest! {
        #[test]
        fn any_reply_is_read(reply in "\\PC{0,200}", json in "[{}\\[\\]\":,a-z0-9 \n]{0,80}") {
            read_calls(&reply);
            for called in read_calls(&format!("step {json}\n{reply}")) {
                prop_assert!(called.why.chars().count() <= MAX_ARGUMENT_CHARS);
            }
        }
    }
}
