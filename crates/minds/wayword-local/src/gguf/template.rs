//! A conversation as the one text that a model was taught to go on with.
//!
//! The template comes with the file and is not trusted: it has a length, a number of steps and a length of what it writes. It sees
//! the messages and nothing else, and not the date, so that a conversation is the same text on every day.

use super::{file::GgufFile, vocabulary::Vocabulary};
use crate::LocalError;
use minijinja::{Environment, Error, ErrorKind, State, Value, context};
use serde::Serialize;
use std::io::{self, Write};
use wayword_core::{Message, Role, contained};

/// Longest template, bytes: Llama's has 8,000.
const LONGEST_TEMPLATE: usize = 128 << 10;
/// Most steps of a rendering: a message takes about a hundred.
const MOST_STEPS: u64 = 1 << 20;
/// Longest text that is written, bytes.
const LONGEST_TEXT: usize = 4 << 20;

/// For models that know ChatML's tokens and come without a template. Qwen3 reads an empty thought as a wish not to think.
const CHATML: &str = "{% for message in messages %}<|im_start|>{{ message.role }}\n{{ message.content }}<|im_end|>\n{% endfor %}\
    <|im_start|>assistant\n{% if thinks %}<think>\n\n</think>\n\n{% endif %}";
/// For those that know Llama 3's.
const LLAMA3: &str = "{{ bos_token }}{% for message in messages %}<|start_header_id|>{{ message.role }}<|end_header_id|>\n\n\
    {{ message.content | trim }}<|eot_id|>{% endfor %}<|start_header_id|>assistant<|end_header_id|>\n\n";

/// Renders conversations.
pub(super) struct Template {
    source: String,
    begin: String,
    end: String,
    /// Whether the model would think aloud if nobody told it not to.
    thinks: bool,
    /// Spellings that steer the model, and the same with a space in them: words of a message must not steer.
    defused: Vec<(String, String)>,
}

/// A message as templates know it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
struct Turn {
    role: &'static str,
    content: String,
}

impl Template {
    /// That of a file, or one of our own where it has none but knows the tokens of one.
    ///
    /// # Errors
    /// When the template is too long or none, or there is none.
    pub(super) fn read(file: &GgufFile, vocabulary: &Vocabulary) -> Result<Self, LocalError> {
        let source = match file.text("tokenizer.chat_template")? {
            Some(source) => source,
            None if vocabulary.has("<|start_header_id|>") && vocabulary.has("<|eot_id|>") => LLAMA3,
            None if vocabulary.has("<|im_start|>") => CHATML,
            None => return Err(file.wrong("tokenizer.chat_template is missing: this is no instruct model")),
        };
        if source.len() > LONGEST_TEMPLATE {
            return Err(file.wrong(format!("tokenizer.chat_template: {} bytes are too many", source.len())));
        }
        let defused = |control: &str| {
            let second = control.char_indices().nth(1)?.0;
            Some((control.to_owned(), format!("{} {}", &control[..second], &control[second..])))
        };
        let template = Self {
            source: source.to_owned(),
            begin: vocabulary.spelt(vocabulary.begin).to_owned(),
            end: vocabulary.spelt(vocabulary.end).to_owned(),
            thinks: vocabulary.has("<think>"),
            defused: vocabulary.controls().filter_map(defused).collect(),
        };
        let mut environment = environment();
        environment
            .add_template("chat", &template.source)
            .map_err(|error| file.wrong(format!("tokenizer.chat_template: {error}")))?;
        Ok(template)
    }

    /// A conversation up to where the model's reply begins. Where the template refuses or leaves out what the system says, it goes
    /// before the user's first words.
    ///
    /// # Errors
    /// What the template says against it.
    pub(super) fn render(&self, messages: &[Message]) -> Result<String, String> {
        let turns: Vec<Turn> = messages.iter().map(|message| self.turn(message)).collect();
        let rendered = self.write(&turns);
        let Some(system) = turns.iter().find(|turn| turn.role == "system") else { return rendered };
        match rendered {
            Ok(text) if text.contains(system.content.trim()) => Ok(text),
            other => match without_system(&turns) {
                Some(turns) => self.write(&turns),
                None => other,
            },
        }
    }

    fn turn(&self, message: &Message) -> Turn {
        let role = match message.role {
            Role::System => "system",
            Role::User => "user",
            Role::Assistant => "assistant",
        };
        let mut content = message.text.clone();
        for (control, defused) in &self.defused {
            if content.contains(control) {
                content = content.replace(control, defused);
            }
        }
        Turn { role, content }
    }

    fn write(&self, turns: &[Turn]) -> Result<String, String> {
        let mut environment = environment();
        environment.add_template("chat", &self.source).map_err(|error| said(&error))?;
        let context = context! {
            messages => turns,
            add_generation_prompt => true,
            bos_token => self.begin,
            eos_token => self.end,
            enable_thinking => false,
            thinks => self.thinks,
        };
        let template = environment.get_template("chat").map_err(|error| said(&error))?;
        let mut text = Bounded(Vec::new());
        // The engine reckons with numbers of the template, some without a look whether they overflow.
        let rendered = contained(|| template.render_captured_to(context, &mut text).map(drop));
        rendered.ok_or_else(|| "it breaks the engine that renders it".to_owned())?.map_err(|error| said(&error))?;
        String::from_utf8(text.0).map_err(|error| error.to_string())
    }
}

/// The user's first words, with the system's before them.
fn without_system(turns: &[Turn]) -> Option<Vec<Turn>> {
    let (system, mut rest): (Vec<Turn>, Vec<Turn>) = turns.iter().cloned().partition(|turn| turn.role == "system");
    let first = rest.first_mut().filter(|turn| turn.role == "user")?;
    let mut words: Vec<&str> = system.iter().map(|turn| turn.content.trim()).collect();
    words.push(&first.content);
    first.content = words.join("\n\n");
    Some(rest)
}

/// Jinja as templates expect it from transformers: blocks take no line of their own, and texts have Python's methods. Left out is
/// what could write without bound in one step.
fn environment<'a>() -> Environment<'a> {
    let mut environment = Environment::new();
    environment.set_fuel(Some(MOST_STEPS));
    environment.set_trim_blocks(true);
    environment.set_lstrip_blocks(true);
    environment.set_unknown_method_callback(method);
    environment.add_function("raise_exception", |words: String| -> Result<Value, Error> {
        Err(Error::new(ErrorKind::InvalidOperation, words))
    });
    environment.remove_filter("indent");
    environment.add_filter("tojson", |value: Value| {
        serde_json::to_string(&value).map_err(|error| Error::new(ErrorKind::BadSerialization, error.to_string()))
    });
    environment
}

fn method(state: &State<'_, '_>, value: &Value, name: &str, arguments: &[Value]) -> Result<Value, Error> {
    if name == "format" {
        return Err(Error::from(ErrorKind::UnknownMethod));
    }
    minijinja_contrib::pycompat::unknown_method_callback(state, value, name, arguments)
}

/// An error of a template, with what caused it.
fn said(error: &Error) -> String {
    match std::error::Error::source(error) {
        None => error.to_string(),
        Some(cause) => format!("{error}: {cause}"),
    }
}

/// A text that ends an endless writer.
struct Bounded(Vec<u8>);

impl Write for Bounded {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.0.len() + bytes.len() > LONGEST_TEXT {
            return Err(io::Error::other("it writes without end"));
        }
        self.0.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
