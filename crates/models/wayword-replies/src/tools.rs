//! Finds the calls of tools in a reply: lines with a tool's name and JSON, as in `step {"way": 2}`, and the many shapes
//! that models and servers write in their place. Prose is never taken for a call.

use crate::{
    bounded,
    json::{mend_json, mended_value},
    marks::next_mark,
    thinking::without_thinking,
};
use serde_json::{Map, Value};

/// A call of a tool.
#[derive(Debug, Clone, PartialEq)]
pub struct ToolCallReading {
    /// The name of the tool, as the program knows it.
    pub name: &'static str,
    /// Its arguments; empty where the call has none.
    pub arguments: Map<String, Value>,
}

/// Most calls of a reply; later ones are ignored.
const MAX_CALLS: usize = 4;

/// The calls of the tools with these names, in their order; empty where there is none.
#[must_use]
pub fn find_tool_calls(reply: &str, tools: &[&'static str]) -> Vec<ToolCallReading> {
    // Gemma writes the quotes of its arguments as marks.
    let text = without_thinking(bounded(reply)).replace("<|\"|>", "\"").replace("<escape>", "\"");
    let mut calls = calls_in_tags(&text, tools);
    if calls.is_empty() {
        calls = calls_in_lines(&plain_lines(&text), tools);
    }
    calls.truncate(MAX_CALLS);
    calls
}

/// The tool that a name means, in any case and with what servers put around it: `functions.step:0`, `tool-step`.
fn known_tool(name: &str, tools: &[&'static str]) -> Option<&'static str> {
    let name = name.trim().trim_matches(['"', '\'', '`', '*']).to_lowercase();
    let name = name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches([':', '_', '.']);
    let name = name.strip_suffix(".call").unwrap_or(name);
    let last = name.rsplit(['.', '/', ':', '-', ' ', '_']).next()?;
    tools.iter().copied().find(|tool| *tool == name || *tool == last)
}

/// Calls whose arguments stand in tags of their own: `<function=step><parameter=way>2</parameter></function>`,
/// `<invoke name="step">`, and `<tool_call>step<arg_key>way</arg_key><arg_value>2</arg_value></tool_call>`.
fn calls_in_tags(text: &str, tools: &[&'static str]) -> Vec<ToolCallReading> {
    let mut calls: Vec<ToolCallReading> = Vec::new();
    let (mut at, mut key) = (0, String::new());
    while let Some(mark) = next_mark(text, at) {
        at = mark.span.end;
        if mark.closes {
            continue;
        }
        let content = &text[at..next_mark(text, at).map_or(text.len(), |next| next.span.start)];
        let named = mark.attributes.split(' ').next().unwrap_or_default();
        let named = named.trim_start_matches("name=").trim_matches(['"', '\'']);
        // DeepSeek and others write a name of their own before that of the tag.
        let tag = mark.name.rsplit(['｜', ':']).next().unwrap_or_default();
        let tag = tag
            .rsplit_once('_')
            .map_or(tag, |(_, last)| if matches!(last, "invoke" | "parameter") { last } else { tag });
        match tag {
            "function" | "invoke" | "tool_call" | "tool" | "seed_tool_call" => {
                let name =
                    if named.is_empty() { content.split(['\n', '<', '{']).next().unwrap_or_default() } else { named };
                let begins = known_tool(name, tools)
                    .filter(|_| !content.trim_start().starts_with(['{', '[']) || !named.is_empty());
                let arguments = content.find('{').and_then(|open| mended_value(&content[open..]));
                let arguments = arguments.as_ref().and_then(Value::as_object).cloned().unwrap_or_default();
                calls.extend(begins.map(|name| ToolCallReading { name, arguments }));
            }
            "arg_key" => content.trim().clone_into(&mut key),
            "parameter" | "arg_value" | "argument" => {
                let name = if named.is_empty() { std::mem::take(&mut key) } else { named.to_owned() };
                let value = serde_json::from_str(content.trim()).unwrap_or_else(|_| content.trim().into());
                if let Some(call) = calls.last_mut().filter(|_| !name.is_empty()) {
                    call.arguments.insert(name, value);
                }
            }
            _ => {}
        }
    }
    calls
}

/// The text with each mark of a template as the end of a line, so that a call stands in a line of its own.
fn plain_lines(text: &str) -> String {
    let (mut lines, mut at) = (String::new(), 0);
    while let Some(mark) = next_mark(text, at) {
        lines.push_str(&text[at..mark.span.start]);
        let is_square = text[mark.span.start..].starts_with('[');
        let is_tool = ["tool", "function", "call", "invoke", "args"].iter().any(|name| mark.name.contains(name));
        if !(mark.has_bars || is_square || is_tool) {
            lines.push_str(&text[mark.span.clone()]);
            at = mark.span.end;
            continue;
        }
        let joins =
            matches!(mark.name.as_str(), "constrain" | "message" | "args" | "tool_sep" | "tool_call_argument_begin");
        lines.push(if joins { ' ' } else { '\n' });
        at = mark.span.end;
    }
    lines.push_str(&text[at..]);
    lines
}

/// Calls in lines: a tool's name and JSON, JSON that names its tool, or a call as in Python.
fn calls_in_lines(text: &str, tools: &[&'static str]) -> Vec<ToolCallReading> {
    let (mut calls, mut at, mut named) = (Vec::new(), 0, None);
    while at < text.len() && calls.len() < MAX_CALLS {
        let end = text[at..].find('\n').map_or(text.len(), |end| at + end + 1);
        let line = without_lead(&text[at..end]);
        at = end;
        let (name, rest) = match begin_of_call(line, tools) {
            Some((name, rest)) => (Some(name), rest),
            None => (named, line),
        };
        let rest_at = end - rest.len();
        if rest.starts_with('{') {
            // Arguments that break off may lack the one that counts.
            if let Some(json) = mend_json(&text[rest_at..]).filter(|json| name.is_none() || !json.is_cut) {
                calls.extend(calls_in_value(&json.value, name, tools));
                at = end.max(rest_at + json.length);
            }
            named = None;
        } else if let Some(call) = begin_of_call(line, tools).and_then(|(name, rest)| python_call(name, rest)) {
            calls.push(call);
            named = None;
        } else {
            // The JSON of a call may stand in the lines behind its name, in a fence.
            let is_bare = rest.trim().is_empty() || rest.trim().trim_matches('`').eq_ignore_ascii_case("json");
            named = if is_bare { name } else { None };
        }
    }
    calls
}

/// A line without the signs of a list, and without the words that models write before a call.
fn without_lead(line: &str) -> &str {
    const LEADS: [&str; 8] =
        ["functools", "action input:", "action:", "tool:", "function", "assistant", "commentary", "call:"];
    let bare =
        |line: &str| line.len() - line.trim_start_matches(|c: char| c.is_whitespace() || "-*>`•[,".contains(c)).len();
    LEADS.iter().fold(&line[bare(line)..], |line, lead| {
        let rest = line.get(..lead.len()).filter(|begin| begin.eq_ignore_ascii_case(lead)).map(|_| &line[lead.len()..]);
        // "functions.step" is a name.
        rest.filter(|rest| !rest.starts_with(['s', '.'])).map_or(line, |rest| &rest[bare(rest)..])
    })
}

/// The tool that a line begins with, and the rest of the line.
fn begin_of_call<'a>(line: &'a str, tools: &[&'static str]) -> Option<(&'static str, &'a str)> {
    let line = line.strip_prefix("to=").unwrap_or(line);
    let end = line.find(|c: char| !(c.is_alphanumeric() || "._-:/".contains(c))).unwrap_or(line.len());
    let name = line[..end].trim_end_matches(':');
    let tool = known_tool(name, tools)?;
    let rest = line[end..].trim_start_matches([' ', ':', '\t']);
    let rest = rest.strip_prefix("json").map_or(rest, str::trim_start);
    // "step({...})" has its JSON in brackets.
    Some((
        tool,
        rest.strip_prefix('(').filter(|inner| inner.trim_start().starts_with('{')).map_or(rest, str::trim_start),
    ))
}

/// A call as in Python: `step(way=2, why="the text says so")`.
fn python_call(name: &'static str, rest: &str) -> Option<ToolCallReading> {
    let inside = rest.strip_prefix('(')?;
    let inside = &inside[..inside.rfind(')')?];
    let mut arguments = Map::new();
    let mut rest = inside.trim();
    while let Some((key, behind)) = rest.split_once('=') {
        let behind = behind.trim_start();
        let quote = behind.chars().next().filter(|c| matches!(c, '"' | '\''));
        let (value, after) = match quote.and_then(|quote| Some((quote, behind[1..].find(quote)?))) {
            Some((_, end)) => (Value::from(&behind[1..=end]), &behind[end + 2..]),
            None => {
                let end = behind.find(',').unwrap_or(behind.len());
                let word = behind[..end].trim();
                (serde_json::from_str(word).unwrap_or_else(|_| word.into()), &behind[end..])
            }
        };
        arguments.insert(key.trim().to_owned(), value);
        rest = after.trim_start_matches([',', ' ']);
    }
    let is_read = rest.is_empty() && arguments.keys().all(|key| key.chars().all(|c| c.is_alphanumeric() || c == '_'));
    (is_read && !arguments.is_empty() || inside.trim().is_empty()).then_some(ToolCallReading { name, arguments })
}

/// The calls in a value. Where no name precedes it, the value itself must name the tool.
fn calls_in_value(value: &Value, name: Option<&'static str>, tools: &[&'static str]) -> Vec<ToolCallReading> {
    const NAMES: [&str; 6] = ["tool", "name", "action", "tool_name", "function", "function_name"];
    const ARGUMENTS: [&str; 7] = ["arguments", "input", "parameters", "args", "action_input", "params", "kwargs"];
    let Some(fields) = value.as_object() else { return Vec::new() };
    let nested = ARGUMENTS.iter().find_map(|field| fields.get(*field)).and_then(object_in);
    if let Some(name) = name {
        let only_arguments = fields.len() == 1 || fields.contains_key("name");
        let arguments = nested.filter(|_| only_arguments).unwrap_or_else(|| fields.clone());
        return vec![ToolCallReading { name, arguments }];
    }
    if let Some(list) = ["tool_calls", "calls", "actions"].iter().find_map(|field| fields.get(*field)?.as_array()) {
        return list.iter().flat_map(|call| calls_in_value(call, None, tools)).collect();
    }
    let inner = ["function", "function_call", "tool_call"].iter().find_map(|field| fields.get(*field)?.as_object());
    if let Some(inner) = inner {
        let mut inner = inner.clone();
        if let Some(arguments) = nested.filter(|_| !ARGUMENTS.iter().any(|field| inner.contains_key(*field))) {
            inner.insert("arguments".to_owned(), arguments.into());
        }
        return calls_in_value(&inner.into(), None, tools);
    }
    let name = NAMES.iter().find_map(|field| known_tool(fields.get(*field)?.as_str()?, tools));
    if let Some(name) = name {
        return vec![ToolCallReading { name, arguments: nested.unwrap_or_else(|| fields.clone()) }];
    }
    // `{"step": {"way": 2}}`
    let only = fields.iter().next().filter(|_| fields.len() == 1);
    let call = only.and_then(|(key, value)| Some((known_tool(key, tools)?, object_in(value)?)));
    call.map(|(name, arguments)| ToolCallReading { name, arguments }).into_iter().collect()
}

/// An object, or the one in a string that has it as JSON, perhaps twice over.
fn object_in(value: &Value) -> Option<Map<String, Value>> {
    match value {
        Value::Object(fields) => Some(fields.clone()),
        Value::String(text) => match mended_value(text.trim())? {
            Value::String(inner) => mended_value(&inner)?.as_object().cloned(),
            inner => inner.as_object().cloned(),
        },
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

    const TOOLS: [&str; 3] = ["observe", "step", "stop"];

    #[test]
    fn a_call_is_read_from_every_shape() {
        let wanted = json!({ "way": 2 });
        for reply in [
            "step {\"way\": 2}",
            "Step {\"way\": 2}",
            "I turn left here.\nstep {\"way\": 2}",
            "- **step {\"way\": 2}",
            "functions.step {\"way\": 2}",
            "functions.step:0 {\"way\": 2}",
            "functools[{\"name\": \"step\", \"arguments\": {\"way\": 2}}]",
            "<|tool_call_start|>[step(way=2)]<|tool_call_end|>",
            "<function_calls>step(way=2)</function_calls>",
            "<|action_start|> <|plugin|>\n{\"name\": \"step\", \"parameters\": {\"way\": 2}}<|action_end|>",
            "<|tools_prefix|>[{\"step\": {\"way\": 2}}]<|tools_suffix|>",
            "<|tool_call|>[{\"name\": \"step\", \"arguments\": {\"way\": 2}}]",
            "<start_function_call>call:step{way:2}<end_function_call>",
            "default_api:step{way:2}",
            "step\n{\"way\": 2}",
            "{\"name\": \"step\", \"arguments\": {\"way\": 2}}\n</tool_call>",
            "{\"type\": \"function\", \"function\": {\"name\": \"step\", \"parameters\": {\"way\": 2}}",
            "<function=\"step\"><parameter=\"way\">2</parameter></function>",
            "<tool_call>\n<function=step>\n<parameter=way> 2\n</tool_call>",
            "step{\"way\": 2}</function>",
            "<tool_calls>\n<tool_call>step<tool_sep>\n<arg_key>way</arg_key>\n<arg_value>2</arg_value>\n</tool_call>\n</tool_calls>",
            "<｜DSML｜function_calls><｜DSML｜invoke name=\"step\"><｜DSML｜parameter name=\"way\" string=\"false\">2</｜DSML｜parameter></｜DSML｜invoke></｜DSML｜function_calls>",
            "<steptml:invoke name=\"step\"><steptml:parameter name=\"way\">2</steptml:parameter></steptml:invoke>",
            "<seed:tool_call>\n<function=step>\n<parameter=way>2</parameter>\n</function>\n</seed:tool_call>",
            "<tool-use>\n{\"tool_calls\": [{\"type\": \"function\", \"function\": {\"name\": \"step\"}, \"parameters\": {\"way\": 2}}]}\n</tool-use>",
            "tool-step {\"way\": 2}",
            "<tool_call>\n{\"name\": \"step\", \"arguments\": {\"way\": 2}}\n</tool_call>",
            "<tool_call>{\"name\": \"step\", \"arguments\": {\"way\": 2}}</tool_call>",
            "<tool_call>{\"name\": \"step\", \"arguments\": \"{\\\"way\\\": 2}\"}",
            "<tool_call>step\n<arg_key>way</arg_key>\n<arg_value>2</arg_value>\n</tool_call>",
            "<tool_call>\n<function=step>\n<parameter=way>\n2\n</parameter>\n</function>\n</tool_call>",
            "<function=step>{\"way\": 2}</function>",
            "<function_calls><invoke name=\"step\"><parameter name=\"way\">2</parameter></invoke></function_calls>",
            "<minimax:tool_call><invoke name=\"step\"><parameter name=\"way\">2</parameter></invoke></minimax:tool_call>",
            "[TOOL_CALLS]step{\"way\": 2}",
            "[TOOL_CALLS][{\"name\": \"step\", \"arguments\": {\"way\": 2}}]",
            "[TOOL_CALLS]step[ARGS]{\"way\": 2}",
            "<|python_tag|>{\"name\": \"step\", \"parameters\": {\"way\": 2}}",
            "<|python_tag|>step.call(way=2)",
            "[step(way=2)]",
            "step(way=2)",
            "step({\"way\": 2})",
            "```tool_call\n{\"name\": \"step\", \"arguments\": {\"way\": 2}}\n```",
            "<｜tool▁calls▁begin｜><｜tool▁call▁begin｜>function<｜tool▁sep｜>step\n```json\n{\"way\": 2}\n```<｜tool▁call▁end｜><｜tool▁calls▁end｜>",
            "<｜tool▁calls▁begin｜><｜tool▁call▁begin｜>step<｜tool▁sep｜>{\"way\": 2}<｜tool▁call▁end｜>",
            "<|tool_calls_section_begin|><|tool_call_begin|>functions.step:0<|tool_call_argument_begin|>{\"way\": 2}<|tool_call_end|><|tool_calls_section_end|>",
            "<|channel|>commentary to=functions.step <|constrain|>json<|message|>{\"way\": 2}<|call|>",
            "<|start|>assistant<|channel|>analysis<|message|>Left.<|end|><|start|>assistant to=functions.step<|channel|>commentary json<|message|>{\"way\": 2}<|call|>",
            "<|START_ACTION|>[{\"tool_call_id\": \"0\", \"tool_name\": \"step\", \"parameters\": {\"way\": 2}}]<|END_ACTION|>",
            "Thought: I go left.\nAction: step\nAction Input: {\"way\": 2}",
            "{\"action\": \"step\", \"action_input\": {\"way\": 2}}",
            "{\"function\": {\"name\": \"step\", \"arguments\": \"{\\\"way\\\": 2}\"}}",
            "{\"tool_calls\": [{\"type\": \"function\", \"function\": {\"name\": \"step\", \"arguments\": {\"way\": 2}}}]}",
            "{\"step\": {\"way\": 2}}",
            "<think>stop {}</think>step {\"way\": 2}",
            "<|tool_call>call:step{\"way\": 2}<tool_call|>",
        ] {
            let calls = find_tool_calls(reply, &TOOLS);
            assert_eq!(calls.len(), 1, "{reply}: {calls:?}");
            assert_eq!((calls[0].name, Value::Object(calls[0].arguments.clone())), ("step", wanted.clone()), "{reply}");
        }
        let calls = find_tool_calls("step {\"way\": 2, \"why\": \"the text\\nsays so\"}\nobserve {}", &TOOLS);
        assert_eq!(calls.iter().map(|call| call.name).collect::<Vec<_>>(), ["step", "observe"]);
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
            "<think>step {\"way\": 2}",
        ] {
            assert_eq!(find_tool_calls(reply, &TOOLS), [], "{reply}");
        }
        assert_eq!(find_tool_calls(&"observe {}\n".repeat(1000), &TOOLS).len(), MAX_CALLS);
    }

    proptest! {
        #[test]
        fn any_reply_is_read(reply in "\\PC{0,200}", json in "[{}\\[\\]\":,a-z0-9 \n<>|=()]{0,80}") {
            for reply in [reply.clone(), format!("step {json}\n{reply}")] {
                prop_assert!(find_tool_calls(&reply, &TOOLS).len() <= MAX_CALLS);
            }
        }
    }
}
