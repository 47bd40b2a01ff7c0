//! Limits for users' own prompt templates: length of the output, number of steps, and no construct that can grow by
//! itself.
//!
//! minijinja limits the steps of a template (`fuel`), but not the bytes that one step makes: a single `indent` fills as
//! many gigabytes as its argument asks for. So this module also counts what filters make. It offers no construct that
//! builds a value out of itself (variables, macros, repetition), because forty lines of those fill any memory.

use super::PromptError;
use minijinja::{
    Environment, Error, ErrorKind, State, filters,
    machinery::{Token, WhitespaceConfig, tokenize},
    value::{Kwargs, Object, Rest, Value, ValueKind},
};
use std::{
    fmt::{self, Write as _},
    io,
    sync::atomic::{AtomicUsize, Ordering},
};

/// Longest template, bytes; a longer one is refused.
const MAX_SOURCE_BYTES: usize = 1 << 16;
/// Most bytes that a prompt writes, and most bytes that its filters make on the way; beyond them, filling the prompt
/// fails. Twice the longest style.
const MAX_PROMPT_BYTES: usize = 8 << 20;
/// Most steps of minijinja for a prompt; beyond them, filling it fails. A prompt with a thousand references and a
/// thousand frames takes a tenth of them.
const MAX_STEPS: u64 = 200_000;
/// Most numbers of a `range`; a longer range is an error.
const MAX_RANGE_NUMBERS: usize = 1000;
/// Most `~` and `+` of a template, because each of them may double a text. A template with more is refused.
const MAX_JOINS: usize = 64;
/// Assumed size of a list item besides its text, bytes.
const ITEM_BYTES: usize = 32;

/// The statements that prompts offer.
const OFFERED_STATEMENTS: [&str; 6] = ["for", "endfor", "if", "elif", "else", "endif"];

/// The message for a prompt that writes more than its limit.
pub(super) fn too_many_bytes() -> String {
    format!("it writes more than {MAX_PROMPT_BYTES} bytes")
}

/// The message for a prompt that takes more steps than its limit.
pub(super) fn too_many_steps() -> String {
    format!("it takes more than {MAX_STEPS} steps")
}

/// Refuses a template that uses an unlimited construct.
pub(super) fn check_template(name: &str, source: &str) -> Result<(), PromptError> {
    let refused = |line: usize, what: String| Err(PromptError::Refused { name: name.to_owned(), line, what });
    if source.len() > MAX_SOURCE_BYTES {
        return refused(1, format!("it is longer than {MAX_SOURCE_BYTES} bytes"));
    }
    let mut joins = 0;
    let mut before = None;
    for token in tokenize(source, false, Default::default(), WhitespaceConfig::default()) {
        // A syntax error is reported later, by the parser.
        let Ok((token, span)) = token else { return Ok(()) };
        let line = usize::from(span.start_line);
        match (&before, &token) {
            (Some(Token::BlockStart), Token::Ident(statement)) if !OFFERED_STATEMENTS.contains(statement) => {
                let offered = OFFERED_STATEMENTS.join(", ");
                return refused(line, format!("`{statement}` is not offered in prompts; these are: {offered}"));
            }
            (Some(Token::Pipe), Token::Ident(filter)) if !FILTERS.contains(filter) => {
                let offered = FILTERS.join(", ");
                return refused(line, format!("the filter `{filter}` is not offered in prompts; these are: {offered}"));
            }
            (_, Token::Mul | Token::Pow | Token::Ident("recursive")) => {
                let what = if let Token::Ident(word) = token { word } else { "*" };
                return refused(line, format!("`{what}` is not offered in prompts, because it can write without end"));
            }
            (_, Token::Tilde | Token::Plus) => joins += 1,
            _ => {}
        }
        if joins > MAX_JOINS {
            return refused(line, format!("a prompt may use `~` and `+` at most {MAX_JOINS} times"));
        }
        before = Some(token);
    }
    Ok(())
}

/// The environment in which prompts are filled: with limits, and only with filters that keep to them.
pub(super) fn bounded_environment() -> Environment<'static> {
    let mut environment = Environment::new();
    environment.set_fuel(Some(MAX_STEPS));
    for name in ["debug", "dict", "namespace"] {
        environment.remove_global(name);
    }
    environment.add_function("range", bounded_range);
    for name in NOT_OFFERED {
        environment.remove_filter(name);
    }
    add_filters(&mut environment);
    environment
}

/// The filters of minijinja that make more than they are given, and those that prompts have no use for.
const NOT_OFFERED: [&str; 11] =
    ["safe", "escape", "e", "batch", "slice", "groupby", "chain", "zip", "pprint", "format", "dictsort"];

/// Adds the filters of minijinja, each wrapped so that what it makes is counted: first those that make a text out of a
/// text, then those that take any value, then our own. The original is added under a name with a space, which a
/// template cannot write as a filter. `map` takes names as text, so `counted` refuses such names there.
macro_rules! filters {
    ($($text:ident)*; $($any:ident)*; $($own:ident)*) => {
        /// The filters that prompts offer.
        const FILTERS: &[&str] =
            &[$(stringify!($text),)* $(stringify!($any),)* $(stringify!($own),)* "count", "d"];

        fn add_filters(environment: &mut Environment<'_>) {
            $(environment.add_filter(concat!(stringify!($text), " itself"), filters::$text);
            environment.add_filter(stringify!($text), |state: &State<'_, '_>, value: Value, more: Rest<Value>| {
                let text = Value::from(text_of(state, &value)?);
                counted(state, concat!(stringify!($text), " itself"), text, &more)
            });)*
            $(environment.add_filter(concat!(stringify!($any), " itself"), filters::$any);
            environment.add_filter(stringify!($any), |state: &State<'_, '_>, value: Value, more: Rest<Value>| {
                counted(state, concat!(stringify!($any), " itself"), value, &more)
            });)*
            $(environment.add_filter(stringify!($own), $own);)*
            environment.add_filter("count", filters::length);
            environment.add_filter("d", filters::default);
        }
    };
}

filters! {
    upper lower title capitalize trim split lines;
    length items reverse default round abs int float attr first last min max sort list bool sum select reject selectattr
    rejectattr map unique;
    join replace indent tojson string
}

/// Applies a filter, and counts the bytes of its input and output.
fn counted(state: &State<'_, '_>, filter: &str, value: Value, more: &[Value]) -> Result<Value, Error> {
    if let Some(text) = value.as_str() {
        count_bytes(state, text.len())?;
    }
    if filter == "map itself" && more.iter().any(|name| name.as_str().is_some_and(|name| name.ends_with(" itself"))) {
        return Err(Error::from(ErrorKind::UnknownFilter));
    }
    let made = state.apply_filter(filter, &[&[value], more].concat())?;
    let bytes = match made.as_str() {
        Some(text) => text.len(),
        None => made.len().unwrap_or_default().saturating_mul(ITEM_BYTES),
    };
    count_bytes(state, bytes)?;
    Ok(made)
}

fn join(state: &State<'_, '_>, value: &Value, between: Option<Value>) -> Result<String, Error> {
    let between = between.map_or_else(|| Ok(String::new()), |between| text_of(state, &between))?;
    let mut text = CountedFilterText { state, text: String::new() };
    for (at, item) in value.try_iter()?.enumerate() {
        if at > 0 {
            text.push_display(&between)?;
        }
        text.push_display(item)?;
    }
    Ok(text.text)
}

fn replace(state: &State<'_, '_>, value: &Value, from: &Value, to: &Value) -> Result<String, Error> {
    let (text, from, to) = (text_of(state, value)?, text_of(state, from)?, text_of(state, to)?);
    count_bytes(state, text.matches(from.as_str()).count().saturating_mul(to.len()))?;
    Ok(text.replace(&from, &to))
}

// minijinja passes named arguments by value.
#[allow(clippy::needless_pass_by_value)]
fn indent(
    state: &State<'_, '_>,
    value: &Value,
    width: Option<usize>,
    first: Option<bool>,
    named: Kwargs,
) -> Result<String, Error> {
    let width = width.map_or_else(|| named.get("width"), |width| Ok(Some(width)))?.unwrap_or(4);
    let first = first.map_or_else(|| named.get("first"), |first| Ok(Some(first)))?.unwrap_or(false);
    let blank = named.get::<Option<bool>>("blank")?.unwrap_or(false);
    named.assert_all_used()?;
    let text = text_of(state, value)?;
    let lines = text.strip_suffix('\n').unwrap_or(&text).split('\n');
    count_bytes(state, lines.clone().count().saturating_mul(width))?;
    let margin = " ".repeat(width);
    let stays = |at: usize, line: &str| if at == 0 { !first } else { line.is_empty() && !blank };
    let indented =
        lines.enumerate().map(|(at, line)| if stays(at, line) { line.to_owned() } else { margin.clone() + line });
    Ok(indented.collect::<Vec<_>>().join("\n"))
}

fn tojson(state: &State<'_, '_>, value: &Value) -> Result<Value, Error> {
    let mut size = PromptText::default();
    serde_json::to_writer(&mut size, value).map_err(|_| too_much())?;
    count_bytes(state, size.into_string().len())?;
    filters::tojson(value, None, Kwargs::from_iter::<[(&str, Value); 0]>([]))
}

fn string(state: &State<'_, '_>, value: &Value) -> Result<String, Error> {
    text_of(state, value)
}

/// At most a thousand numbers.
fn bounded_range(lower: isize, upper: Option<isize>, step: Option<isize>) -> Result<Value, Error> {
    let numbers = minijinja::functions::range(lower, upper, step)?;
    if numbers.len().is_none_or(|count| count > MAX_RANGE_NUMBERS) {
        let why = format!("a `range` has at most {MAX_RANGE_NUMBERS} numbers in prompts");
        return Err(Error::new(ErrorKind::InvalidOperation, why));
    }
    Ok(numbers)
}

/// A value as text; other types are written within the limit.
fn text_of(state: &State<'_, '_>, value: &Value) -> Result<String, Error> {
    if value.kind() == ValueKind::Undefined {
        return Err(Error::from(ErrorKind::UndefinedError));
    }
    let mut text = CountedFilterText { state, text: String::new() };
    text.push_display(value)?;
    Ok(text.text)
}

/// The bytes that the filters of one prompt have made.
#[derive(Debug, Default)]
struct FilterByteCount(AtomicUsize);

impl Object for FilterByteCount {}

/// Counts bytes that a filter makes, and fails beyond the limit.
fn count_bytes(state: &State<'_, '_>, bytes: usize) -> Result<(), Error> {
    let made = state.get_or_set_temp_object("made by filters", FilterByteCount::default);
    let before = made.0.fetch_add(bytes.min(MAX_PROMPT_BYTES + 1), Ordering::Relaxed);
    if before.saturating_add(bytes) > MAX_PROMPT_BYTES { Err(too_much()) } else { Ok(()) }
}

fn too_much() -> Error {
    Error::new(ErrorKind::WriteFailure, too_many_bytes())
}

/// A text of a filter, counted as it grows.
struct CountedFilterText<'a, 'b, 'c> {
    state: &'a State<'b, 'c>,
    text: String,
}

impl CountedFilterText<'_, '_, '_> {
    fn push_display(&mut self, what: impl fmt::Display) -> Result<(), Error> {
        write!(self, "{what}").map_err(|_| too_much())
    }
}

impl fmt::Write for CountedFilterText<'_, '_, '_> {
    fn write_str(&mut self, more: &str) -> fmt::Result {
        count_bytes(self.state, more.len()).map_err(|_| fmt::Error)?;
        self.text.push_str(more);
        Ok(())
    }
}

/// The output of a prompt, limited in length.
#[derive(Debug, Default)]
pub(super) struct PromptText(Vec<u8>);

impl PromptText {
    pub(super) fn into_string(self) -> String {
        String::from_utf8(self.0).unwrap_or_else(|error| String::from_utf8_lossy(error.as_bytes()).into_owned())
    }
}

impl io::Write for PromptText {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.0.len() + bytes.len() > MAX_PROMPT_BYTES {
            return Err(io::Error::other(too_many_bytes()));
        }
        self.0.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
